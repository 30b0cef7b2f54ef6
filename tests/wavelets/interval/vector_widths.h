// The vectors that this machine has, narrowest first: what is written for the widest must give the same with
// all of them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/vectors.h"

namespace isowave::wavelets {

inline std::vector<Vectors> vectorWidths() {
    std::vector<Vectors> widths{Vectors::two};
    if (widestVectors() >= Vectors::four) widths.push_back(Vectors::four);
    if (widestVectors() >= Vectors::eight) widths.push_back(Vectors::eight);
    return widths;
}

inline std::string vectorsName(const testing::TestParamInfo<Vectors>& width) {
    return width.param == Vectors::two ? "Two" : width.param == Vectors::four ? "Four" : "Eight";
}

}  // namespace isowave::wavelets
