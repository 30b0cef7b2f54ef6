#include "hold/mesh_lattice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "polygonize/cell_table.h"
#include "polygonize/knot_insertion.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

constexpr float kLeast = 1e-30f;  // of a value that is there for its sign

std::array<std::int64_t, 3> stridesOf(const Coord& size) {
    return {std::int64_t{size[1]} * size[2], size[2], 1};
}

// Control points of a box, dense.
LatticeFunction gathered(const BSplineField& field, const CoordBBox& box) {
    LatticeFunction f;
    f.size = box.dim();
    f.values.resize(static_cast<std::size_t>(box.volume()));
    tbb::parallel_for(0, f.size[0], [&](int x) {
        const auto accessor = field.controlPoints->getConstUnsafeAccessor();
        float* out = &f.values[f.index(x, 0, 0)];
        for (int y = 0; y < f.size[1]; ++y)
            for (int z = 0; z < f.size[2]; ++z) *out++ = accessor.getValue(box.min().offsetBy(x, y, z));
    });
    return f;
}

// One axis, into an array of another length: line(in, stride in, out, stride out) for each line.
template <class Line>
LatticeFunction alongAxis(const LatticeFunction& in, int axis, int length, const Line& line) {
    LatticeFunction out;
    out.size = in.size;
    out.size[axis] = length;
    out.values.resize(static_cast<std::size_t>(out.size[0]) * out.size[1] * out.size[2]);
    const auto from = stridesOf(in.size), to = stridesOf(out.size);
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    tbb::parallel_for(0, in.size[u], [&](int i) {
        for (int j = 0; j < in.size[v]; ++j)
            line(&in.values[i * from[u] + j * from[v]], from[axis], &out.values[i * to[u] + j * to[v]],
                 to[axis]);
    });
    return out;
}

// Control points n + 2, of which the first is one before: F at n lattice points, (1,4,1)/6.
LatticeFunction onPoints(const LatticeFunction& c, int axis) {
    const int n = c.size[axis] - 2;
    return alongAxis(c, axis, n, [n](const float* in, std::int64_t s, float* out, std::int64_t t) {
        for (int k = 0; k < n; ++k, in += s, out += t)
            *out = static_cast<float>((double(in[0]) + 4 * double(in[s]) + in[2 * s]) / 6);
    });
}

// And (1,23,23,1)/48 between them.
LatticeFunction onPointsAndBetween(const LatticeFunction& c, int axis) {
    const int n = c.size[axis] - 2;
    return alongAxis(c, axis, 2 * n - 1, [n](const float* in, std::int64_t s, float* out, std::int64_t t) {
        for (int k = 0; k < n; ++k, in += s, out += 2 * t) {
            *out = static_cast<float>((double(in[0]) + 4 * double(in[s]) + in[2 * s]) / 6);
            if (k + 1 < n)
                out[t] =
                    static_cast<float>((double(in[0]) + 23 * (double(in[s]) + in[2 * s]) + in[3 * s]) / 48);
        }
    });
}

// F < 0 only nearer than two to a control point < 0. The leaves' own box, which is rounded to blocks of 8, can hold three times as many
// lattice points, and so many too many for the decided lattice: socket_box.stl kept a cavity at level 3 that no other lattice has.
CoordBBox boxOf(const openvdb::FloatTree& tree) {
    CoordBBox box;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        const CoordBBox whole(leaf->origin(), leaf->origin().offsetBy(7));
        if (box.isInside(whole)) continue;
        const float* values = leaf->buffer().data();
        for (openvdb::Index n = 0; n < openvdb::FloatTree::LeafNodeType::SIZE; ++n)
            if (values[n] < 0) box.expand(leaf->offsetToGlobalCoord(n));
    }
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile < 0) box.expand(tile.getBoundingBox());
    if (box.empty()) return {Coord(0), Coord(1)};
    return {box.min().offsetBy(-2), box.max().offsetBy(2)};
}

int oddAxes(const Coord& c) { return (c[0] & 1) + (c[1] & 1) + (c[2] & 1); }

}  // namespace

BSplineField refinedField(BSplineField field, int refine, const Progress& progress) {
    for (; refine > 1; refine /= 2) field = insertKnots(field, progress);
    return field;
}

double latticePoints(const BSplineField& field, int refine) {
    double points = 1;
    const Coord size = boxOf(field.controlPoints->tree()).dim();
    for (int a = 0; a < 3; ++a) points *= double(refine) * size[a];
    return points;
}

MeshLattice meshLattice(const BSplineField& field, int refine, const Progress& progress) {
    const BSplineField fine = refinedField(field, refine, progress);
    CoordBBox box = boxOf(fine.controlPoints->tree());
    MeshLattice lattice;
    lattice.finer = refine;
    lattice.low = box.min();
    box.expand(1);
    lattice.function = gathered(fine, box);
    for (int axis = 0; axis < 3; ++axis) lattice.function = onPoints(lattice.function, axis);
    return lattice;
}

LatticeFunction halfwayValues(const BSplineField& field, const Coord& low, const Coord& points) {
    CoordBBox box(low, low + points.offsetBy(-1));
    box.expand(1);
    LatticeFunction f = gathered(field, box);
    for (int axis = 0; axis < 3; ++axis) f = onPointsAndBetween(f, axis);
    return f;
}

// ---- what the mesh sees

