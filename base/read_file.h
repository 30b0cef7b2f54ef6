// A whole file as bytes, and one clear line when there is nothing to read.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/peak_memory.h"

namespace isowave {

// expected: what the file should be, "a mesh file". Throws InputError when nothing has that name, when it is
// a folder, may not be opened, is empty, or is compressed by gzip.
std::string readFile(const std::filesystem::path& path, std::string_view expected);

// The same, and what gzip has compressed, by its first two bytes, inflated: at most `most` bytes (inflate.h, which says what
// is refused).
std::string readInflatedFile(const std::filesystem::path& path, std::string_view expected,
                             double most = usualMemoryLimit());

}  // namespace isowave
