// Numbers at the ends of their ranges: iso-values that voxels have, values that are denormal or huge, voxels of a nanometre and
// of a kilometre, places far from the origin, more voxels than 32 bits count.
#include <fstream>

#include "tests/lod/solids.h"
#include "tests/temp_folder.h"

namespace isowave::lod_test {
namespace {

const double kPi = std::acos(-1.0);

Level finestOf(Solid solid) { return makeLadder(std::move(solid), {.levels = StepRange{0, 0}}).levels.at(0); }

double ballVolume(double r) { return 4.0 / 3.0 * kPi * r * r * r; }

// The middle between the least and the greatest coordinate of each axis.
Point middleOf(const TriangleMesh& mesh) {
    Point low = mesh.points.at(0), high = low;
    for (const Point& p : mesh.points)
        for (std::size_t a = 0; a < 3; ++a)
            low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
}

// Of a mesh around (15, 15, 15), along the x axis through there.
double widthOf(const TriangleMesh& mesh) {
    double low = 15, high = 15;
    for (const Point& p : mesh.points) {
        if (std::abs(p[1] - 15) > 0.5 || std::abs(p[2] - 15) > 0.5) continue;
        low = std::min(low, p[0]);
        high = std::max(high, p[0]);
    }
    return high - low;
}

// Cubes around (15, 15, 15): the value falls by 10 a voxel, so whole planes of voxels have the value 50.
Image nestedCubes() {
    return imageOf({31, 31, 31}, [](int x, int y, int z) {
        return 100 - 10 * std::max({std::abs(x - 15), std::abs(y - 15), std::abs(z - 15)});
    });
}

// The cube where the value is 10 (10 - h) has half-edge h: that is where its faces are. A spline rounds its edges, most where
// they run through lattice points, which count as outside.
TEST(IsoValue, OfWholePlanesOfVoxelsIsASurfaceThroughThem) {
    for (const double half : {4.5, 5.0, 5.5, 6.0}) {
        const Level made = finestOf(open(nestedCubes(), {.iso = 100 - 10 * half}));
        const MeshTopology cube = made.report.topology;
        expectSound(cube);
        EXPECT_EQ(cube.components, 1) << half;
        EXPECT_EQ(cube.genus, 0) << half;
        const double lost = 8 * half * half * half - cube.volume, edges = 12 * 2 * half;
        EXPECT_GT(lost, 0) << half;
        EXPECT_LT(lost / edges, 0.7)
            << half;  // square voxels; seen 0.13 to 0.15 between the voxels, 0.55 on them
        EXPECT_NEAR(widthOf(made.mesh), 2 * half, 0.01) << half;
    }
}

// A ball of radius 9 as floats: `scale` times the distance in voxels, at most 4.
Image scaledBall(double scale) {
    Image image = ballImage({32, 32, 32}, 9);
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        const double x = double(i % 32) - 15.5, y = double(i / 32 % 32) - 15.5, z = double(i / 1024) - 15.5;
        const double d = std::clamp(std::hypot(x, y, z) - 9, -4.0, 4.0);
        image.values[i] = static_cast<float>(-scale * d);
    }
    image.componentType = "float32";
    image.integral = false;
    return image;
}

// From 1e-41, where a float has 3 digits left, to 8e37, where the difference of two voxels is larger than a float can be.
TEST(Values, DenormalOrHugeGiveTheSurfaceOfOrdinaryOnes) {
    const MeshTopology plain = finestOf(open(scaledBall(1), {.iso = 0})).report.topology;
    EXPECT_NEAR(plain.volume / ballVolume(9), 1, 0.01);
    for (const double scale : {1e-41, 1e-38, 1e-30, 1e30, 8e37}) {
        const MeshTopology ball = finestOf(open(scaledBall(scale), {.iso = 0})).report.topology;
        expectSound(ball);
        EXPECT_EQ(ball.components, 1) << scale;
        EXPECT_NEAR(ball.volume / plain.volume, 1, 1e-3) << scale;
    }
}

// OpenVDB cannot turn a matrix whose determinant is below 3e-15: smaller voxels are refused, with what helps.
TEST(Spacing, OfAHundredNanometresOrAKilometreScalesTheMesh) {
    EXPECT_THAT(
        [] {
            open(ballImage({32, 32, 32}, 9, 1e-6), {.iso = 0});
        },
        testing::ThrowsMessage<InputError>(testing::HasSubstr("give all lengths in a smaller unit")));
    const Level plain = finestOf(open(ballImage({32, 32, 32}, 9), {.iso = 0}));
    for (const double spacing : {1e-4, 1e6}) {
        const Level ball = finestOf(open(ballImage({32, 32, 32}, 9, spacing), {.iso = 0}));
        expectSound(ball.report.topology);
        EXPECT_EQ(ball.mesh.triangles, plain.mesh.triangles) << spacing;
        const double scaled = ball.report.topology.volume / (spacing * spacing * spacing);
        EXPECT_NEAR(scaled / plain.report.topology.volume, 1, 1e-9) << spacing;
    }
}

TEST(Origin, TenKilometresAwayMovesTheMesh) {
    Image image = ballImage({32, 32, 32}, 9);
    const Level plain = finestOf(open(image, {.iso = 0}));
    image.indexToWorld.origin = {1e7, -1e7, 1e7};
    const Level far = finestOf(open(image, {.iso = 0}));
    expectSound(far.report.topology);
    EXPECT_EQ(far.mesh.triangles, plain.mesh.triangles);
    EXPECT_NEAR(far.report.topology.volume / plain.report.topology.volume, 1, 1e-9);
    const Point middle = middleOf(far.mesh);  // distances are floats: a ball is not round to the last digit
    EXPECT_NEAR(middle[0], 1e7 + 15.5, 3e-5);
    EXPECT_NEAR(middle[1], -1e7 + 15.5, 3e-5);
    EXPECT_NEAR(middle[2], 1e7 + 15.5, 3e-5);
}

// 1300^3 = 2,197,000,000 voxels in a sparse file; the ball lies behind voxel 2^31.
TEST(Voxels, MoreThan32BitsCountAreReadWhereTheyLie) {
    const test::TempFolder folder;
    const std::int64_t n = 1300;
    const std::array<std::int64_t, 3> centre{650, 650, 1287};
    std::int64_t inside = 0;
    {
        std::ofstream file(folder / "a.raw", std::ios::binary);
        for (int z = -12; z <= 12; ++z)
            for (int y = -12; y <= 12; ++y) {
                if (144 - z * z - y * y < 0) continue;
                const int half = static_cast<int>(std::sqrt(144 - z * z - y * y));
                file.seekp(((centre[2] + z) * n + centre[1] + y) * n + centre[0] - half);
                file << std::string(static_cast<std::size_t>(2 * half + 1), '\1');
                inside += 2 * half + 1;
            }
    }
    std::filesystem::resize_file(folder / "a.raw", static_cast<std::uintmax_t>(n * n * n));
    ASSERT_GT((centre[2] - 12) * n * n, std::int64_t(1) << 31);
    SolidOptions options;
    options.image.raw = RawLayout{{n, n, n}, "uint8"};
    options.maxMemory = 4e8;
    const Solid solid = open(folder / "a.raw", options);
    EXPECT_EQ(*solid.input().volume, static_cast<double>(inside));
    const Level ball = finestOf(solid);
    expectSound(ball.report.topology);
    EXPECT_EQ(ball.report.topology.components, 1);
    EXPECT_NEAR(ball.report.topology.volume / static_cast<double>(inside), 1, 0.01);
    const Point middle = middleOf(ball.mesh);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(middle[a], static_cast<double>(centre[a]), 0.01);
}

}  // namespace
}  // namespace isowave::lod_test
