// A B-spline field of the plane whose control points are known near a curve only, stored in hashed rows
// (E = Esteve, Brunet, Vinacua, section 4.4): a map from a row to its runs of known control points, whose
// values lie one behind the other. Memory is proportional to the number of known control points, |I|, however
// large the domain is.
//
// Rows run along `axis`: with axis = 0 a row is a line y = const and a position on it is x. The other
// direction is derived when it is needed, in O(|I|): transposed().
//
// Signs. A control point that is not known is worth +K outside and -K inside. All lattice points of a gap
// between two runs have one sign, because a change of sign between neighbours would have made them known:
//   (1) two unknown lattice points that are neighbours along either axis have the same sign
//   (2) before the first run of a row, behind its last one and in rows without a run the sign is +
// So one bit behind every run holds the sign of every unknown lattice point of the plane. (1) and (2) survive
// a step: coarse point j takes the sign of fine point 2j, and where j and j+1 are unknown, 2j .. 2j+2 were.
#pragma once

#include <tsl/robin_map.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curves2d/geometry.h"
#include "curves2d/spans.h"

namespace isowave::curves2d {

// A maximal run of known positions, first .. last.
struct KnownRun {
    std::int32_t first, last;
    bool insideAfter;  // the sign of the gap behind it: inside = -K
    friend bool operator==(const KnownRun&, const KnownRun&) = default;
};

template <class Real>
struct Row {
    std::vector<KnownRun> runs;  // ascending, at least one unknown position between neighbours
    std::vector<Real> values;    // of all runs, one behind the other
    friend bool operator==(const Row&, const Row&) = default;
};

struct Bounds {
    std::array<std::int32_t, 2> first{0, 0}, last{-1, -1};  // of x and y
    std::int32_t size(int axis) const { return last[axis] - first[axis] + 1; }
};

// Real: float or double. Instantiated for both.
template <class Real>
struct RowField {
    int axis = 0;
    double K = 1;
    Frame frame;  // of this field's own lattice
    tsl::robin_map<std::int32_t, Row<Real>> rows;

    // nullptr: no control point of that row is known.
    const Row<Real>* find(std::int32_t row) const {
        const auto at = rows.find(row);
        return at == rows.end() ? nullptr : &at->second;
    }
    // Ascending.
    std::vector<std::int32_t> rowNumbers() const;
    // |I|
    std::int64_t controlPointCount() const;
    // Of the known control points.
    Bounds bounds() const;
    // The value at a lattice point, known or not. Takes a search: for a few points, and for tests.
    double at(std::int32_t x, std::int32_t y) const;
    bool isKnown(std::int32_t x, std::int32_t y) const;
};

// Reads a row from left to right: control points first .. first + out.size() - 1, known ones and ±K. A walk
// over the whole row costs O(its runs + what it reads).
template <class Real>
class RowReader {
  public:
    // row may be nullptr: nothing known, everything +K. REQUIRES: it outlives the reader.
    RowReader(const Row<Real>* row, double K) : row_(row), K_(K) {}
    // REQUIRES: first is no smaller than in the call before.
    void read(std::int32_t first, std::span<double> out);

  private:
    const Row<Real>* row_;
    double K_;
    std::size_t run_ = 0;    // the first run that ends at the last `first` or behind it
    std::size_t value_ = 0;  // where its values begin
};

// The same field with rows along the other axis, in O(|I|).
template <class Real>
RowField<Real> transposed(const RowField<Real>& field);

// The same spline on a lattice of half the spacing, by knot insertion: its control points are (c_{i-1} + 6 c_i + c_{i+1})/8
// and (c_i + c_{i+1})/2 on each axis, known where one of these is. Any axis will do; the rows of the result run along x.
template <class Real>
RowField<Real> onHalfSpacing(const RowField<Real>& field);

// The same control points in another type.
template <class To, class From>
RowField<To> converted(const RowField<From>& field) {
    RowField<To> out;
    out.axis = field.axis;
    out.K = field.K;
    out.frame = field.frame;
    for (const auto& [number, row] : field.rows)
        out.rows[number] = {row.runs, std::vector<To>(row.values.begin(), row.values.end())};
    return out;
}

// "Defined nodes" of E's Table 1: unit squares whose 16 control points are all known. REQUIRES: nothing; any
// axis will do.
template <class Real>
std::int64_t definedNodeCount(const RowField<Real>& field);

// The field's value and gradient (per lattice step) at any point, in lattice coordinates.
struct Sample {
    double value;
    Point gradient;
};
template <class Real>
Sample sample(const RowField<Real>& field, Point lattice);

// Weights of control points i-1 .. i+2 at i + t, and their derivatives.
inline std::array<double, 4> splineWeights(double t) {
    const double s = 1 - t;
    return {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
            t * t * t / 6};
}
inline std::array<double, 4> splineSlopes(double t) {
    const double s = 1 - t;
    return {-s * s / 2, (-4 * t + 3 * t * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
}

}  // namespace isowave::curves2d
