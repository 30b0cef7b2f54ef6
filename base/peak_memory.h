// How much memory the process has needed, and how much it may take.
#pragma once

#include <cstdint>

namespace isowave {

// Largest resident set of this process so far, in bytes.
std::int64_t peakMemoryBytes();

// 70 % of the computer's (or of the container's) memory, in bytes: what a job takes at most where nobody says.
double usualMemoryLimit();

}  // namespace isowave
