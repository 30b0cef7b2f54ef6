// Files of grids: vdb, pyramid.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// vdb: any .vdb, as level set and as pyramid. OpenVDB's parser runs in a child process as in the program, so a target call
// takes a fork; what is fuzzed is all around it, and what of the file this process reads by itself.
// pyramid: a small pyramid whose parts are changed, left out or exchanged as the bytes say, and written with hashes that are
// right: what a damaged file cannot be. Every step is restored, drawn, and its mesh is sound.
std::vector<Target> vdbTargets();

}  // namespace isowave::fuzz
