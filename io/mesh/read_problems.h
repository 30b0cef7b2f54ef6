// What is wrong with a mesh file, where and why. Each function takes
// the whole file and returns the end of a line for the user ("line 7: ..."), or nothing when it sees no
// fault.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace isowave {

std::optional<std::string> asciiStlProblem(std::string_view text);
std::optional<std::string> objProblem(std::string_view text);
std::optional<std::string> offProblem(std::string_view text);
std::optional<std::string> plyProblem(std::string_view bytes);

}  // namespace isowave
