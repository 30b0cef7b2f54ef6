#include "polygonize/cell_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <vector>

namespace isowave {
namespace {

using Segment = std::pair<int, int>;  // directed, between edges

std::vector<std::vector<int>> loopsOf(const CellCase& cell) {
    std::vector<std::vector<int>> loops;
    for (int k = 0, at = 0; k < cell.loopCount; at += cell.loopLength[k++])
        loops.emplace_back(cell.loopEdges.begin() + at, cell.loopEdges.begin() + at + cell.loopLength[k]);
    return loops;
}

// The directed sides of the triangles, less those that two triangles run along in opposite directions.
std::set<Segment> boundaryOf(const CellCase& cell) {
    std::multiset<Segment> sides;
    for (int t = 0; t < cell.triangleCount; ++t)
        for (int k = 0; k < 3; ++k) sides.insert({cell.triangles[t][k], cell.triangles[t][(k + 1) % 3]});
    std::set<Segment> boundary;
    for (const auto& [a, b] : sides) {
        EXPECT_EQ(sides.count({a, b}), 1u);
        if (!sides.count({b, a})) boundary.insert({a, b});
    }
    return boundary;
}

bool shareAFace(int a, int b) { return (facesOfEdge(a) & facesOfEdge(b)) != 0; }

// What is wrong with a case, in words; empty when nothing is.
std::string faultOf(const CellCase& cell) {
    const auto boundary = boundaryOf(cell);
    std::set<Segment> loopSides;
    for (const auto& loop : loopsOf(cell))
        for (std::size_t k = 0; k < loop.size(); ++k)
            loopSides.insert({loop[k], loop[(k + 1) % loop.size()]});
    if (boundary != loopSides) return "the triangles do not fill the loops";
    for (const auto& [a, b] : boundary)
        if (!shareAFace(a, b)) return "a segment lies in no face";
    for (int t = 0; t < cell.triangleCount; ++t)
        for (int k = 0; k < 3; ++k) {
            const Segment side{cell.triangles[t][k], cell.triangles[t][(k + 1) % 3]};
            if (!boundary.count(side) && shareAFace(side.first, side.second))
                return "a diagonal lies in a face";
        }
    return {};
}

int cornersAcross(unsigned pattern, int e) {
    const CellEdge& edge = cellTable().edges[e];
    const int low = edge.x + 2 * edge.y + 4 * edge.z, high = low | 1 << edge.axis;
    return (pattern >> low & 1) + (pattern >> high & 1);
}

TEST(CellTable, HasOneVertexOnEveryEdgeWhoseEndsDifferAndOnNoOther) {
    for (unsigned pattern = 0; pattern < 256; ++pattern) {
        const CellCase& cell = cellTable().cases[pattern];
        std::multiset<int> used;
        for (const auto& loop : loopsOf(cell)) used.insert(loop.begin(), loop.end());
        for (int e = 0; e < kCellEdges; ++e)
            EXPECT_EQ(used.count(e), cornersAcross(pattern, e) == 1 ? 1u : 0u) << pattern << " " << e;
    }
}

TEST(CellTable, TrianglesFillTheLoopsAndNoDiagonalLiesInAFace) {
    int longest = 0, mostTriangles = 0, mostLoops = 0;
    for (unsigned pattern = 0; pattern < 256; ++pattern) {
        const CellCase& cell = cellTable().cases[pattern];
        EXPECT_EQ(faultOf(cell), "") << pattern;
        for (const auto& loop : loopsOf(cell)) longest = std::max(longest, static_cast<int>(loop.size()));
        mostTriangles = std::max<int>(mostTriangles, cell.triangleCount);
        mostLoops = std::max<int>(mostLoops, cell.loopCount);
    }
    EXPECT_EQ(longest, 7);
    EXPECT_EQ(mostTriangles, kMaxCellTriangles);
    EXPECT_EQ(mostLoops, kMaxCellLoops);
}

TEST(CellTable, TheCheckSeesADiagonalInAFaceAndAMissingTriangle) {
    // Turning the diagonals of all quadrilaterals puts some into faces.
    int inFace = 0;
    for (CellCase cell : cellTable().cases) {
        if (cell.loopCount != 1 || cell.loopLength[0] < 5) continue;
        // A fan from each vertex in turn: one of them has a forbidden diagonal.
        const auto loop = loopsOf(cell)[0];
        const int n = static_cast<int>(loop.size());
        for (int apex = 0; apex < n; ++apex) {
            for (int k = 0; k + 2 < n; ++k)
                cell.triangles[k] = {static_cast<std::uint8_t>(loop[apex]),
                                     static_cast<std::uint8_t>(loop[(apex + k + 1) % n]),
                                     static_cast<std::uint8_t>(loop[(apex + k + 2) % n])};
            inFace += faultOf(cell) == "a diagonal lies in a face";
        }
    }
    EXPECT_GT(inFace, 0);
    CellCase broken = cellTable().cases[0b00000011];
    --broken.triangleCount;
    EXPECT_NE(faultOf(broken), "");
}

// The segments that a cell draws on one of its faces, named by the face's own edges: (axis, position in the
// face).
std::set<std::pair<std::array<int, 3>, std::array<int, 3>>> segmentsOnFace(unsigned pattern, int face) {
    const int axis = face / 2;
    const auto nameOf = [&](int e) {
        const CellEdge& edge = cellTable().edges[e];
        std::array<int, 3> at{edge.x, edge.y, edge.z};
        return std::array<int, 3>{edge.axis, at[(axis + 1) % 3], at[(axis + 2) % 3]};
    };
    std::set<std::pair<std::array<int, 3>, std::array<int, 3>>> segments;
    for (const auto& [a, b] : boundaryOf(cellTable().cases[pattern]))
        if (facesOfEdge(a) & facesOfEdge(b) & 1u << face) segments.insert({nameOf(a), nameOf(b)});
    return segments;
}

TEST(CellTable, NeighboursDrawTheSameSegmentsOnTheirFaceInOppositeDirectionsForAll4096Pairs) {
    for (int axis = 0; axis < 3; ++axis)
        for (unsigned signs = 0; signs < 4096; ++signs) {
            // 12 lattice points: three layers of four along the axis.
            unsigned lower = 0, upper = 0;
            for (int layer = 0; layer < 3; ++layer)
                for (int k = 0; k < 4; ++k) {
                    const unsigned bit = signs >> (4 * layer + k) & 1;
                    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
                    const int corner = (k & 1) * u + (k >> 1) * v;
                    if (layer < 2) lower |= bit << (corner + (layer << axis));
                    if (layer > 0) upper |= bit << (corner + ((layer - 1) << axis));
                }
            const auto mine = segmentsOnFace(lower, 2 * axis + 1), other = segmentsOnFace(upper, 2 * axis);
            auto reversed = other;
            reversed.clear();
            for (const auto& [a, b] : other) reversed.insert({b, a});
            ASSERT_EQ(mine, reversed) << "axis " << axis << " signs " << signs;
        }
}

TEST(CellTable, AmbiguousFacesSeparateTheInsideCorners) {
    // Corners 0 and 3 lie across the face z = 0.
    const CellCase& cell = cellTable().cases[0b00001001];
    EXPECT_EQ(cell.loopCount, 2);
    EXPECT_EQ(cell.loopLength[0], 3);
    // Their complement is joined inside there: one loop cannot pass between, the two outside corners connect.
    EXPECT_EQ(cellTable().cases[0b11110110].loopCount, 1);
}

// Regions of the cell's surface: inside corners connected along edges, outside ones along edges and across
// ambiguous faces. Loops separate them, so there is one loop fewer than regions.
int regionsOf(unsigned pattern) {
    std::array<int, 8> parent;
    std::iota(parent.begin(), parent.end(), 0);
    const auto rootOf = [&](int c) {
        while (parent[c] != c) c = parent[c];
        return c;
    };
    for (int a = 0; a < 8; ++a)
        for (int b = 0; b < a; ++b) {
            const int apart = __builtin_popcount(a ^ b);
            const bool insideA = pattern >> a & 1, insideB = pattern >> b & 1;
            if (insideA == insideB && (apart == 1 || (apart == 2 && !insideA))) parent[rootOf(a)] = rootOf(b);
        }
    int regions = 0;
    for (int c = 0; c < 8; ++c) regions += parent[c] == c;
    return regions;
}

TEST(CellTable, HasOneLoopFewerThanRegionsOfTheCellsSurface) {
    for (unsigned pattern = 0; pattern < 256; ++pattern)
        EXPECT_EQ(cellTable().cases[pattern].loopCount, regionsOf(pattern) - 1) << pattern;
}

TEST(CellTable, FacesOutwardsAtASingleInsideCorner) {
    // Corner 0: edges 0 (x), 4 (y), 8 (z) in this order run counter-clockwise seen from (1, 1, 1).
    const CellCase& cell = cellTable().cases[1];
    ASSERT_EQ(cell.triangleCount, 1);
    auto t = cell.triangles[0];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    EXPECT_EQ(t, (std::array<std::uint8_t, 3>{0, 4, 8}));
}

}  // namespace
}  // namespace isowave
