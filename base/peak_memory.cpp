#include "base/peak_memory.h"

#include <sys/resource.h>

namespace isowave {

std::int64_t peakMemoryBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{usage.ru_maxrss} * 1024;  // Linux counts kilobytes
}

}  // namespace isowave
