// What lies outside an image stays outside at every step.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "volume/distance.h"
#include "volume/fit.h"
#include "wavelets/pyramid.h"

namespace isowave::wavelets {
namespace {

// Noise of whole numbers up to the border, a tenth of them on the iso value. Those put columns of distance 0
// outside the border, which the steps turned into shells three coarse voxels from the image.
TEST(ImageBorder, NoStepHasSurfaceFarOutsideANoisyImage) {
    constexpr int kSize = 40;
    Image image;
    image.size = {kSize, kSize, kSize};
    std::mt19937 random(7);
    for (int i = 0; i < kSize * kSize * kSize; ++i) image.values.push_back(static_cast<float>(random() % 10));
    const BSplineField field = fitDistance(*distanceFromImage(image, {.iso = 8}, 4));
    analyse(field, {.maxSteps = 6}, {}, [&](int step, const BSplineField& coarse) {
        const openvdb::Vec3d voxel = coarse.transform().voxelSize();
        for (auto c = coarse.controlPoints->cbeginValueOn(); c; ++c) {
            const openvdb::Vec3d x = coarse.transform().indexToWorld(c.getCoord());
            double out = 0;  // coarse voxels beyond the border
            for (int a = 0; a < 3; ++a)
                out = std::max({out, -x[a] / voxel[a], (x[a] - (kSize - 1)) / voxel[a]});
            if (out < 1.5) continue;
            EXPECT_GT(evaluate(coarse, c.getCoord().asVec3d()), 0) << "step " << step << " at " << x;
        }
    });
}

}  // namespace
}  // namespace isowave::wavelets
