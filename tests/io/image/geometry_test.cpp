// Where voxels lie: indexToWorld against ITK's own TransformContinuousIndexToPhysicalPoint.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>

#include "io/image/itk.h"
#include "isowave/image.h"
#include "isowave/mesh.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;
using Float3 = itk::Image<float, 3>;

// Rotation by three angles, in radians; mirrored: x turned round, as in a left-handed scan.
Float3::DirectionType oblique(double a, double b, double c, bool mirrored) {
    const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cc = std::cos(c),
                 sc = std::sin(c);
    const double r[3][3] = {{ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc},
                            {sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc},
                            {-sb, cb * sc, cb * cc}};
    Float3::DirectionType direction;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) direction(i, j) = r[i][j] * (mirrored && j == 0 ? -1 : 1);
    return direction;
}

// 9 x 8 x 7 voxels, none of whose axes, spacings and origins is like another.
Float3::Pointer obliqueImage(bool mirrored) {
    const auto image = test::patternImage<float>({9, 8, 7});
    const double spacing[3] = {0.957, 0.8333333333333333, 2.5};
    const double origin[3] = {-120.125, 77.0625, -1033.5};
    image->SetSpacing(spacing);
    image->SetOrigin(origin);
    image->SetDirection(oblique(0.3, -0.2, 1.1, mirrored));
    return image;
}

Float3::Pointer cropped(const Float3* image, const Float3::IndexType& first, const Float3::SizeType& size) {
    auto crop = itk::ExtractImageFilter<Float3, Float3>::New();
    crop->SetInput(image);
    crop->SetExtractionRegion({first, size});
    crop->SetDirectionCollapseToSubmatrix();
    crop->Update();
    return crop->GetOutput();
}

Vec3 worldOf(const Image& image, const Vec3& index) {
    const auto [x, y, z] = image.indexToWorld({index.x, index.y, index.z});
    return {x, y, z};
}

Vec3 worldOf(const Float3* image, const Vec3& index) {
    itk::ContinuousIndex<double, 3> at;
    for (int a = 0; a < 3; ++a) at[a] = index[a];
    Float3::PointType point;
    image->TransformContinuousIndexToPhysicalPoint(at, point);
    return {point[0], point[1], point[2]};
}

// Corners, and points between voxels.
std::vector<Vec3> somePoints() {
    std::vector<Vec3> points;
    for (const double x : {0.0, 0.37, 4.0})
        for (const double y : {0.0, 2.81, 5.0})
            for (const double z : {0.0, 1.5, 3.0}) points.push_back({x, y, z});
    return points;
}

struct Format {
    const char* name;
    double writtenTo;  // mm: how exactly the format keeps what was written; NIfTI stores float32
};

class Geometry : public testing::TestWithParam<std::tuple<Format, bool>> {
  protected:
    void SetUp() override {
        std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        std::replace(name.begin(), name.end(), '/', '_');
        folder = fs::temp_directory_path() / ("isowave_geometry_" + name + "_" + std::to_string(::getpid()));
        fs::create_directories(folder);
        format = std::get<0>(GetParam());
        path = folder / format.name;
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path folder, path;
    Format format{};
};

TEST_P(Geometry, PointsLieWhereItkPutsThem) {
    const auto written = obliqueImage(std::get<1>(GetParam()));
    test::writeItk(written.GetPointer(), path);
    const Image image = readImage(path);
    const auto asItk = test::readItk<Float3>(path);
    for (const Vec3& p : somePoints()) {
        // ITK turns NIfTI's sform into a rotation in single precision.
        EXPECT_LT(length(worldOf(image, p) - worldOf(asItk.GetPointer(), p)), format.writtenTo);
        EXPECT_LT(length(worldOf(image, p) - worldOf(written.GetPointer(), p)), format.writtenTo);
    }
    const auto spacing = image.spacing();
    for (unsigned a = 0; a < 3; ++a) EXPECT_NEAR(spacing[a], written->GetSpacing()[a], 1e-6);
}

// The crop's index begins at (2, 1, 3) in ITK; in the file, and here, its first voxel is voxel 0.
TEST_P(Geometry, ACroppedExtentStaysInItsPlace) {
    const auto whole = obliqueImage(std::get<1>(GetParam()));
    const auto part = cropped(whole, {2, 1, 3}, {5, 6, 4});
    ASSERT_EQ(part->GetLargestPossibleRegion().GetIndex()[0], 2);
    test::writeItk(part.GetPointer(), path);
    const Image image = readImage(path);
    EXPECT_EQ(image.size, (std::array<std::int64_t, 3>{5, 6, 4}));
    const Vec3 first{2, 1, 3};
    for (const Vec3& p : somePoints())
        EXPECT_LT(length(worldOf(image, p) - worldOf(whole.GetPointer(), p + first)), format.writtenTo);
    for (long z = 0; z < 4; ++z)
        for (long y = 0; y < 6; ++y)
            for (long x = 0; x < 5; ++x)
                ASSERT_EQ(image.values[static_cast<std::size_t>(x + 5 * (y + 6 * z))],
                          test::patternAt<float>(x + 2, y + 1, z + 3));
}

TEST_P(Geometry, TheHeaderAloneSaysTheSame) {
    test::writeItk(obliqueImage(std::get<1>(GetParam())).GetPointer(), path);
    const Image head = readImageHeader(path), image = readImage(path);
    EXPECT_TRUE(head.values.empty());
    EXPECT_EQ(head.size, image.size);
    EXPECT_EQ(head.indexToWorld, image.indexToWorld);
    EXPECT_EQ(head.format, image.format);
}

INSTANTIATE_TEST_SUITE_P(Formats, Geometry,
                         testing::Combine(testing::Values(Format{"a.nrrd", 1e-9}, Format{"a.nhdr", 1e-9},
                                                          Format{"a.mha", 1e-9}, Format{"a.mhd", 1e-9},
                                                          Format{"a.nii", 1e-3}, Format{"a.nii.gz", 1e-3}),
                                          testing::Bool()),
                         [](const auto& test) {
                             std::string name = std::get<0>(test.param).name;
                             std::replace(name.begin(), name.end(), '.', '_');
                             return name + (std::get<1>(test.param) ? "_mirrored" : "");
                         });

}  // namespace
}  // namespace isowave
