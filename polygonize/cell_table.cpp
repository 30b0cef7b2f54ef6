#include "polygonize/cell_table.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace isowave {
namespace {

using Loop = std::vector<std::uint8_t>;
using CellTriangle = std::array<std::uint8_t, 3>;

CellEdge cellEdge(int e) {
    const int axis = e / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<std::uint8_t, 3> at{};
    at[u] = e & 1;
    at[v] = static_cast<std::uint8_t>((e & 3) >> 1);
    return {static_cast<std::uint8_t>(axis), at[0], at[1], at[2]};
}

int edgeBetween(int cornerA, int cornerB) {
    const int low = cornerA & cornerB, bit = cornerA ^ cornerB;
    const int axis = bit == 1 ? 0 : bit == 2 ? 1 : 2;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return 4 * axis + (low >> u & 1) + 2 * (low >> v & 1);
}

std::uint8_t rayTo(int corner) { return static_cast<std::uint8_t>(kCellEdges + corner); }

// The signs of a cell's corners and what is decided about its faces.
struct Signs {
    unsigned pattern, joined;

    bool inside(int corner) const { return (pattern >> corner & 1) != 0; }
    bool isAmbiguous(int face) const {
        const auto c = cornersOfFace(face);
        return inside(c[0]) == inside(c[2]) && inside(c[1]) == inside(c[3]) && inside(c[0]) != inside(c[1]);
    }
    bool isJoined(int face) const { return (joined >> face & 1) != 0; }
};

// ---- loops

// next[e]: where the segment that starts at edge e's vertex goes.
// Going round a face counter-clockwise, a run of inside corners is entered through one edge and left through
// another; its segment leads from the entered edge to the left one. (One inside corner at the origin: on the
// face z = 0, seen from below, it is entered through the x edge and left through the y edge; x -> y -> z is
// counter-clockwise seen from (1, 1, 1), which is outside the solid.) Where the inside is joined, segments cut off
// the outside corners: each leads from the edge that enters an inside corner to the one that left the inside
// corner before.
std::array<int, kCellEdges> segmentsOf(const Signs& signs) {
    std::array<int, kCellEdges> next;
    next.fill(-1);
    for (int face = 0; face < 6; ++face) {
        const auto corners = cornersOfFace(face);
        const bool joined = signs.isAmbiguous(face) && signs.isJoined(face);
        for (int k = 0; k < 4; ++k) {
            if (signs.inside(corners[k]) || !signs.inside(corners[(k + 1) % 4])) continue;
            const int entered = edgeBetween(corners[k], corners[(k + 1) % 4]);
            int last = k + 1;
            while (signs.inside(corners[(last + 1) % 4])) ++last;
            if (joined) last = k + 3;
            next[entered] = edgeBetween(corners[last % 4], corners[(last + 1) % 4]);
        }
    }
    return next;
}

std::vector<Loop> loopsOf(const Signs& signs) {
    const auto next = segmentsOf(signs);
    std::vector<Loop> loops;
    std::array<bool, kCellEdges> seen{};
    for (int start = 0; start < kCellEdges; ++start) {
        if (next[start] < 0 || seen[start]) continue;
        Loop loop;
        for (int e = start; !seen[e]; e = next[e]) {
            seen[e] = true;
            loop.push_back(static_cast<std::uint8_t>(e));
        }
        loops.push_back(loop);
    }
    return loops;
}

// ---- regions of the cell's surface: corners of one sign, connected along edges and across faces

class Regions {
  public:
    explicit Regions(const Signs& signs) {
        std::iota(parent_.begin(), parent_.end(), 0);
        for (int a = 0; a < kCellCorners; ++a)
            for (int bit : {1, 2, 4})
                if (signs.inside(a) == signs.inside(a ^ bit)) join(a, a ^ bit);
        for (int face = 0; face < 6; ++face) {
            if (!signs.isAmbiguous(face)) continue;
            const auto c = cornersOfFace(face);
            const int first = signs.inside(c[0]) == signs.isJoined(face) ? 0 : 1;
            join(c[first], c[first + 2]);
        }
    }
    int of(int corner) const {
        while (parent_[corner] != corner) corner = parent_[corner];
        return corner;
    }

