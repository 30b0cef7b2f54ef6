// The least change of a field that meets bounds on its values at given places: a quadratic program with a row
// of 64 B-spline weights a place, solved by dual coordinate ascent (C. Hildreth: "A quadratic programming
// procedure", 1957; softened rows as Lent and Censor: "Extensions of Hildreth's row-action method", 1980).
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

// A demand on F at one place, in F's own units (K = a field's half-width, not voxels).
struct FieldRow {
    openvdb::Vec3d at;   // index space of the field
    float sign = 1;      // +1 or -1
    float bound = 0;     // sign F(at) + bound <= 0, or = 0 where `equal`
    float rho = 0;       // 0: hard. Else a violation v costs v^2/(2 rho); the sum of w^2 is 0.02 to 0.13
    bool equal = false;  // an equation instead of an inequality
};

struct AscentOptions {
    double tolerance = 0.00125;  // of F: 0.005 voxel for K = 1, half-width 4
    int rounds = 60;             // at most
    int innerSweeps = 0;         // at most, over active rows alone, in each round
};

struct AscentReport {
    std::int64_t rows = 0;  // given
    std::int64_t unmet =
        0;              // rows whose violation, at the end, is above 2 tolerances (soft rows: hard ones only)
    int rounds = 0;     // taken
    double change = 0;  // the largest change of F at a row in the last round, in F's units
    std::int64_t changed = 0;  // control points whose float changed
    bool settled = true;       // ended by tolerance, not at its limit of rounds
};

// Minimises |c - c0|^2/2 + sum over soft rows of violation^2/(2 rho), subject to the hard rows; c: the control
// points of I, c0: their values before. A row's multiplier lambda (0 at first) is changed so that its own
// condition holds exactly, r = sign F(at) + bound:
//   lambda' = lambda + (r - rho lambda)/(sum w^2 + rho),  at least 0 for inequalities;
//   c -= sign (lambda' - lambda) w.
// A round is one sweep over the rows, then up to innerSweeps to and fro over the rows that it found active
// (lambda > 0 or violated). It stops on the change, not on the violation: with multipliers a row is satisfied
// whenever it is visited.
//
// (1) What is not in I keeps its value: such weights count in F, but not in sum w^2. Rows that reach no point of
//     I are left out.
// (2) A control point that no row moves keeps its bits; without violated or equal rows that is all of them.
// (3) The same bits for any number of threads and any order of the rows: rows are grouped by the leaf of their
//     first control point, in an order that follows from their places, and leaves are worked on in eight
//     colours (parity of the leaf's coordinates), of which no two share a control point.
// (4) After the first round only leaves are visited that moved a value by more than the tolerance in the last
//     one, and those beside them: what is settled costs nothing, and places that are two leaves apart from each
//     other do not know of each other.
// Rows of a leaf go in random order: along the lattice they take two to three times the rounds.
// REQUIRES: field.controlPoints without active tiles; finite places.
// Throws Cancelled; the field is then partly changed.
AscentReport ascend(BSplineField& field, const std::vector<FieldRow>& rows, const AscentOptions& options = {},
                    const Progress& progress = {});

}  // namespace isowave
