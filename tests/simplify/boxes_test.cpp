// TriangleBoxes finds the nearest of all triangles.
#include "simplify/boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace isowave {
namespace {

// To the centre of a triangle: a distance that no box bounds from above, so that every triangle may be
// nearest.
double squaredToCentre(const TriangleMesh& mesh, std::uint32_t t, const Point& p) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        double centre = 0;
        for (const std::uint32_t v : mesh.triangles[t]) centre += mesh.points[v][a] / 3;
        sum += (centre - p[a]) * (centre - p[a]);
    }
    return sum;
}

TriangleMesh scattered(std::size_t count, double size, std::mt19937& random) {
    std::uniform_real_distribution<double> place(-100, 100), edge(-size, size);
    TriangleMesh mesh;
    for (std::uint32_t t = 0; t < count; ++t) {
        const Point at{place(random), place(random), place(random) + 1e5};
        for (int corner = 0; corner < 3; ++corner)
            mesh.points.push_back({at[0] + edge(random), at[1] + edge(random), at[2] + edge(random)});
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

TEST(TriangleBoxes, FindTheNearestOfAllTriangles) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-150, 150);
    // 0: triangles without extent, with centres that are float32 only roughly.
    for (const double size : {0.0, 0.5, 60.0})
        for (const std::size_t count : {1u, 2u, 4u, 5u, 9u, 31u, 1000u, 20000u}) {
            const TriangleMesh mesh = scattered(count, size, random);
            const TriangleBoxes boxes(mesh);
            for (int i = 0; i < 20; ++i) {
                const Point p{place(random), place(random), place(random) + 1e5};
                const auto to = [&](std::uint32_t t) { return squaredToCentre(mesh, t, p); };
                double nearest = INFINITY;
                for (std::uint32_t t = 0; t < count; ++t) nearest = std::min(nearest, to(t));
                std::size_t asked = 0;
                const auto found = boxes.nearest(p, [&](std::uint32_t t) { return ++asked, to(t); });
                ASSERT_EQ(found.squared, nearest) << count << ' ' << size;
                ASSERT_EQ(to(found.triangle), nearest);
                // With "near enough" the search ends with the first one that is.
                const std::size_t all = asked;
                asked = 0;
                const double enough = 4 * nearest + 1;
                const auto near = boxes.nearest(
                    p, [&](std::uint32_t t) { return ++asked, to(t); }, enough);
                ASSERT_LE(near.squared, enough);
                ASSERT_GE(near.squared, nearest);
                ASSERT_LE(asked, all);
                if (count == 20000 && size < 1) {
                    ASSERT_LT(all, 200u);  // seen 60
                }
            }
        }
}

}  // namespace
}  // namespace isowave
