// The least change of a field's control points under which the spline obeys linear inequalities at points.
//
// Notation. c: control points. w: the 16 weights of a point, so that F = w.c there. A row asks for s F + b <= 0, s = 1
// inside, -1 outside; rho: its softness, 0 for a row that must hold; lambda >= 0: its multiplier.
//
//   minimise |c - c0|^2/2 + sum over rows of (violation)^2/(2 rho)
//
// Hildreth's dual coordinate ascent visits a row, takes the best lambda for it and moves c along w:
//
//   lambda' = max(0, lambda + (s F + b - rho lambda)/(w.w + rho)),   c <- c - s (lambda' - lambda) w
//
// C. Hildreth, "A quadratic programming procedure", Naval Research Logistics Quarterly 4, 1957; the soft rows as in
// Lent and Censor, "Extensions of Hildreth's row-action method for quadratic programming", SIAM J. Control Optim. 18, 1980.
//
// Rows are cut into squares of 16 x 16 nodes in four colours. Squares of a colour touch no common control point, so they
// run at the same time; within one the order is that of a hash, because rows in the order of the lattice take two to
// three times the rounds. The result is the same to the bit for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "curves2d/row_field.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

class Ascent {
  public:
    // REQUIRES: field.axis == 0.
    explicit Ascent(const RowField<float>& field);

    struct Constraint {
        Point at;         // lattice coordinates of the field
        double side;      // s: 1 inside, -1 outside
        double offset;    // b, in units of F
        double softness;  // rho; w.w is 0.02 to 0.13
    };
    // Control points that are not known stay what they are; a row that depends on no other is left out.
    void add(const Constraint& row);
    // Lets go of all rows and multipliers; control points stay changed.
    void clear() { rows_.clear(); }

    // Rounds until a sweep over all rows changes no value by more than `tolerance`, at most `mostRounds`. Returns how many
    // it took. The change counts, not the violation: with multipliers a row is satisfied when it has been visited.
    int run(double tolerance, int mostRounds, const Progress& progress);

    // Puts the control points into the field that they came from. Returns how many have changed.
    std::int64_t write(RowField<float>& field) const;

  private:
    struct Held {
        std::array<std::int32_t, 4>
            base;  // of the four rows of control points: index of the first one of four
        std::array<std::int32_t, 2> node;
        double tx, ty;  // place in the node
        double side, offset, softness, lambda;
        bool allKnown;
    };
    struct Square {
        std::uint32_t begin, end;  // of rows_
        std::vector<std::uint32_t> active;
    };
    struct Piece {
        std::int32_t first, last;
        std::int32_t start;  // index of `first`
    };

    std::int32_t baseOf(std::int32_t x, std::int32_t y) const;
    void cutIntoSquares();
    double sweep(const std::vector<std::uint32_t>& squares, bool active, bool backwards, double tolerance);
    double visit(Held& row, bool& active, double tolerance);

    const RowField<float>* field_;
    std::vector<double> values_;
    std::vector<char> known_;
    tsl::robin_map<std::int32_t, std::vector<Piece>> pieces_;
    std::vector<Held> rows_;
    std::vector<Square> squares_;
    std::array<std::vector<std::uint32_t>, 4> colours_;
};

}  // namespace isowave::curves2d
