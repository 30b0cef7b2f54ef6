#include "base/peak_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>

namespace isowave {
namespace {

constexpr double kUsualShare = 0.7;

// memory.max of the root of the control groups that this process sees: a container's own limit inside one,
// and nothing outside, where the root has no limit.
std::optional<double> containerMemory() {
    std::ifstream file("/sys/fs/cgroup/memory.max");
    double bytes = 0;
    if (file >> bytes && bytes > 0) return bytes;
    return std::nullopt;
}

}  // namespace

std::int64_t peakMemoryBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{usage.ru_maxrss} * 1024;  // Linux counts kilobytes
}

double usualMemoryLimit() {
    double memory =
        static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    if (const auto container = containerMemory()) memory = std::min(memory, *container);
    return kUsualShare * memory;
}

}  // namespace isowave