DecidedSigns::DecidedSigns(const LatticeFunction& f)
    : f_(f), stride_{f.index(1, 0, 0), f.index(0, 1, 0), 1}, inside_(f.values.size()) {
    std::transform(f.values.begin(), f.values.end(), inside_.begin(), [](float v) { return v < 0; });
    // Edges and faces follow from lattice points, cells from both.
    for (const bool cells : {false, true})
        tbb::parallel_for(0, f.size[0], [&](int x) {
            std::int64_t i = f.index(x, 0, 0);
            for (int y = 0; y < f.size[1]; ++y)
                for (int z = 0; z < f.size[2]; ++z, ++i)
                    if (const int odd = oddAxes({x, y, z}); odd > 0 && (odd == 3) == cells)
                        set(i, derived(i, {x, y, z}));
        });
    for (const int parity : {0, 1})  // of cells: two neighbours share a face
        tbb::parallel_for(0, (f.size[0] - 1) / 2, [&](int cell) {
            if (cell % 2 != parity) return;
            for (int y = 1; y < f.size[1]; y += 2)
                for (int z = 1; z < f.size[2]; z += 2) joinMiddle(f.index(2 * cell + 1, y, z));
        });
}

bool DecidedSigns::derived(std::int64_t i, const Coord& at) const {
    std::array<std::int64_t, 3> odd{};
    int n = 0;
    for (int a = 0; a < 3; ++a)
        if (at[a] & 1) odd[n++] = stride_[a];
    if (n == 1) return inside(i - odd[0]) || inside(i + odd[0]);
    return n == 2 ? faceDerived(i, odd[0], odd[1]) : cellDerived(i);
}

bool DecidedSigns::faceDerived(std::int64_t i, std::int64_t s, std::int64_t t) const {
    const int n = inside(i - s - t) + inside(i - s + t) + inside(i + s - t) + inside(i + s + t);
    return n == 4 || (n > 0 && f_.values[static_cast<std::size_t>(i)] < 0);
}

std::int64_t DecidedSigns::cornerOf(std::int64_t i, unsigned corner) const {
    for (int a = 0; a < 3; ++a) i += corner >> a & 1 ? stride_[a] : -stride_[a];
    return i;
}
std::int64_t DecidedSigns::faceOf(std::int64_t i, int face) const {
    return i + (face & 1 ? stride_[face / 2] : -stride_[face / 2]);
}
unsigned DecidedSigns::patternOf(std::int64_t i) const {
    unsigned pattern = 0;
    for (unsigned c = 0; c < kCellCorners; ++c) pattern |= static_cast<unsigned>(inside(cornerOf(i, c))) << c;
    return pattern;
}

bool DecidedSigns::cellDerived(std::int64_t i) const {
    const unsigned pattern = patternOf(i);
    if (pattern == 0 || pattern == 255) return pattern != 0;
    unsigned faces = 0;
    for (int face = 0; face < 6; ++face) faces |= static_cast<unsigned>(inside(faceOf(i, face))) << face;
    const bool asked = cellTable().needsMiddle(pattern, faces & cellTable().ambiguousFaces(pattern));
    if (!asked && (faces == 0 || faces == 63)) return faces != 0;
    return f_.values[static_cast<std::size_t>(i)] < 0;
}

// A middle that is asked for and inside is joined to all that is inside around it: through faces, of which those that
// are not ambiguous and have a corner inside may be either.
void DecidedSigns::joinMiddle(std::int64_t i) {
    if (!inside(i)) return;
    const unsigned pattern = patternOf(i), ambiguous = cellTable().ambiguousFaces(pattern);
    if (pattern == 255 || cellTable().isPlain(pattern)) return;
    unsigned joined = 0;
    for (int face = 0; face < 6; ++face) joined |= static_cast<unsigned>(inside(faceOf(i, face))) << face;
    if (!cellTable().needsMiddle(pattern, joined & ambiguous)) return;
    for (int face = 0; face < 6; ++face) {
        if (ambiguous >> face & 1) continue;
        for (const int c : cornersOfFace(face))
            if (pattern >> c & 1) set(faceOf(i, face), true);
    }
}

MeshLattice decidedLattice(const BSplineField& field, int refine, const Progress& progress) {
    const BSplineField fine = refinedField(field, refine, progress);
    const CoordBBox box = boxOf(fine.controlPoints->tree());
    MeshLattice lattice;
    lattice.finer = 2 * refine;
    lattice.low = box.min() << 1;
    const LatticeFunction f = halfwayValues(fine, box.min(), box.dim());
    const DecidedSigns signs(f);
    lattice.function = f;
    tbb::parallel_for(0, f.size[0], [&](int x) {
        std::int64_t i = f.index(x, 0, 0);
        for (int y = 0; y < f.size[1]; ++y)
            for (int z = 0; z < f.size[2]; ++z, ++i) {
                float& v = lattice.function.values[i];
                const Coord at(x, y, z);
                if (oddAxes(at) == 1)  // of two ends that differ an edge has the lower one, as its sign
                    for (int a = 0; a < 3; ++a)
                        if (at[a] & 1) {
                            const float low = f.values[i - signs.stride(a)],
                                        high = f.values[i + signs.stride(a)];
                            if ((low < 0) != (high < 0)) v = std::min(low, high);
                        }
                v = signs.inside(i) ? std::min(v, -kLeast) : std::max(v, kLeast);
            }
    });
    return lattice;
}

}  // namespace isowave
