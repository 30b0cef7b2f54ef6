// What this program is made of: for a report of a fault.
#pragma once

#include <string>

namespace isowave::tools {

// `isowave --version --verbose`: version, libraries, threads, SIMD, allocator, licence; a line each.
std::string verboseVersion();

}  // namespace isowave::tools
