// The part of polygonize()'s mesh that lies in the cells of one block, as what the rest of the mesh needs to know of it: pieces, their
// Euler number and volume, and which vertices they share with the blocks beside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "polygonize/blocks.h"

namespace isowave {

// Joined by triangles within the block.
struct SurfacePiece {
    std::int64_t twiceEuler =
        0;  // 2 V - T; V: of the edges that start at the block's lattice points, and inside its cells. Over all
            // blocks that a component of a closed mesh meets they add up to twice its Euler number.
    double volume = 0;  // of the cone from lattice point (0,0,0), lattice cells; they add up, too
};

struct SurfacePieces {
    // A vertex on a face of the block, and its piece. Blocks that share a face give its vertices the same names.
    struct OnFace {
        std::uint16_t vertex = 0, piece = 0;
    };
    std::vector<SurfacePiece> pieces;
    std::array<std::vector<OnFace>, 6> onFace;  // 2 axis + (0 low, 1 high); ascending
};

// points: the control points of the lattice that the mesh samples. The mesh is that of F = 0. World coordinates do not matter.
SurfacePieces surfacePieces(const PaddedBlock& points, const openvdb::Coord& origin);

}  // namespace isowave
