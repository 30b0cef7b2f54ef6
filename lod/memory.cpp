#include "lod/memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "base/number_text.h"
#include "isowave/error.h"

namespace isowave::lod {
namespace {

constexpr double kDefaultMemoryShare = 0.7;

// memory.max of the root of the control groups that this process sees: a container's own limit inside one,
// and nothing outside, where the root has no limit.
std::optional<double> containerMemory() {
    std::ifstream file("/sys/fs/cgroup/memory.max");
    double bytes = 0;
    if (file >> bytes && bytes > 0) return bytes;
    return std::nullopt;
}

}  // namespace

double memoryLimit(const std::optional<double>& asked) {
    if (asked) return *asked;
    double memory =
        static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    if (const auto container = containerMemory()) memory = std::min(memory, *container);
    return kDefaultMemoryShare * memory;
}

void refuseTooLarge(const std::string& name, double bytes, double limit, const std::string& remedy) {
    if (bytes <= limit) return;
    throw InputError(
        name, fmt::format("would take about {} of memory, over the limit of {}; {}, or raise the limit "
                          "with --max-memory GB",
                          bytesText(bytes), bytesText(limit), remedy));
}

}  // namespace isowave::lod
