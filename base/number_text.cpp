#include "base/number_text.h"

#include <fmt/format.h>

#include <cmath>

namespace isowave {

std::string grouped(std::int64_t value) {
    std::string digits = std::to_string(value);
    const std::size_t first = digits.front() == '-' ? 1 : 0;
    for (std::size_t i = digits.size(); i > first + 3; i -= 3) digits.insert(i - 3, ",");
    return digits;
}

std::string counted(std::int64_t value, std::string_view one, std::string_view many) {
    if (value == 1) return fmt::format("1 {}", one);
    return many.empty() ? fmt::format("{} {}s", grouped(value), one)
                        : fmt::format("{} {}", grouped(value), many);
}

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "-";
    if (std::abs(value) >= 1000 && std::abs(value) < 1e15) return grouped(std::llround(value));
    return fmt::format("{:.4g}", value);
}

std::string bytesText(double bytes) {
    for (const char* unit : {"B", "kB", "MB", "GB"}) {
        if (bytes < 1000) return fmt::format("{:.3g} {}", bytes, unit);
        bytes /= 1000;
    }
    return fmt::format("{:.4g} TB", bytes);
}

}  // namespace isowave
