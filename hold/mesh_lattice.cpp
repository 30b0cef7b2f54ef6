#include "hold/mesh_lattice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "polygonize/cell_table.h"
#include "polygonize/knot_insertion.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

constexpr float kLeast = 1e-30f;  // of a value that is there for its sign
float insideOf(float v) { return std::min(v, -kLeast); }
float outsideOf(float v) { return std::max(v, kLeast); }

template <class Body>
void forEachPlane(int planes, const Body& body) {
    tbb::parallel_for(0, planes, body);
}

// One axis of (1,4,1)/6 in place, in parallel over lines; ends are left as they are.
void filterAxis(LatticeFunction& f, int axis) {
    const std::array<std::int64_t, 3> stride{std::int64_t{f.size[1]} * f.size[2], f.size[2], 1};
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    forEachPlane(f.size[u], [&](int i) {
        for (int j = 0; j < f.size[v]; ++j) {
            float* line = &f.values[i * stride[u] + j * stride[v]];
            const std::int64_t s = stride[axis];
            double before = line[0];
            for (int k = 1; k + 1 < f.size[axis]; ++k) {
                const double here = line[k * s];
                line[k * s] = static_cast<float>((before + 4 * here + line[(k + 1) * s]) / 6);
                before = here;
            }
        }
    });
}

CoordBBox boxOf(const openvdb::FloatTree& tree) {
    CoordBBox box;
    if (!tree.evalLeafBoundingBox(box)) return {Coord(0), Coord(0)};
    return {box.min().offsetBy(-2), box.max().offsetBy(3)};  // both even
}

// F at the lattice points of a field's control points.
MeshLattice valuesOf(const BSplineField& field) {
    const CoordBBox box = boxOf(field.controlPoints->tree());
    MeshLattice lattice;
    lattice.low = box.min();
    lattice.function.size = box.dim();
    lattice.function.values.resize(static_cast<std::size_t>(box.volume()));
    forEachPlane(lattice.function.size[0], [&](int x) {
        const auto accessor = field.controlPoints->getConstUnsafeAccessor();
        float* out = &lattice.function.values[lattice.function.index(x, 0, 0)];
        for (int y = 0; y < lattice.function.size[1]; ++y)
            for (int z = 0; z < lattice.function.size[2]; ++z)
                *out++ = accessor.getValue(lattice.low.offsetBy(x, y, z));
    });
    for (int axis = 0; axis < 3; ++axis) filterAxis(lattice.function, axis);
    return lattice;
}

BSplineField refined(BSplineField field, int refine, const Progress& progress) {
    for (; refine > 1; refine /= 2) field = insertKnots(field, progress);
    return field;
}

// ---- the signs that a mesh sees on the doubled lattice

class Decider {
  public:
    explicit Decider(LatticeFunction& f) : f_(f), stride_{f.index(1, 0, 0), f.index(0, 1, 0), 1} {}

    // Cells last: they set faces, and read them.
    void run() {
        const int cells = (f_.size[0] - 1) / 2;
        forEachPlane(f_.size[0], [&](int x) { edgesAndFaces(x); });
        for (const int parity : {0, 1})  // a cell sets its faces, one of which its neighbour shares
            forEachPlane((cells - parity + 1) / 2, [&](int i) { cellsAt(2 * (2 * i + parity) + 1); });
    }

  private:
    bool isInside(std::int64_t i) const { return f_.values[i] < 0; }

    void edgesAndFaces(int x) {
        for (int y = 0; y < f_.size[1]; ++y)
            for (int z = 0; z < f_.size[2]; ++z) {
                std::array<int, 3> odd{};
                int n = 0;
                for (int a = 0; a < 3; ++a)
                    if (std::array{x, y, z}[a] & 1) odd[n++] = a;
                const std::int64_t i = f_.index(x, y, z);
                if (n == 1) edge(i, stride_[odd[0]]);
                if (n == 2) face(i, stride_[odd[0]], stride_[odd[1]]);
            }
    }
    void edge(std::int64_t i, std::int64_t s) {
        const float a = f_.values[i - s], b = f_.values[i + s];
        float& v = f_.values[i];
        v = (a < 0) != (b < 0) ? std::min(a, b) : a < 0 ? insideOf(v) : outsideOf(v);
    }
    void face(std::int64_t i, std::int64_t s, std::int64_t t) {
        const int inside = isInside(i - s - t) + isInside(i - s + t) + isInside(i + s - t) + isInside(i + s + t);
        float& v = f_.values[i];
        if (inside == 0) v = outsideOf(v);
        if (inside == 4) v = insideOf(v);
    }

    void cellsAt(int x) {
        for (int y = 1; y + 1 < f_.size[1]; y += 2)
            for (int z = 1; z + 1 < f_.size[2]; z += 2) cell(f_.index(x, y, z));
    }
    void cell(std::int64_t i) {
        unsigned pattern = 0;
        for (unsigned c = 0; c < kCellCorners; ++c)
            pattern |= static_cast<unsigned>(isInside(cornerOf(i, c))) << c;
        float& v = f_.values[i];
        if (pattern == 0) return void(v = outsideOf(v));
        if (pattern == 255) return void(v = insideOf(v));
        const unsigned ambiguous = cellTable().ambiguousFaces(pattern);
        unsigned inside = 0;
        for (int face = 0; face < 6; ++face) inside |= static_cast<unsigned>(isInside(faceOf(i, face))) << face;
        if (!cellTable().needsMiddle(pattern, inside & ambiguous)) {
            if (inside == 0) v = outsideOf(v);
            if (inside == 63) v = insideOf(v);
        } else if (v < 0) {
            openFaces(i, ambiguous);
        }
    }
    // The middle is joined to all that is inside around it: through faces, of which those that are not ambiguous
    // and have a corner inside may be either.
    void openFaces(std::int64_t i, unsigned ambiguous) {
        for (int face = 0; face < 6; ++face) {
            if (ambiguous >> face & 1) continue;
            bool any = false;
            for (const int c : cornersOfFace(face)) any = any || isInside(cornerOf(i, static_cast<unsigned>(c)));
            float& v = f_.values[faceOf(i, face)];
            if (any) v = insideOf(v);
        }
    }
    std::int64_t cornerOf(std::int64_t i, unsigned c) const {
        for (int a = 0; a < 3; ++a) i += c >> a & 1 ? stride_[a] : -stride_[a];
        return i;
    }
    std::int64_t faceOf(std::int64_t i, int face) const {
        return i + (face & 1 ? stride_[face / 2] : -stride_[face / 2]);
    }

    LatticeFunction& f_;
    std::array<std::int64_t, 3> stride_;
};

}  // namespace

double latticePoints(const BSplineField& field, int refine) {
    double points = 1;
    const Coord size = boxOf(field.controlPoints->tree()).dim();
    for (int a = 0; a < 3; ++a) points *= double(refine) * size[a];
    return points;
}

MeshLattice meshLattice(const BSplineField& field, int refine, const Progress& progress) {
    MeshLattice lattice = valuesOf(refined(field, refine, progress));
    lattice.finer = refine;
    return lattice;
}

MeshLattice decidedLattice(const BSplineField& field, int refine, const Progress& progress) {
    MeshLattice lattice = meshLattice(field, 2 * refine, progress);
    // Its first and last points are even: every edge, face and cell is whole.
    Decider(lattice.function).run();
    return lattice;
}

}  // namespace isowave
