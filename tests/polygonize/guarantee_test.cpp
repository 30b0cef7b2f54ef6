// The whole way from signs to a file: closed, oriented, 2-manifold, without degenerate triangles, before and
// after the rounding to float32 and the merging by position that STL does.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/mesh/equal_points.h"
#include "io/mesh/write.h"
#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"

namespace isowave {
namespace {

using namespace isowave::testing;

// As any reader of STL does: 50 bytes a triangle after 84, corners by position.
TriangleMesh throughStl(const TriangleMesh& mesh) {
    const auto path =
        std::filesystem::temp_directory_path() / ("isowave_guarantee_" + std::to_string(::getpid()) + ".stl");
    writeMesh(path, mesh, MeshFormat::stl);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::filesystem::remove(path);
    TriangleMesh soup;
    for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50) {
        const auto first = static_cast<std::uint32_t>(soup.points.size());
        for (int k = 1; k <= 3; ++k) {
            std::array<float, 3> p;
            std::memcpy(p.data(), bytes.data() + at + 12 * k, 12);
            soup.points.push_back({p[0], p[1], p[2]});
        }
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return mergeEqualPoints(soup);
}

double leastDoubleArea(const TriangleMesh& mesh) {
    double least = INFINITY;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](int k) {
            const Point& p = mesh.points[t[k]];
            return Vec3d(p[0], p[1], p[2]);
        };
        least = std::min(least, (corner(1) - corner(0)).cross(corner(2) - corner(0)).length());
    }
    return least;
}

void expectSound(const TriangleMesh& mesh, const std::string& what) {
    const MeshTopology t = topologyOf(mesh);
    EXPECT_TRUE(t.closed() && t.manifold() && t.oriented()) << what;
    EXPECT_GT(leastDoubleArea(mesh), 0) << what;
}

void expectSoundAlsoAsStl(const TriangleMesh& mesh, const std::string& what) {
    expectSound(mesh, what);
    const TriangleMesh read = throughStl(mesh);
    expectSound(read, what + " as STL");
    EXPECT_EQ(read.points.size(), mesh.points.size()) << what;
    EXPECT_EQ(topologyOf(read).genus, topologyOf(mesh).genus) << what;
    EXPECT_EQ(topologyOf(read).components, topologyOf(mesh).components) << what;
}

TEST(Guarantee, HoldsForAllPairsOfFaceNeighbouringCells) {
    // 4096 blocks of 3 x 2 x 2 lattice points, one outside lattice point or more between them.
    const auto inside = [](const Coord& at) {
        const int pair = at[0] / 4 * 64 + at[1] / 3, x = at[0] % 4, y = at[1] % 3;
        return x < 3 && y < 2 && at[2] < 2 && (pair >> (x + 3 * y + 6 * at[2]) & 1);
    };
    expectSoundAlsoAsStl(polygonize(fieldFromSigns({256, 192, 2}, inside)), "4096 pairs");
}

TEST(Guarantee, HoldsForRandomBlocksOfEveryDensity) {
    // Sparse and dense signs make other cells frequent than even ones do: with 10 % inside most are lone
    // corners, many of them face to face across an ambiguous face.
    for (const unsigned percent : {10u, 30u, 50u, 70u, 90u}) {
        constexpr int n = 40;
        std::mt19937 random(percent);
        std::vector<bool> signs(n * n * n);
        for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = random() % 100 < percent;
        const auto inside = [&](const Coord& at) {
            return static_cast<bool>(signs[(at[0] * n + at[1]) * n + at[2]]);
        };
        expectSoundAlsoAsStl(polygonize(fieldFromSigns(Coord(n), inside)), std::to_string(percent) + " %");
    }
}

TEST(Guarantee, HoldsForWhiteNoiseWhoseRootsCrowdAtTheMargins) {
    for (const int refine : {1, 2})
        expectSoundAlsoAsStl(polygonize(noiseField(28, 11), {.refine = refine}),
                             "noise, refine " + std::to_string(refine));
}

TEST(Guarantee, WouldFailWithoutTheMargin) {
    // Lattice values of exactly 0 put all roots of the edges around a lattice point into that point.
    const BSplineField field = fieldFromControlPoints({0, 0, 0}, Coord(12), 1.0, [](int x, int y, int z) {
        return std::clamp((x + y + z) / 3.0 - 6, -1.0, 1.0);
    });
    EXPECT_EQ(leastDoubleArea(polygonize(field, {.rootMargin = 0})), 0);
    EXPECT_GT(leastDoubleArea(polygonize(field)), 0);
}

}  // namespace
}  // namespace isowave
