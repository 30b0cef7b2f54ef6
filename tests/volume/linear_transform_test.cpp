// Which lattices OpenVDB can hold, and what is said of those that it cannot.
#include "volume/linear_transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isowave/error.h"
#include "volume/distance.h"
#include "volume/mesh_checks.h"

namespace isowave {
namespace {

using openvdb::math::Mat4d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

// Turned about (1, 1, 1) by 0.6 and scaled; a general affine map to OpenVDB, not a scale.
Mat4d turned(double spacing) {
    auto matrix = openvdb::math::rotation<Mat4d>(openvdb::Vec3d(1, 1, 1).unit(), 0.6);
    matrix.preScale(openvdb::Vec3d(spacing));
    matrix.setTranslation({-100, 30, 7});
    return matrix;
}

Mat4d straight(double spacing) {
    Mat4d matrix = Mat4d::identity();
    matrix.preScale(openvdb::Vec3d(spacing));
    return matrix;
}

auto refusesOneLine(const std::string& object) {
    return ThrowsMessage<InputError>(AllOf(HasSubstr(object + ": its voxels of 1e-05 x 1e-05 x 1e-05 have"),
                                           HasSubstr("smaller unit"), Not(HasSubstr("\n"))));
}

TEST(LinearTransform, IsOpenVdbsDownToItsSmallestVoxel) {
    for (const double spacing : {1e3, 1.0, 1e-3, 1.45e-5}) {
        for (const Mat4d& matrix : {straight(spacing), turned(spacing)}) {
            const auto transform = linearTransform(matrix, "image");
            const openvdb::Vec3d p(3, 5, 7);
            EXPECT_LT((transform->indexToWorld(p) - matrix.transform(p)).length(), 1e-12 * (1 + spacing));
        }
        EXPECT_EQ(linearTransform(spacing, "mesh")->voxelSize()[0], spacing);
    }
}

TEST(LinearTransform, RefusesWhatOpenVdbRefuses) {
    for (const Mat4d& matrix : {straight(1e-5), turned(1e-5)}) {
        EXPECT_THROW(openvdb::math::Transform::createLinearTransform(matrix), openvdb::ArithmeticError);
        EXPECT_THAT([&] { linearTransform(matrix, "image"); }, refusesOneLine("image"));
    }
    EXPECT_THAT([] { linearTransform(1e-5, "mesh"); }, refusesOneLine("mesh"));
    Mat4d flat = Mat4d::identity();
    flat.setRow(1, {1, 0, 0, 0});
    EXPECT_THROW(linearTransform(flat, "image"), InputError);
    EXPECT_THROW(linearTransform(straight(NAN), "image"), InputError);
    EXPECT_THROW(linearTransform(straight(HUGE_VAL), "image"), InputError);
}

TEST(LinearTransform, IsWhatEveryInputIsGivenAs) {
    Image image;
    image.size = {4, 4, 4};
    image.values.assign(64, 1.0f);
    image.indexToWorld.axis = {{{1e-5, 0, 0}, {0, 1e-5, 0}, {0, 0, 1e-5}}};
    EXPECT_THAT([&] { distanceFromImage(image, {.iso = 0.5}, 4); }, refusesOneLine("image"));
    EXPECT_THAT([&] { nodesFromImage(image, {.iso = 0.5}); }, refusesOneLine("image"));
    EXPECT_THAT([&] { nodesFromLabel(image, 1); }, refusesOneLine("image"));
    EXPECT_THAT([] { transformForMesh(shapes::sphere(1e-3, 2), 1e-5); }, refusesOneLine("mesh"));
}

}  // namespace
}  // namespace isowave
