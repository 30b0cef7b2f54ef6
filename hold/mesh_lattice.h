// F at all points of the lattice that a mesh samples, in one dense array: for passes that follow the surface through
// the lattice, such as persistence and the growing of plugs.
#pragma once

#include "polygonize/persistence.h"
#include "volume/field.h"

namespace isowave {

// function: F; < 0 is inside. finer: lattice points to a control point on each axis. low: of the first one.
struct MeshLattice {
    LatticeFunction function;
    openvdb::Coord low;
    int finer = 1;

    // Of a lattice point: in the field's index space, times `finer`; and its place there.
    openvdb::Coord coordOf(std::int64_t point) const { return low + function.point(point); }
    openvdb::Vec3d placeOf(std::int64_t point) const { return coordOf(point).asVec3d() / finer; }
    // REQUIRES: contains(at).
    std::int64_t indexOf(const openvdb::Coord& at) const {
        const openvdb::Coord p = at - low;
        return function.index(p[0], p[1], p[2]);
    }
    bool contains(const openvdb::Coord& at) const {
        for (int a = 0; a < 3; ++a)
            if (at[a] < low[a] || at[a] - low[a] >= function.size[a]) return false;
        return true;
    }
    // Outside of the array all is outside.
    float at(const openvdb::Coord& c) const { return contains(c) ? function.values[indexOf(c)] : 1.0f; }
};

// Points that meshLattice() would have.
double latticePoints(const BSplineField& field, int refine);

// The lattice of polygonize(field, refine): all of it that can be inside, and one layer more.
// About 20 ns a point. REQUIRES: refine is a power of 2; K outside.
MeshLattice meshLattice(const BSplineField& field, int refine, const Progress& progress = {});

// Twice as fine, so that it also has the places that decide about faces and cells (polygonize/cell_table.h): { < 0 },
// its points joined along axes, has the parts, handles and cavities of the mesh of polygonize(field, refine). Where the mesh does
// not ask for F, the sign here follows from what it does see: on edges from the ends (inside where either is, so
// that a joined face is reached), in faces and cells from corners that agree.
MeshLattice decidedLattice(const BSplineField& field, int refine, const Progress& progress = {});

}  // namespace isowave
