// How much memory the process has needed.
#pragma once

#include <cstdint>

namespace isowave {

// Largest resident set of this process so far, in bytes.
std::int64_t peakMemoryBytes();

}  // namespace isowave
