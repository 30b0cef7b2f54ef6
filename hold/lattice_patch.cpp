#include "hold/lattice_patch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

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

// Lattice points of one sign that follow each other along z.
struct Run {
    int begin, end;
    bool inside;
    std::uint32_t parent;
    bool atBorder;
};

// Pieces of one sign, joined across faces, edges and corners: runs row by row, each joined to those of the four rows before.
class Pieces {
  public:
    explicit Pieces(const LatticeFunction& f) : size_(f.size) {
        for (int x = 0; x < size_[0]; ++x)
            for (int y = 0; y < size_[1]; ++y) addRow(f, x, y);
        first_.push_back(count());
        for (int x = 0; x < size_[0]; ++x)
            for (int y = 0; y < size_[1]; ++y)
                for (const auto& [dx, dy] : {std::pair{0, -1}, {-1, -1}, {-1, 0}, {-1, 1}})
                    if (x + dx >= 0 && y + dy >= 0 && y + dy < size_[1]) join(row(x, y), row(x + dx, y + dy));
    }
    std::int64_t closed() {
        for (std::uint32_t r = 0; r < count(); ++r)
            if (runs_[r].atBorder) runs_[rootOf(r)].atBorder = true;
        std::int64_t closed = 0;
        for (std::uint32_t r = 0; r < count(); ++r) closed += runs_[r].parent == r && !runs_[r].atBorder;
        return closed;
    }

  private:
    std::uint32_t count() const { return static_cast<std::uint32_t>(runs_.size()); }
    std::size_t row(int x, int y) const { return static_cast<std::size_t>(x) * size_[1] + y; }
    void addRow(const LatticeFunction& f, int x, int y) {
        first_.push_back(count());
        const float* values = &f.values[f.index(x, y, 0)];
        const bool outermost = x == 0 || y == 0 || x + 1 == size_[0] || y + 1 == size_[1];
        for (int z = 0, next; z < size_[2]; z = next) {
            const bool inside = values[z] < 0;
            for (next = z + 1; next < size_[2] && (values[next] < 0) == inside;) ++next;
            runs_.push_back({z, next, inside, count(), outermost || z == 0 || next == size_[2]});
        }
    }
    void join(std::size_t a, std::size_t b) {
        for (std::uint32_t i = first_[a], j = first_[b]; i < first_[a + 1] && j < first_[b + 1];) {
            const bool touch = runs_[i].begin <= runs_[j].end && runs_[j].begin <= runs_[i].end;
            if (touch && runs_[i].inside == runs_[j].inside) unite(i, j);
            const bool endTogether = runs_[i].end == runs_[j].end && i + 1 < first_[a + 1];
            if (endTogether && runs_[i + 1].inside == runs_[j].inside) unite(i + 1, j);  // across a corner
            ++(runs_[i].end < runs_[j].end ? i : j);
        }
    }
    std::uint32_t rootOf(std::uint32_t r) {
        while (runs_[r].parent != r) r = runs_[r].parent = runs_[runs_[r].parent].parent;
        return r;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = rootOf(a), b = rootOf(b);
        runs_[std::max(a, b)].parent = std::min(a, b);
    }

    Coord size_;
    std::vector<Run> runs_;
    std::vector<std::uint32_t> first_;  // of each row
};

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

void LatticePatch::gather(const Coord& origin, PaddedBlock& points) const {
    const Coord at = origin - lattice_.low;  // fine_ begins one before lattice_
    for (int x = -1; x < kBlock + 2; ++x)
        for (int y = -1; y < kBlock + 2; ++y)
            for (int z = -1; z < kBlock + 2; ++z)
                points.values[PaddedBlock::index(x, y, z)] =
                    fine_.values[fine_.index(at[0] + 1 + x, at[1] + 1 + y, at[2] + 1 + z)];
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

std::int64_t LatticePatch::closedPieces() const { return Pieces(lattice_.function).closed(); }

std::int64_t LatticePatch::twiceEuler() const {
    Count count;
    const Coord& size = lattice_.function.size;
    for (int x = 0; x + 1 < size[0]; ++x)
        for (int y = 0; y + 1 < size[1]; ++y)
            for (int z = 0; z + 1 < size[2]; ++z) countCell({x, y, z}, count);
    return 2 * count.vertices - count.triangles;
}

}  // namespace isowave
