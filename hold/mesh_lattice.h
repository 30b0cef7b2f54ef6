// F at all points of the lattice that a mesh samples, in one dense array: for passes that follow the surface through
// the lattice, such as persistence and the growing of plugs.
#pragma once

#include <vector>

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
// REQUIRES: refine is a power of 2; K outside.
MeshLattice meshLattice(const BSplineField& field, int refine, const Progress& progress = {});

// F at lattice points of a field's control points and halfway between them on each axis: from `low`, `points` lattice
// points on each axis, so 2 points - 1 values.
LatticeFunction halfwayValues(const BSplineField& field, const openvdb::Coord& low,
                              const openvdb::Coord& points);

// Which places of such an array are inside for a mesh that samples the lattice: lattice points by F's sign; in
// ambiguous faces, and in cells where the table asks, the sign of F there (polygonize/cell_table.h). The others follow
// from what the mesh does see: on edges inside where either end is, so that a joined face is reached; in faces and
// cells from corners that agree, else as F is.
// { inside }, joined along axes, and the rest, joined across corners, too, then have the topology of mesh and solid. For fields
// of pure noise one in forty handles differs: a cell's middle that is joined to regions without a face.
class DecidedSigns {
  public:
    // REQUIRES: f outlives this; its sizes are odd.
    explicit DecidedSigns(const LatticeFunction& f);

    bool inside(std::int64_t i) const { return inside_[static_cast<std::size_t>(i)] != 0; }
    void set(std::int64_t i, bool inside) { inside_[static_cast<std::size_t>(i)] = inside; }
    // The sign that place i has by the signs of the lattice points around it.
    // REQUIRES: not a lattice point, not on the border; faces of the cell are as they should be.
    bool derived(std::int64_t i, const openvdb::Coord& at) const;
    std::int64_t stride(int axis) const { return stride_[axis]; }

  private:
    bool faceDerived(std::int64_t i, std::int64_t s, std::int64_t t) const;
    bool cellDerived(std::int64_t i) const;
    unsigned patternOf(std::int64_t i) const;
    std::int64_t cornerOf(std::int64_t i, unsigned corner) const;
    std::int64_t faceOf(std::int64_t i, int face) const;
    void joinMiddle(std::int64_t i);

    const LatticeFunction& f_;
    std::int64_t stride_[3];
    std::vector<char> inside_;
};

// Twice as fine as meshLattice(): F with the signs of DecidedSigns, so that { < 0 } has the parts, handles and
// cavities of the mesh.
MeshLattice decidedLattice(const BSplineField& field, int refine, const Progress& progress = {});

// The field whose lattice polygonize(field, refine) samples.
BSplineField refinedField(BSplineField field, int refine, const Progress& progress = {});

}  // namespace isowave
