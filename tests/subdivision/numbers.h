// Exact numbers written short, and how far lists of numbers lie apart.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "subdivision/filters/diagram.h"

namespace isowave::subdivision {

inline Node at(int x) { return {x, 0}; }
inline Rational q(const char* text) { return parseRational(text); }

// Taps on the line from `first` on: "23/196 -23/49 ..".
inline Diagram line(int first, const char* taps) {
    Diagram diagram;
    for (const auto& value : parseRationals(taps)) diagram.add(at(first++), value);
    return diagram;
}

inline double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double v : values) most = std::max(most, std::abs(v));
    return most;
}

inline double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
        most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

inline double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace isowave::subdivision
