// The indices that keep every sign of F and move it by no more than a bound near the surface.
//
// quantise -> keep the signs -> measure; with a smaller step until the bound holds. Signs: while s F is below a margin at a known
// point, its index moves by 1 towards s; one of the eight parities of the lattice a pass, so that neighbours do not both answer. Then the
// same for the signs in the middle of ambiguous faces and cells (middle_signs.h), whose corners of sign s are moved.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compress/coder/lattice_values.h"
#include "compress/coder/quantiser.h"
#include "isowave/progress.h"

namespace isowave::compress {

struct BoundedInput {
    const Lattice& lattice;
    const std::vector<float>& c;  // of the known points
    const Flags& inside;          // the signs that are to be kept
    float K;
    double voxelsPerK;  // F of K is a distance of so many voxels
};

struct Bounded {
    double delta = 0;  // of the quantiser, voxels
    std::vector<std::int32_t> indices;
    double largest = 0;  // change of F at corners of nodes that the surface passes, voxels
};

// bound: voxels, above 0. Empty where no step down to the quantiser's least one keeps signs and bound; Cancelled.
std::optional<Bounded> boundIndices(const BoundedInput& input, double bound, const Progress& progress);

// What indices stand for, the same for writer and reader.
std::vector<float> valuesOf(const std::vector<std::int32_t>& indices, const Quantiser& quantiser, double K,
                            double voxelsPerK);
// How far values reach, in voxels, a little more than that and a multiple of 1/16: what the quantiser is made for.
double reachOf(const BoundedInput& input);

}  // namespace isowave::compress
