// What numbers an option may have, for programs that fill the structs themselves: the command's parser has refused the rest.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isowave/error.h"

namespace isowave::lod {

// Throws UsageError: a value that is given is 0, negative or not finite.
inline void requirePositive(const char* option, const std::optional<double>& value) {
    if (value && !(*value > 0 && std::isfinite(*value)))
        throw UsageError(fmt::format("{}: {:g} is not a number above 0", option, *value));
}
inline void requirePositive(const char* option, const std::vector<double>& values) {
    for (const double value : values) requirePositive(option, std::optional<double>(value));
}

// Throws UsageError: a number is not finite.
inline void requireFinite(const std::string& option, std::span<const double> numbers) {
    for (const double n : numbers)
        if (!std::isfinite(n)) throw UsageError(fmt::format("{}: {:g} is no finite number", option, n));
}

// Throws UsageError: a value that is given is less.
inline void requireAtLeast(const char* option, const std::optional<std::int64_t>& value, std::int64_t least) {
    if (value && *value < least)
        throw UsageError(fmt::format("{}: {} is less than {}", option, *value, least));
}

// Throws UsageError: samples of a node along an axis that polygonize() does not take.
inline void requireRefine(int refine) {
    if (refine != 1 && refine != 2 && refine != 4)
        throw UsageError(fmt::format("--refine: {} is not 1, 2 or 4", refine));
}

}  // namespace isowave::lod
