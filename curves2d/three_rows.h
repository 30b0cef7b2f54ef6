// Three neighbouring rows of a field, and the filters of three taps on both axes that fits and edits are made of.
#pragma once

#include <cstdint>
#include <vector>

#include "curves2d/row_field.h"

namespace isowave::curves2d {

// Rows y-1, y, y+1 of a field, read together from left to right.
template <class Real>
class ThreeRows {
  public:
    template <class Field>
    ThreeRows(const Field& field, std::int32_t y)
        : below_(field.find(y - 1), field.K),
          here_(field.find(y), field.K),
          above_(field.find(y + 1), field.K) {}
    // Positions first-1 .. last+1.
    void read(std::int32_t first, std::int32_t last) {
        for (auto* row : {&below, &here, &above}) row->resize(static_cast<std::size_t>(last - first + 3));
        below_.read(first - 1, below);
        here_.read(first - 1, here);
        above_.read(first - 1, above);
    }
    std::vector<double> below, here, above;

  private:
    RowReader<Real> below_, here_, above_;
};

// centre c_i + side (c_{i-1} + c_{i+1}) on both axes: (4, 1)/6 gives the spline's values at lattice points,
// (8, -1)/6 the control points of a quasi-interpolant. out[i] belongs to position first + i.
template <class Real>
void threeTaps(ThreeRows<Real>& rows, double centre, double side, std::vector<double>& out) {
    std::vector<double>& e = rows.here;
    for (std::size_t i = 0; i < e.size(); ++i) e[i] = centre * e[i] + side * (rows.below[i] + rows.above[i]);
    out.resize(e.size() - 2);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = centre * e[i + 1] + side * (e[i] + e[i + 2]);
}

}  // namespace isowave::curves2d
