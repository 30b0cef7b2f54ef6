#include "lod/memory.h"

#include <fmt/format.h>

#include "base/number_text.h"
#include "base/peak_memory.h"
#include "isowave/error.h"

namespace isowave::lod {

double memoryLimit(const std::optional<double>& asked) { return asked ? *asked : usualMemoryLimit(); }

void refuseTooLarge(const std::string& name, double bytes, double limit, const std::string& remedy) {
    if (bytes <= limit) return;
    throw InputError(
        name, fmt::format("would take about {} of memory, over the limit of {}; {}, or raise the limit "
                          "with --max-memory GB",
                          bytesText(bytes), bytesText(limit), remedy));
}

}  // namespace isowave::lod