  private:
    void join(int a, int b) { parent_[of(a)] = of(b); }
    std::array<int, kCellCorners> parent_;
};

// The region of that sign beside a loop.
int regionBeside(const Loop& loop, bool inside, const Signs& signs, const Regions& regions) {
    const CellEdge e = cellEdge(loop.front());
    const int low = e.x + 2 * e.y + 4 * e.z;
    return regions.of(signs.inside(low) == inside ? low : low | 1 << e.axis);
}

// ---- filling a loop by diagonals

// Squared distance between the middles of two edges, in units of half an edge.
int squaredDistance(int edgeA, int edgeB) {
    const auto middle = [](int e) {
        const CellEdge c = cellEdge(e);
        std::array<int, 3> at{2 * c.x, 2 * c.y, 2 * c.z};
        at[c.axis] = 1;
        return at;
    };
    const auto a = middle(edgeA), b = middle(edgeB);
    int sum = 0;
    for (int i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

struct Triangulation {
    int cost = 0;  // sum of the squared lengths of its diagonals: short ones fold least
    std::vector<CellTriangle> triangles;
};

// The cheapest triangulation of the loop's part first..last that closes over the chord first-last, by the
// usual recursion over the third corner of that chord's triangle; nothing when every one has a diagonal in a
// face. Loops have at most 12 vertices, and this runs once for each case: no table of subproblems is needed.
std::optional<Triangulation> triangulate(const Loop& loop, int first, int last) {
    if (last - first < 2) return Triangulation{};
    const bool isSide = first == 0 && last + 1 == static_cast<int>(loop.size());
    if (!isSide && (facesOfEdge(loop[first]) & facesOfEdge(loop[last]))) return std::nullopt;
    std::optional<Triangulation> best;
    for (int third = first + 1; third < last; ++third) {
        const auto a = triangulate(loop, first, third), b = triangulate(loop, third, last);
        if (!a || !b) continue;
        Triangulation whole = *a;
        whole.cost += b->cost + (isSide ? 0 : squaredDistance(loop[first], loop[last]));
        whole.triangles.insert(whole.triangles.end(), b->triangles.begin(), b->triangles.end());
        whole.triangles.push_back({loop[first], loop[third], loop[last]});
        if (!best || whole.cost < best->cost) best = whole;
    }
    return best;
}

// Nothing, too, where the triangles might cross each other: in a loop around half the cell, and in two loops of six, whose
// triangles reach into each other. All others do not, wherever the vertices are on their edges (a test tries).
std::optional<Triangulation> triangulate(const Loop& loop, const std::vector<Loop>& loops) {
    const auto isLong = [](const Loop& l) { return l.size() >= 6; };
    if (loop.size() > 9 || (isLong(loop) && std::count_if(loops.begin(), loops.end(), isLong) > 1))
        return std::nullopt;
    return triangulate(loop, 0, static_cast<int>(loop.size()) - 1);
}

// ---- drawing a surface radially over a region

// The parts of a face that a region covers, as polygons of vertex names, counter-clockwise seen from outside the cell. Each
// begins with a corner of the region from which every diagonal of a fan runs inside the polygon.
std::vector<Loop> polygonsOn(int face, int region, const Signs& signs, const Regions& regions) {
    const auto corners = cornersOfFace(face);
    const auto isOurs = [&](int k) { return regions.of(corners[k % 4]) == region; };
    const auto crossing = [&](int k) {
        return static_cast<std::uint8_t>(edgeBetween(corners[k % 4], corners[(k + 1) % 4]));
    };
    const bool across = signs.isAmbiguous(face) && (isOurs(0) ? isOurs(2) : isOurs(1) && isOurs(3)) &&
                        signs.isJoined(face) == signs.inside(corners[isOurs(0) ? 0 : 1]);
    if (across) {
        const int k = isOurs(0) ? 0 : 1;
        const std::uint8_t a = rayTo(corners[k]), b = rayTo(corners[k + 2]);
        return {{a, crossing(k), crossing(k + 1), b}, {b, crossing(k + 2), crossing(k + 3), a}};
    }
    if (isOurs(0) && isOurs(1) && isOurs(2) && isOurs(3))
        return {{rayTo(corners[0]), rayTo(corners[1]), rayTo(corners[2]), rayTo(corners[3])}};
    std::vector<Loop> polygons;
    for (int k = 0; k < 4; ++k) {  // runs of corners that begin at k
        if (!isOurs(k) || isOurs(k + 3)) continue;
        int length = 1;
        while (isOurs(k + length)) ++length;
        Loop polygon;
        for (int i = 0; i < length; ++i) polygon.push_back(rayTo(corners[(k + i) % 4]));
        polygon.push_back(crossing(k + length - 1));
        polygon.push_back(crossing(k + 3));
        std::rotate(polygon.begin(), polygon.begin() + (length - 1) / 2, polygon.end());
        polygons.push_back(polygon);
    }
    return polygons;
}

void drawRadially(int region, bool middleInside, const Signs& signs, const Regions& regions, CellCase& cell) {
    for (int c = 0; c < kCellCorners; ++c)
        if (regions.of(c) == region) cell.rays |= static_cast<std::uint8_t>(1 << c);
    for (int face = 0; face < 6; ++face)
        for (const Loop& polygon : polygonsOn(face, region, signs, regions))
            for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
                CellTriangle t{polygon[0], polygon[k], polygon[k + 1]};
                // Seen from outside the solid: from outside the cell where the middle is inside.
                if (!middleInside) std::swap(t[1], t[2]);
                cell.triangles.push_back(t);
            }
}

// Whether the sign of the middle makes a difference: more than one loop, or one that no diagonals fill.
bool asksMiddle(const std::vector<Loop>& loops) {
    return loops.size() > 1 || (loops.size() == 1 && !triangulate(loops.front(), loops));
}

CellCase caseOf(const Signs& signs, bool middleInside) {
    CellCase cell;
    cell.loops = loopsOf(signs);
    const Regions regions(signs);
    std::array<int, kCellCorners> loopsAt{};
    for (const Loop& loop : cell.loops) ++loopsAt[regionBeside(loop, !middleInside, signs, regions)];
    std::array<bool, kCellCorners> drawn{};
    for (const Loop& loop : cell.loops) {
        const int region = regionBeside(loop, !middleInside, signs, regions);
        const auto filling = loopsAt[region] == 1 ? triangulate(loop, cell.loops) : std::nullopt;
        if (filling)
            cell.triangles.insert(cell.triangles.end(), filling->triangles.begin(), filling->triangles.end());
        else if (!drawn[region])
            drawRadially(region, middleInside, signs, regions, cell);
        drawn[region] = true;
    }
    return cell;
}

// The bits of `index` spread over the set bits of `mask`.
unsigned spread(unsigned index, unsigned mask) {
    unsigned result = 0;
    for (int bit = 0, from = 0; bit < 6; ++bit)
        if (mask >> bit & 1) result |= (index >> from++ & 1) << bit;
    return result;
}

}  // namespace

std::array<int, 4> cornersOfFace(int face) {
    const int axis = face / 2, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int base = face % 2 ? 1 << axis : 0;
    // u x v points along +axis, which is outward on the high face.
    if (face % 2) return {base, base + u, base + u + v, base + v};
    return {base, base + v, base + u + v, base + u};
}

unsigned facesOfEdge(int e) {
    const CellEdge c = cellEdge(e);
    const std::array<int, 3> at{c.x, c.y, c.z};
    unsigned faces = 0;
    for (int axis = 0; axis < 3; ++axis)
        if (axis != c.axis) faces |= 1u << (2 * axis + at[axis]);
    return faces;
}

CellTable::CellTable() {
    for (int e = 0; e < kCellEdges; ++e) edges_[static_cast<std::size_t>(e)] = cellEdge(e);
    for (unsigned pattern = 0; pattern < 256; ++pattern) add(pattern);
}

void CellTable::add(unsigned pattern) {
    unsigned count = 0;
    for (int face = 0; face < 6; ++face)
        if (Signs{pattern, 0}.isAmbiguous(face)) {
            ambiguous_[pattern] |= static_cast<std::uint8_t>(1 << face);
            ++count;
        }
    if (count == 0 && !asksMiddle(loopsOf({pattern, 0}))) {
        cases_[pattern].push_back(caseOf({pattern, 0}, false));
        return;
    }
    for (unsigned index = 0; index < 1u << count; ++index) {
        const Signs signs{pattern, spread(index, ambiguous_[pattern])};
        needsMiddle_[pattern].push_back(asksMiddle(loopsOf(signs)));
        for (const bool middle : {false, true}) cases_[pattern].push_back(caseOf(signs, middle));
    }
}

std::size_t CellTable::compressed(unsigned pattern, unsigned joined) const {
    std::size_t index = 0;
    unsigned to = 0;
    for (unsigned mask = ambiguous_[pattern]; mask != 0; mask &= mask - 1)
        index |= static_cast<std::size_t>((joined & mask & -mask) != 0) << to++;
    return index;
}

const CellTable& cellTable() {
    static const CellTable table;
    return table;
}

}  // namespace isowave
