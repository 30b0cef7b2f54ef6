#include "hold/lattice_patch.h"

#include <array>
#include <bit>

#include "polygonize/cell_decision.h"

namespace isowave {
namespace {

using openvdb::Coord;

// Doubles, so that signs are those of the mesh: polygonize/knot_insertion.cpp rounds once for all three axes.
struct Dense {
    Coord size;
    std::vector<double> values;
};

// One value from three neighbours on an axis.
struct Taps {
    int from;
    std::array<double, 3> weights;
    double divisor;
};

// Value k of the axis becomes what taps(k) makes of the old ones, 0 <= k < length.
template <class TapsAt>
Dense alongAxis(const Dense& in, int axis, int length, const TapsAt& tapsAt) {
    Dense out{in.size, {}};
    out.size[axis] = length;
    std::size_t inner = 1, outer = 1;
    for (int a = 0; a < axis; ++a) outer *= static_cast<std::size_t>(in.size[a]);
    for (int a = axis + 1; a < 3; ++a) inner *= static_cast<std::size_t>(in.size[a]);
    out.values.resize(outer * length * inner);
    double* to = out.values.data();
    for (std::size_t o = 0; o < outer; ++o)
        for (int k = 0; k < length; ++k) {
            const Taps taps = tapsAt(k);
            const double* a = &in.values[(o * in.size[axis] + taps.from) * inner];
            const double *b = a + inner, *c = b + inner;
            for (std::size_t i = 0; i < inner; ++i)
                *to++ =
                    (taps.weights[0] * a[i] + taps.weights[1] * b[i] + taps.weights[2] * c[i]) / taps.divisor;
        }
    return out;
}

// n control points -> 2 n - 3: those at and between them that they alone decide. The first lies between the first two.
Dense insertedKnots(Dense c) {
    for (int axis = 2; axis >= 0; --axis) {
        const int n = c.size[axis];
        c = alongAxis(c, axis, 2 * n - 3, [n](int k) {
            if (k % 2 == 1) return Taps{k / 2, {1, 6, 1}, 8};
            return k / 2 + 2 < n ? Taps{k / 2, {1, 1, 0}, 2} : Taps{k / 2 - 1, {0, 1, 1}, 2};
        });
    }
    for (double& v : c.values) v = static_cast<float>(v);
    return c;
}

Dense onPoints(Dense c) {
    for (int axis = 2; axis >= 0; --axis)
        c = alongAxis(c, axis, c.size[axis] - 2, [](int k) { return Taps{k, {1, 4, 1}, 6}; });
    return c;
}

LatticeFunction toFloats(const Dense& d) {
    return {d.size, std::vector<float>(d.values.begin(), d.values.end())};
}

}  // namespace

LatticePatch::LatticePatch(const LatticeFunction& controlPoints, const Coord& low, int refine) {
    Dense c{controlPoints.size, {controlPoints.values.begin(), controlPoints.values.end()}};
    Coord first = low;
    for (int finer = 1; finer < refine; finer *= 2) {
        c = insertedKnots(std::move(c));
        first = Coord(2 * first[0] + 1, 2 * first[1] + 1, 2 * first[2] + 1);
    }
    fine_ = toFloats(c);
    lattice_.finer = refine;
    lattice_.low = first.offsetBy(1);
    lattice_.function = toFloats(onPoints(std::move(c)));
}

// The cell's triangles, its vertices inside, and those on the edges that start at its lowest corner.
void LatticePatch::countCell(const Coord& low, Count& count) const {
    const LatticeFunction& f = lattice_.function;
    unsigned pattern = 0;
    for (int c = 0; c < kCellCorners; ++c)
        pattern |= static_cast<unsigned>(
                       f.values[f.index(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2))] < 0)
                   << c;
    if (pattern == 0 || pattern == 255) return;
    for (const int c : {1, 2, 4}) count.vertices += (pattern & 1) != (pattern >> c & 1);
    const CellTable& table = cellTable();
    if (table.isPlain(pattern)) {
        count.triangles += static_cast<std::int64_t>(table.plain(pattern).triangles.size());
        return;
    }
    const CellDecision decision = decide(pattern, [&](int x, int y, int z) {
        return fine_.values[fine_.index(low[0] + 1 + x, low[1] + 1 + y, low[2] + 1 + z)];
    });
    const CellCase& chosen = table.at(pattern, decision);
    count.triangles += static_cast<std::int64_t>(chosen.triangles.size());
    count.vertices += std::popcount(chosen.rays);
}

std::int64_t LatticePatch::twiceEuler() const {
    Count count;
    const Coord& size = lattice_.function.size;
    for (int x = 0; x + 1 < size[0]; ++x)
        for (int y = 0; y + 1 < size[1]; ++y)
            for (int z = 0; z + 1 < size[2]; ++z) countCell({x, y, z}, count);
    return 2 * count.vertices - count.triangles;
}

}  // namespace isowave
