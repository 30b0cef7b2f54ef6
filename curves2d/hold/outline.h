// The curves of level 0 as what every level is held to: what they surround, and where they run, with normals.
// Lengths are pixels of level 0, places its lattice coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "curves2d/hold/interior.h"
#include "curves2d/row_field.h"

namespace isowave::curves2d {

// A point where a curve crosses a lattice line.
struct OutlinePoint {
    Point at;
    Point normal;       // unit, pointing outside
    std::int32_t ring;  // of the curves
};

class Outline {
  public:
    // curves: of the field. Neither is needed afterwards.
    Outline(const RowField<float>& field, const Curves& curves);

    const Interior& interior() const { return interior_; }
    const std::vector<OutlinePoint>& points() const { return points_; }
    // What the field grows by in a pixel across the curves, on average: its unit of length. 1 without curves.
    double slope() const { return slope_; }

    // The stretches of lattice lines along `axis` that lie inside, as pairs of indices of points(), line by line.
    struct Chord {
        std::uint32_t from, to;
    };
    std::vector<Chord> chords(int axis) const;

  private:
    Interior interior_;
    std::vector<OutlinePoint> points_;
    double slope_ = 1;
};

}  // namespace isowave::curves2d
