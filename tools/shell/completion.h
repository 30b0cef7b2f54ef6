// Completion scripts, made from what the commands declare.
#pragma once

#include <string>

#include "tools/commands.h"

namespace isowave::tools {

// `isowave completion bash`: source it, or install it as /usr/share/bash-completion/completions/isowave.
std::string bashCompletion(const Commands& commands);

// `isowave completion zsh`: source it after compinit, or install it as _isowave in a folder of $fpath.
std::string zshCompletion(const Commands& commands);

}  // namespace isowave::tools
