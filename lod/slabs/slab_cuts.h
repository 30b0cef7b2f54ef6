// Where a lattice is cut into slabs along an axis, always between leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/parts/field_part.h"

namespace isowave::lod {

// Slab i holds the lattice points at[i - 1] <= c < at[i]; the first and the last one have no end outwards.
struct SlabCuts {
    int axis = 2;
    std::vector<int> at = {};  // ascending multiples of 8

    // As even as leaves allow, of lattice points 0 .. size - 1; fewer slabs where there are not so many leaves.
    static SlabCuts even(int axis, std::int64_t size, int slabs);

    int count() const { return static_cast<int>(at.size()) + 1; }
    LeafBox box(int slab) const;
    // The same places once the axis has been halved, as near as leaves allow; slabs that are too thin then are joined.
    SlabCuts halved() const;
};

}  // namespace isowave::lod
