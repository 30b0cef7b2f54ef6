// Linear algebra without rounding: ranks are decided, not estimated.
#pragma once

#include <optional>
#include <vector>

#include "subdivision/filters/rational.h"

namespace isowave::subdivision {

// Rows of equal length.
using Matrix = std::vector<std::vector<Rational>>;

int rank(const Matrix& matrix);

// The x of least Euclidean norm among all with E x = r; nothing when there is none.
// x = Et y with (E Et) y = r, taken over a largest independent set of rows of E.
std::optional<std::vector<Rational>> leastNorm(const Matrix& e, const std::vector<Rational>& r);

// A basis of { x : M x = 0 }, one vector a free column, with integer entries of greatest common divisor 1.
// REQUIRES: at least one row.
Matrix nullspace(const Matrix& matrix);

}  // namespace isowave::subdivision
