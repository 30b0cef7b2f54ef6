// bench/lifting.h is what docs/subdivision_triangles.md measures against: it must be what it says.
#include "bench/lifting.h"

#include <gtest/gtest.h>

#include "subdivision/meshes/mesh_schemes.h"
#include "tests/subdivision/mesh_zoo.h"

namespace isowave::subdivision {
namespace {

using bench::LiftingStep;
using namespace mesh_zoo;

TEST(Lifting, PutsNoiseTogetherAgain) {
    for (const auto& [name, mesh] : all()) {
        const LiftingStep step(mesh);
        const auto fine = Random(1).vectors(step.fineSize());
        auto points = fine;
        step.apart(points);
        step.together(points);
        EXPECT_LT(distance(points, fine), 1e-13) << name;
    }
}

// On a regular mesh its P is the bicubic B-spline's.
TEST(Lifting, SubdividesAsCatmullClarkWhereFourMeet) {
    const PolygonMesh mesh = torus(6, 5);
    const LiftingStep step(mesh);
    auto points = mesh.points;
    points.resize(step.fineSize());
    step.together(points);
    EXPECT_LT(distance(points, meshScheme("catmull-clark").step(mesh, "")->subdivide(mesh.points)), 1e-14);
}

// The last lift is chosen for this: a wavelet has no mean.
TEST(Lifting, WaveletsSumToZero) {
    const LiftingStep step(torus(8, 8));
    for (std::size_t k = step.coarseSize(); k < step.fineSize(); ++k) {
        std::vector<Vec3> points(step.fineSize());
        points[k] = {1, 0, 0};
        step.together(points);
        double sum = 0;
        for (const Vec3& p : points) sum += p.x;
        ASSERT_NEAR(sum, 0, 1e-14) << k;
    }
}

}  // namespace
}  // namespace isowave::subdivision
