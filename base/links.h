// Symbolic links on the way to a result.
#pragma once

#include <filesystem>

namespace isowave {

// What a name leads to, link after link, whether it is there yet or not: replacing a link itself would leave
// its target as it was. Throws OperationError for a link that leads to itself.
std::filesystem::path behindLinks(const std::filesystem::path& place);

}  // namespace isowave
