#include "subdivision/meshes/catmull_clark_wide.h"

#include <gtest/gtest.h>

#include "subdivision/filters/construct.h"
#include "subdivision/filters/masks.h"
#include "tests/subdivision/mesh_zoo.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;

std::vector<Vec3> times(const WideCatmullClarkStep& step, const std::vector<Vec3>& coarse) {
    std::vector<Vec3> fine(step.fineSize());
    Taps row;
    for (Index k = 0; k < fine.size(); ++k) {
        step.rowOfP(k, row);
        for (const auto& [node, weight] : row) fine[k] += weight * coarse[node];
    }
    return fine;
}

TEST(WideCatmullClark, RowsOfPAreTheSubdivision) {
    for (const auto& [name, mesh] : all()) {
        const WideCatmullClarkStep step(mesh);
        const auto coarse = Random(1).vectors(step.coarseSize());
        EXPECT_LT(distance(times(step, coarse), step.subdivide(coarse)), 1e-14) << name;  // seen 6e-16
    }
}

TEST(WideCatmullClark, RecoversWhatWasSubdividedAndHasNoDetails) {
    for (const auto& [name, mesh] : injective()) {
        const WideCatmullClarkStep step(mesh);
        const auto coarse = Random(2).vectors(step.coarseSize());
        const auto parts = step.decompose(step.subdivide(coarse));
        EXPECT_LT(distance(parts.coarse, coarse), 1e-14) << name;  // seen 3e-16
        EXPECT_LT(largest(parts.stored), 1e-14) << name;
        EXPECT_EQ(step.withoutRow(), 0u) << name;
    }
}

TEST(WideCatmullClark, PutsNoiseTogetherAgain) {
    for (const auto& [name, mesh] : all()) {
        const WideCatmullClarkStep step(mesh);
        const auto fine = Random(3).vectors(step.fineSize());
        const auto parts = step.decompose(fine);
        EXPECT_EQ(parts.coarse.size() + parts.stored.size(), fine.size()) << name;
        EXPECT_LT(distance(step.reconstruct(parts.coarse, parts.stored), fine), 1e-14) << name;  // seen 9e-16
    }
}

// Regular rows reach as far as they may: the boundary lies right behind their windows.
TEST(WideCatmullClark, RegularRowsEndAtTheBoundary) {
    for (const Index n : {6u, 7u, 9u}) {
        const WideCatmullClarkStep step(grid(n, n));
        const auto coarse = Random(5).vectors(step.coarseSize());
        const auto parts = step.decompose(step.subdivide(coarse));
        EXPECT_LT(distance(parts.coarse, coarse), 1e-14) << n;
        const auto fine = Random(6).vectors(step.fineSize());
        const auto again = step.decompose(fine);
        EXPECT_LT(distance(step.reconstruct(again.coarse, again.stored), fine), 1e-14) << n;
    }
}

// +-1 alternating is in the kernel of P there, so no window can tell.
TEST(WideCatmullClark, KeepsTheTrialRowWherePIsNotInjective) {
    EXPECT_EQ(WideCatmullClarkStep(cube()).withoutRow(), 8u);
    EXPECT_EQ(WideCatmullClarkStep(together(cube(), torus(5, 4), {6, 0, 0})).withoutRow(), 8u);
}

// Where four meet the row is A11 x A11: of fine points that are a product, it makes the product of the curves'.
TEST(WideCatmullClark, IsTheCurvesProductWhereFourMeet) {
    const Index m = 8, n = 7;
    const PolygonMesh mesh = torus(m, n);
    const Adjacency adjacency(mesh);
    const WideCatmullClarkStep step(mesh);
    Random random(4);
    std::vector<double> u(2 * m), v(2 * n);
    for (double& x : u) x = random();
    for (double& x : v) x = random();
    // Fine places of vertices (2i, 2j), edges and faces, each the mean of its vertices'; the seam is unwound.
    const auto fineIndex = [](Index a, Index b, Index size) {  // middle of a and b on a circle of `size`
        return a == b ? 2 * a : (a + 1) % size == b ? 2 * a + 1 : 2 * b + 1;
    };
    std::vector<Vec3> fine(step.fineSize());
    const auto put = [&](std::size_t k, Index a,
                         Index b) {  // between two vertices, across a face from each other
        fine[k].x = u[fineIndex(a % m, b % m, m)] * v[fineIndex(a / m, b / m, n)];
    };
    for (Index k = 0; k < adjacency.vertices(); ++k) put(k, k, k);
    for (Index e = 0; e < adjacency.edges(); ++e) {
        const Index h = adjacency.edgeCorner(e);
        put(adjacency.vertices() + e, adjacency.vertex(h), adjacency.target(h));
    }
    for (Index f = 0; f < adjacency.faces(); ++f)
        put(adjacency.vertices() + adjacency.edges() + f, mesh.face(f)[0], mesh.face(f)[2]);
    const auto a = leastNormA(namedMask("cubic"), 11);
    const auto coarseOf = [&](const std::vector<double>& line, Index i) {
        double sum = 0;
        const int size = static_cast<int>(line.size());
        for (const auto& [node, weight] : *a)
            sum += toDouble(weight) *
                   line[static_cast<std::size_t>((2 * static_cast<int>(i) + node.x + size) % size)];
        return sum;
    };
    const auto coarse = step.decompose(fine).coarse;
    for (Index k = 0; k < adjacency.vertices(); ++k)
        EXPECT_NEAR(coarse[k].x, coarseOf(u, k % m) * coarseOf(v, k / m), 1e-13);
}

}  // namespace
}  // namespace isowave::subdivision
