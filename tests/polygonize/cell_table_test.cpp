#include "polygonize/cell_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <vector>

namespace isowave {
namespace {

using Segment = std::pair<int, int>;  // directed, between vertices

// Every case of the table, with what leads to it.
template <class Body>
void forEachCase(const Body& body) {
    for (unsigned pattern = 0; pattern < 256; ++pattern)
        for (unsigned joined = 0; joined < 64; ++joined) {
            if (joined & ~cellTable().ambiguousFaces(pattern)) continue;
            for (const bool middleInside : {false, true}) {
                const CellDecision decision{static_cast<std::uint8_t>(joined), middleInside};
                body(pattern, decision, cellTable().at(pattern, decision));
            }
        }
}

std::string nameOf(unsigned pattern, const CellDecision& d) {
    return "pattern " + std::to_string(pattern) + ", joined " + std::to_string(d.joined) + ", middle " +
           (d.middleInside ? "inside" : "outside");
}

std::vector<Segment> sidesOf(const CellCase& cell) {
    std::vector<Segment> sides;
    for (const auto& t : cell.triangles)
        for (int k = 0; k < 3; ++k) sides.push_back({t[k], t[(k + 1) % 3]});
    return sides;
}

// The directed sides of the triangles, less those that two triangles run along in opposite directions.
std::set<Segment> boundaryOf(const CellCase& cell) {
    const auto list = sidesOf(cell);
    const std::multiset<Segment> sides(list.begin(), list.end());
    std::set<Segment> boundary;
    for (const auto& [a, b] : sides) {
        EXPECT_EQ(sides.count({a, b}), 1u);
        if (!sides.count({b, a})) boundary.insert({a, b});
    }
    return boundary;
}

bool onEdge(int vertex) { return vertex < kCellEdges; }
bool shareAFace(int a, int b) { return onEdge(a) && onEdge(b) && (facesOfEdge(a) & facesOfEdge(b)) != 0; }

// How many fans the triangles around a vertex form: rings, or chains between two sides of the border.
int fansAt(const CellCase& cell, int vertex) {
    std::map<int, int> next;
    for (const auto& t : cell.triangles)
        for (int k = 0; k < 3; ++k)
            if (t[k] == vertex) next[t[(k + 1) % 3]] = t[(k + 2) % 3];
    std::map<int, int> chain;
    for (const auto& [from, to] : next) chain[to] = from;
    int fans = 0;
    std::set<int> seen;
    for (const auto& [from, to] : next) {
        if (seen.count(from)) continue;
        int at = from;
        while (chain.count(at) && chain[at] != from) at = chain[at];
        for (int start = at; next.count(at) && !seen.count(at); at = next[at]) {
            seen.insert(at);
            if (next[at] == start) {
                seen.insert(start);
                break;
            }
        }
        ++fans;
    }
    return fans;
}

// What is wrong with a case, in words; empty when nothing is.
std::string faultOf(const CellCase& cell) {
    const auto boundary = boundaryOf(cell);
    std::set<Segment> loopSides;
    std::set<int> vertices;
    for (const auto& loop : cell.loops)
        for (std::size_t k = 0; k < loop.size(); ++k)
            loopSides.insert({loop[k], loop[(k + 1) % loop.size()]});
    if (boundary != loopSides) return "the triangles do not fill the loops";
    for (const auto& [a, b] : boundary)
        if (!shareAFace(a, b)) return "a segment lies in no face";
    for (const Segment& side : sidesOf(cell)) {
        vertices.insert(side.first);
        if (!boundary.count(side) && shareAFace(side.first, side.second)) return "a diagonal lies in a face";
    }
    for (const int v : vertices) {
        if (fansAt(cell, v) != 1) return "a vertex has two fans";
        if (!onEdge(v) && !(cell.rays >> (v - kCellEdges) & 1)) return "a vertex on a ray that is not listed";
    }
    return {};
}

int cornersAcross(unsigned pattern, int e) {
    const CellEdge& edge = cellTable().edge(e);
    const int low = edge.x + 2 * edge.y + 4 * edge.z, high = low | 1 << edge.axis;
    return (pattern >> low & 1) + (pattern >> high & 1);
}

TEST(CellTable, HasOneVertexOnEveryEdgeWhoseEndsDifferAndOnNoOther) {
    forEachCase([](unsigned pattern, const CellDecision& decision, const CellCase& cell) {
        std::multiset<int> used;
        for (const auto& loop : cell.loops) used.insert(loop.begin(), loop.end());
        for (int e = 0; e < kCellEdges; ++e)
            EXPECT_EQ(used.count(e), cornersAcross(pattern, e) == 1 ? 1u : 0u)
                << nameOf(pattern, decision) << " " << e;
    });
}

TEST(CellTable, TrianglesFillTheLoopsAsOneFanAVertexAndNoDiagonalLiesInAFace) {
    int cases = 0;
    std::size_t longest = 0, mostTriangles = 0, mostLoops = 0;
    forEachCase([&](unsigned pattern, const CellDecision& decision, const CellCase& cell) {
        EXPECT_EQ(faultOf(cell), "") << nameOf(pattern, decision);
        ++cases;
        for (const auto& loop : cell.loops) longest = std::max(longest, loop.size());
        mostTriangles = std::max(mostTriangles, cell.triangles.size());
        mostLoops = std::max(mostLoops, cell.loops.size());
    });
    EXPECT_EQ(cases, 1312);
    EXPECT_EQ(longest, 12u);
    EXPECT_EQ(mostTriangles, 24u);
    EXPECT_EQ(mostLoops, 4u);
}

// Where nothing is ambiguous the table is the plain one: no vertex inside a cell.
TEST(CellTable, HasVerticesInsideOnlyWhereTheSignsLeaveAChoice) {
    for (unsigned pattern = 0; pattern < 256; ++pattern)
        if (cellTable().isPlain(pattern)) {
            EXPECT_EQ(cellTable().plain(pattern).rays, 0);
            EXPECT_EQ(cellTable().ambiguousFaces(pattern), 0u);
            EXPECT_LE(cellTable().plain(pattern).loops.size(), 1u);
        }
}

// Squared, between the middles of two edges.
double squaredBetween(int edgeA, int edgeB) {
    const auto middle = [](int e) {
        const CellEdge& edge = cellTable().edge(e);
        std::array<double, 3> at{double(edge.x), double(edge.y), double(edge.z)};
        at[edge.axis] = 0.5;
        return at;
    };
    const auto a = middle(edgeA), b = middle(edgeB);
    return std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2);
}

// The least sum over the diagonals of all triangulations of loop[i..j], none of which has a diagonal in a face.
double leastDiagonals(const std::vector<std::uint8_t>& loop, std::size_t i, std::size_t j) {
    if (j - i < 2) return 0;
    const auto chord = [&](std::size_t a, std::size_t b) {
        if (b - a < 2) return 0.0;
        return shareAFace(loop[a], loop[b]) ? HUGE_VAL : squaredBetween(loop[a], loop[b]);
    };
    double least = HUGE_VAL;
    for (std::size_t k = i + 1; k < j; ++k)
        least = std::min(least,
                         chord(i, k) + chord(k, j) + leastDiagonals(loop, i, k) + leastDiagonals(loop, k, j));
    return least;
}

TEST(CellTable, FillsALoopByTheShortestDiagonals) {
    int longerThanFour = 0;
    for (unsigned pattern = 0; pattern < 256; ++pattern) {
        if (!cellTable().isPlain(pattern) || cellTable().plain(pattern).loops.size() != 1) continue;
        const CellCase& cell = cellTable().plain(pattern);
        const auto list = sidesOf(cell);
        const std::set<Segment> sides(list.begin(), list.end());
        double diagonals = 0;
        for (const auto& [a, b] : sides)
            if (a < b && sides.contains({b, a})) diagonals += squaredBetween(a, b);
        const auto& loop = cell.loops.front();
        EXPECT_DOUBLE_EQ(diagonals, leastDiagonals(loop, 0, loop.size() - 1)) << pattern;
        longerThanFour += loop.size() > 4;
    }
    EXPECT_GT(longerThanFour, 50);  // whose triangulations are not all as long
}

TEST(CellTable, TheCheckSeesADiagonalInAFaceAMissingTriangleAndTwoFans) {
    // Turning the diagonals of all polygons puts some into faces.
    int inFace = 0;
    for (unsigned pattern = 0; pattern < 256; ++pattern) {
        CellCase cell = cellTable().at(pattern, {0, false});
        if (cell.loops.size() != 1 || cell.rays || cell.loops[0].size() < 5) continue;
        // A fan from each vertex in turn: one of them has a forbidden diagonal.
        const auto loop = cell.loops[0];
        const std::size_t n = loop.size();
        for (std::size_t apex = 0; apex < n; ++apex) {
            for (std::size_t k = 0; k + 2 < n; ++k)
                cell.triangles[k] = {loop[apex], loop[(apex + k + 1) % n], loop[(apex + k + 2) % n]};
            inFace += faultOf(cell) == "a diagonal lies in a face";
        }
    }
    EXPECT_GT(inFace, 0);
    CellCase broken = cellTable().plain(0b00000011);
    broken.triangles.pop_back();
    EXPECT_NE(faultOf(broken), "");
    // Two opposite corners, their triangles drawn to one point.
    CellCase pinched = cellTable().at(0b10000001, {0, false});
    ASSERT_EQ(pinched.loops.size(), 2u);
    EXPECT_EQ(faultOf(pinched), "");
    pinched.triangles.clear();
    for (const auto& loop : pinched.loops)
        for (std::size_t k = 0; k < 3; ++k)
            pinched.triangles.push_back({loop[k], loop[(k + 1) % 3], static_cast<std::uint8_t>(kCellEdges)});
    EXPECT_EQ(faultOf(pinched), "a vertex has two fans");
}

// The segments that a cell draws on one of its faces, named by the face's own edges: (axis, position in the
// face).
using FaceEdge = std::array<int, 3>;
std::set<std::pair<FaceEdge, FaceEdge>> segmentsOnFace(const CellCase& cell, int face) {
    const int axis = face / 2;
    const auto nameOfEdge = [&](int e) {
        const CellEdge& edge = cellTable().edge(e);
        std::array<int, 3> at{edge.x, edge.y, edge.z};
        return FaceEdge{edge.axis, at[(axis + 1) % 3], at[(axis + 2) % 3]};
    };
    std::set<std::pair<FaceEdge, FaceEdge>> segments;
    for (const auto& [a, b] : boundaryOf(cell))
        if (facesOfEdge(a) & facesOfEdge(b) & 1u << face) segments.insert({nameOfEdge(a), nameOfEdge(b)});
    return segments;
}

// On a face there is no more to see than its four signs and, where it is ambiguous, its decision: whatever else the
// cell's pattern and decisions are, the segments are the same, and the cell on the other side draws them the
// other way. That is all pairs of neighbouring cells.
TEST(CellTable, NeighboursDrawTheSameSegmentsOnTheirFaceInOppositeDirectionsWhateverIsDecided) {
    using Segments = std::set<std::pair<FaceEdge, FaceEdge>>;
    for (int axis = 0; axis < 3; ++axis) {
        std::map<std::pair<unsigned, bool>, Segments> low, high;  // by the face's signs and decision
        const auto collect = [&](int face, auto& found) {
            forEachCase([&](unsigned pattern, const CellDecision& decision, const CellCase& cell) {
                unsigned signs = 0;
                for (int k = 0; k < 4; ++k) {
                    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
                    const int corner = (k & 1) * u + (k >> 1) * v + (face % 2 << axis);
                    signs |= (pattern >> corner & 1) << k;
                }
                const bool joined = decision.joined >> face & 1;
                const auto [at, isNew] = found.insert({{signs, joined}, segmentsOnFace(cell, face)});
                if (!isNew) {
                    ASSERT_EQ(at->second, segmentsOnFace(cell, face)) << nameOf(pattern, decision);
                }
            });
        };
        collect(2 * axis + 1, low);
        collect(2 * axis, high);
        ASSERT_EQ(low.size(), 18u);  // 16 patterns, two of them ambiguous
        for (const auto& [key, segments] : low) {
            Segments reversed;
            for (const auto& [a, b] : high.at(key)) reversed.insert({b, a});
            EXPECT_EQ(segments, reversed) << "axis " << axis << " signs " << key.first;
        }
    }
}

TEST(CellTable, AmbiguousFacesAreSeparatedOrJoinedAsDecided) {
    // Corners 0 and 3 lie across the face z = 0, which is face 4.
    ASSERT_EQ(cellTable().ambiguousFaces(0b00001001), 1u << 4);
    EXPECT_EQ(cellTable().at(0b00001001, {0, false}).loops.size(), 2u);
    EXPECT_EQ(cellTable().at(0b00001001, {1 << 4, false}).loops.size(), 1u);
    EXPECT_EQ(cellTable().at(0b11110110, {0, false}).loops.size(), 1u);
    EXPECT_EQ(cellTable().at(0b11110110, {1 << 4, false}).loops.size(), 2u);
}

// Two opposite corners of a cell: two triangles, or a tube between them.
TEST(CellTable, TheMiddleJoinsWhatHasItsSign) {
    for (const unsigned pattern : {0b10000001u, 0b01111110u}) {
        const bool corners = pattern == 0b10000001u;  // these are inside
        EXPECT_TRUE(cellTable().needsMiddle(pattern, 0));
        EXPECT_EQ(cellTable().at(pattern, {0, !corners}).triangles.size(), 2u);
        const CellCase& tube = cellTable().at(pattern, {0, corners});
        EXPECT_EQ(tube.loops.size(), 2u);
        std::set<int> vertices;
        const auto sides = sidesOf(tube);
        for (const Segment& s : sides) vertices.insert(s.first);
        const int V = static_cast<int>(vertices.size()), F = static_cast<int>(tube.triangles.size());
        const int E = (static_cast<int>(sides.size()) + 6) / 2;  // six sides on the border
        EXPECT_EQ(V - E + F, 0);                                 // an annulus
    }
}

// Regions of the cell's surface, counted on the corners: those of one sign connected along edges and across ambiguous faces
// as decided.
int regionsOf(unsigned pattern, unsigned joined) {
    std::array<int, 8> parent;
    std::iota(parent.begin(), parent.end(), 0);
    const auto rootOf = [&](int c) {
        while (parent[c] != c) c = parent[c];
        return c;
    };
    const auto facesOfCorner = [](int c) {
        return 1u << (c & 1) | 1u << (2 + (c >> 1 & 1)) | 1u << (4 + (c >> 2));
    };
    for (int a = 0; a < 8; ++a)
        for (int b = 0; b < a; ++b) {
            const int apart = __builtin_popcount(a ^ b);
            const bool insideA = pattern >> a & 1, insideB = pattern >> b & 1;
            if (insideA != insideB || apart > 2) continue;
            if (apart == 2) {
                const unsigned face = facesOfCorner(a) & facesOfCorner(b);
                const bool ambiguous = (cellTable().ambiguousFaces(pattern) & face) != 0;
                if (!ambiguous || ((joined & face) != 0) != insideA) continue;
            }
            parent[rootOf(a)] = rootOf(b);
        }
    int regions = 0;
    for (int c = 0; c < 8; ++c) regions += parent[c] == c;
    return regions;
}

TEST(CellTable, HasOneLoopFewerThanRegionsOfTheCellsSurface) {
    forEachCase([](unsigned pattern, const CellDecision& decision, const CellCase& cell) {
        EXPECT_EQ(static_cast<int>(cell.loops.size()), regionsOf(pattern, decision.joined) - 1)
            << nameOf(pattern, decision);
    });
}

TEST(CellTable, FacesOutwardsAtASingleInsideCorner) {
    // Corner 0: edges 0 (x), 4 (y), 8 (z) in this order run counter-clockwise seen from (1, 1, 1).
    const CellCase& cell = cellTable().plain(1);
    ASSERT_EQ(cell.triangles.size(), 1u);
    auto t = cell.triangles[0];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    EXPECT_EQ(t, (std::array<std::uint8_t, 3>{0, 4, 8}));
}

}  // namespace
}  // namespace isowave
