// No case of the table crosses itself, wherever on their edges and rays the vertices are.
#include <gtest/gtest.h>

#include <random>

#include "isowave/measure.h"
#include "polygonize/cell_table.h"

namespace isowave {
namespace {

// A place for each of a cell's vertices, crowded at the ends as well as spread.
std::array<Point, kCellVertices> randomVertices(std::mt19937& random) {
    std::uniform_real_distribution<double> between(0, 1);
    const auto t = [&] {
        const double u = between(random);
        return random() % 3 ? 1e-3 + 0.998 * u : (u < 0.5 ? 1e-3 : 0.999);
    };
    std::array<Point, kCellVertices> at;
    for (int e = 0; e < kCellEdges; ++e) {
        const CellEdge& edge = cellTable().edge(e);
        at[e] = {double(edge.x), double(edge.y), double(edge.z)};
        at[e][edge.axis] = t();
    }
    for (int c = 0; c < kCellCorners; ++c) {
        const double s = t() / 2;
        at[kCellEdges + c] = {0.5 + (c & 1 ? s : -s), 0.5 + (c & 2 ? s : -s), 0.5 + (c & 4 ? s : -s)};
    }
    return at;
}

TEST(CellTable, NoSurfaceInACellCrossesItselfOrAnother) {
    std::mt19937 random(7);
    for (int round = 0; round < 40; ++round) {
        TriangleMesh mesh;  // all cases side by side
        std::vector<std::string> names;
        int cases = 0;
        for (unsigned pattern = 1; pattern < 255; ++pattern)
            for (unsigned joined = 0; joined < 64; ++joined)
                for (const bool middle : {false, true}) {
                    if (joined & ~cellTable().ambiguousFaces(pattern)) continue;
                    const auto first = static_cast<std::uint32_t>(mesh.points.size());
                    for (Point p : randomVertices(random)) {
                        p[0] += 2 * cases;
                        mesh.points.push_back(p);
                    }
                    ++cases;
                    const CellDecision decision{static_cast<std::uint8_t>(joined), middle};
                    for (const auto& [a, b, c] : cellTable().at(pattern, decision).triangles)
                        mesh.triangles.push_back({first + a, first + b, first + c});
                }
        EXPECT_EQ(countSelfIntersections(mesh), 0) << "round " << round;
    }
}

}  // namespace
}  // namespace isowave
