#include "polygonize/cell_table.h"

#include <optional>
#include <vector>

namespace isowave {
namespace {

using Loop = std::vector<std::uint8_t>;
using LoopTriangle = std::array<int, 3>;  // positions in a loop

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

// The four corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> cornersOfFace(int face) {
    const int axis = face / 2, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int base = face % 2 ? 1 << axis : 0;
    // u x v points along +axis, which is outward on the high face.
    if (face % 2) return {base, base + u, base + u + v, base + v};
    return {base, base + v, base + u + v, base + u};
}

// next[e]: where the segment that starts at edge e's vertex goes.
// Going round a face counter-clockwise, a run of inside corners is entered through one edge and left through
// another; its segment leads from the entered edge to the left one. (One inside corner at the origin: on the
// face z = 0, seen from below, it is entered through the x edge and left through the y edge; x -> y -> z is
// counter-clockwise seen from (1, 1, 1), which is outside the solid.)
std::array<int, kCellEdges> segmentsOf(unsigned pattern) {
    std::array<int, kCellEdges> next;
    next.fill(-1);
    const auto inside = [&](int corner) { return (pattern >> corner & 1) != 0; };
    for (int face = 0; face < 6; ++face) {
        const auto corners = cornersOfFace(face);
        for (int k = 0; k < 4; ++k) {
            if (inside(corners[k]) || !inside(corners[(k + 1) % 4])) continue;
            const int entered = edgeBetween(corners[k], corners[(k + 1) % 4]);
            int last = k + 1;
            while (inside(corners[(last + 1) % 4])) ++last;
            next[entered] = edgeBetween(corners[last % 4], corners[(last + 1) % 4]);
        }
    }
    return next;
}

std::vector<Loop> loopsOf(unsigned pattern) {
    const auto next = segmentsOf(pattern);
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
    std::vector<LoopTriangle> triangles;
};

// The cheapest triangulation of the loop's part first..last that closes over the chord first-last, by the
// usual recursion over the third corner of that chord's triangle; nothing when every one has a diagonal in a
// face. Loops have at most 7 vertices, and this runs once for each case: no table of subproblems is needed.
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
        whole.triangles.push_back({first, third, last});
        if (!best || whole.cost < best->cost) best = whole;
    }
    return best;
}

CellCase caseOf(unsigned pattern) {
    CellCase cell;
    std::size_t position = 0;
    for (const Loop& loop : loopsOf(pattern)) {
        cell.loopLength.at(cell.loopCount++) = static_cast<std::uint8_t>(loop.size());
        for (const std::uint8_t edge : loop) cell.loopEdges.at(position++) = edge;
        // value() and at() throw where the header's claims about all 256 cases would be wrong; a test runs
        // them all.
        const Triangulation filling = triangulate(loop, 0, static_cast<int>(loop.size()) - 1).value();
        for (const auto& [a, b, c] : filling.triangles)
            cell.triangles.at(cell.triangleCount++) = {loop[a], loop[b], loop[c]};
    }
    return cell;
}

CellTable generate() {
    CellTable table;
    for (int e = 0; e < kCellEdges; ++e) table.edges[e] = cellEdge(e);
    for (unsigned pattern = 0; pattern < 256; ++pattern) table.cases[pattern] = caseOf(pattern);
    return table;
}

}  // namespace

unsigned facesOfEdge(int e) {
    const CellEdge c = cellEdge(e);
    const std::array<int, 3> at{c.x, c.y, c.z};
    unsigned faces = 0;
    for (int axis = 0; axis < 3; ++axis)
        if (axis != c.axis) faces |= 1u << (2 * axis + at[axis]);
    return faces;
}

const CellTable& cellTable() {
    static const CellTable table = generate();
    return table;
}

}  // namespace isowave
