// A small piece of the lattice that a mesh samples, dense: what the mesh would count there, without making it.
#pragma once

#include <cstdint>

#include "hold/mesh_lattice.h"
#include "polygonize/blocks.h"

namespace isowave {

class LatticePatch {
  public:
    LatticePatch() = default;
    // controlPoints: of a box whose first one is `low`, three or more on each axis. The lattice points are those that these alone
    // decide.
    // REQUIRES: refine is a power of 2.
    LatticePatch(const LatticeFunction& controlPoints, const openvdb::Coord& low, int refine);

    // F. finer is `refine`.
    const MeshLattice& lattice() const { return lattice_; }

    // The control points of the lattice around a block.
    // REQUIRES: the patch has all of the block's cells.
    void gather(const openvdb::Coord& origin, PaddedBlock& points) const;

    // 2 V - T of the vertices and triangles in the patch's cells. As polygonize()'s meshes are closed, twice their Euler number
    // changes by as much as this does when F changes in the patch alone, two lattice points or more from its border.
    std::int64_t twiceEuler() const;

    // Pieces of the inside and of the outside that lie in the patch as a whole, joined across corners, too: whatever faces and cells decide,
    // the mesh has a component around each that is not joined to what is around it.
    std::int64_t closedPieces() const;

  private:
    struct Count {
        std::int64_t vertices = 0, triangles = 0;
    };
    void countCell(const openvdb::Coord& low, Count& count) const;

    MeshLattice lattice_;
    LatticeFunction fine_;  // control points of the lattice: lattice point (0,0,0) is at (1,1,1)
};

}  // namespace isowave
