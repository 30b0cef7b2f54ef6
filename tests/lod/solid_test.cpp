// Every kind of input becomes a solid: what is decided about it, what is refused.
#include <fstream>

#include "isowave/openvdb.h"
#include "tests/lod/solids.h"
#include "tests/temp_folder.h"
#include "tests/zoo/box.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;
using tools_test::ringAndBall;
using tools_test::sampled;

const double kPi = std::acos(-1.0);

LevelReport finestOf(Solid solid) { return levelsOf(std::move(solid), {.levels = StepRange{0, 0}}).at(0); }

// 1 the ring, 2 a small ball in a corner.
Image labelImage(bool ball = true) {
    const Size size{36, 36, 20};
    const auto values = ringAndBall(size, 10, 4, ball);
    return imageOf(size,
                   [&](int x, int y, int z) { return values[std::size_t(x + size[0] * (y + size[1] * z))]; });
}

std::string refusal(const std::function<void()>& work) {
    try {
        work();
    } catch (const UsageError& error) {
        return std::string("usage: ") + error.what();
    } catch (const InputError& error) {
        return std::string("input: ") + error.what();
    }
    return {};
}

// ---- images

TEST(GreyImage, IsMeasuredInItsOwnUnits) {
    const Solid solid = open(ballImage({32, 32, 32}, 9, 0.5), {.iso = 0});
    const InputReport& input = solid.input();
    EXPECT_EQ(input.kind, InputReport::Kind::greyImage);
    EXPECT_EQ(input.path, "image");
    EXPECT_EQ(*input.dimensions, (std::array<std::int64_t, 3>{32, 32, 32}));
    EXPECT_EQ(*input.spacing, (std::array<double, 3>{0.5, 0.5, 0.5}));
    EXPECT_EQ(input.iso, 0);
    EXPECT_EQ(input.label, std::nullopt);
    EXPECT_EQ(solid.space(), Space::lps);
    EXPECT_EQ(solid.fit()->method, FitMethod::distance);
    EXPECT_EQ(solid.fit()->disagreeing, 0);
    EXPECT_TRUE(solid.fit()->repairAgreed);
    EXPECT_DOUBLE_EQ(solid.fit()->repairFloor, 1e-4 / solid.fit()->halfWidth);
    const MeshTopology ball = finestOf(solid).topology;
    const double volume = 4.0 / 3.0 * kPi * std::pow(4.5, 3), area = 4 * kPi * 4.5 * 4.5;
    EXPECT_NEAR(ball.volume, volume, 0.02 * volume);
    EXPECT_NEAR(ball.area, area, 0.02 * area);
}

TEST(GreyImage, TurnsInsideOutWhenInverted) {
    const Image image = ballImage({32, 32, 32}, 9, 0.5);
    const double whole =
        15.5 * 15.5 * 15.5;  // the image, corner voxel to corner voxel; its cap lies around it
    const MeshTopology ball = finestOf(open(image, {.iso = 0})).topology,
                       hollow = finestOf(open(image, {.iso = 0, .invert = true})).topology;
    EXPECT_NEAR(ball.volume + hollow.volume, whole, 0.15 * whole);
    EXPECT_EQ(hollow.components, 2);
}

TEST(GreyImage, NeedsAnIsoValueThatVoxelsLieOnBothSidesOf) {
    const Image image = ballImage({24, 24, 24}, 7);
    EXPECT_THAT(refusal([&] { open(image); }),
                HasSubstr("usage: image: --iso is missing; values run from -100"));
    EXPECT_THAT(refusal([&] { open(image, {.iso = 5000}); }),
                HasSubstr("input: image: no voxel lies on the other"));
    EXPECT_THAT(refusal([&] { open(image, {.iso = 0, .label = 1}); }), HasSubstr("usage: --label and --iso"));
    EXPECT_THAT(refusal([&] { open(image, {.iso = 0, .voxels = 40}); }),
                HasSubstr("usage: --voxels has no meaning"));
    EXPECT_THAT(refusal([&] { open(image, {.iso = 0, .halfWidth = 3, .band = 4}); }),
                HasSubstr("usage: --band 4"));
}

TEST(Masks, GetTheirMidpointAndTheMaskFit) {
    Remarks remarks;
    const Solid solid = open(labelImage(false), {}, remarks.progress());
    EXPECT_THAT(remarks.text, HasSubstr("a mask, iso 0.5"));
    EXPECT_EQ(solid.input().kind, InputReport::Kind::mask);
    EXPECT_EQ(solid.input().iso, 0.5);
    EXPECT_EQ(solid.fit()->method, FitMethod::mask);
    EXPECT_TRUE(solid.fit()->repairAgreed);
    EXPECT_EQ(solid.fit()->repaired, 0);
    EXPECT_EQ(solid.fit()->gradientPasses, 60);
    EXPECT_NEAR(*finestOf(solid).volumeError, 0, 0.03);
    const Solid binary = open(labelImage(false), {.fit = FitMethod::binary});
    EXPECT_EQ(binary.fit()->method, FitMethod::binary);
    EXPECT_EQ(binary.fit()->repairFloor, 0.05);
    EXPECT_EQ(binary.fit()->filterPasses, 3);
    EXPECT_EQ(finestOf(solid).topology.genus, 1);
}

TEST(Labels, AreTakenTogetherOrOneByOne) {
    const Image image = labelImage();
    const Solid all = open(image), ring = open(image, {.label = 1}), ball = open(image, {.label = 2});
    EXPECT_EQ(finestOf(all).topology.components, 2);
    EXPECT_EQ(all.input().kind, InputReport::Kind::labels);
    EXPECT_EQ(finestOf(ring).topology.components, 1);
    EXPECT_EQ(finestOf(ring).topology.genus, 1);
    EXPECT_EQ(finestOf(ball).topology.genus, 0);
    EXPECT_EQ(ball.input().label, 2);
    EXPECT_EQ(ball.input().iso, std::nullopt);
    EXPECT_EQ(ring.fit()->method, FitMethod::mask);
    EXPECT_EQ(open(image, {.label = 1, .fit = FitMethod::distance}).fit()->method, FitMethod::distance);
    EXPECT_THAT(refusal([&] { open(image, {.label = 3}); }),
                HasSubstr("no voxel has the label 3; labels found"));
}

// The union of all labels is what the image shows without any; whole numbers are labels as float32, too.
TEST(Labels, AreJoined) {
    Image image = labelImage();
    const auto points = [&](const SolidOptions& options) {
        return makeLevel(open(image, options), 0).mesh.points;
    };
    const auto all = points({});
    EXPECT_EQ(points({.labels = {1, 2}}), all);
    EXPECT_EQ(points({.labels = {2, 1}}), all);
    EXPECT_EQ(points({.labels = {2, 2}}), points({.label = 2}));
    EXPECT_NE(points({.label = 2}), all);
    const Solid both = open(image, {.labels = {1, 2}});
    EXPECT_THAT(both.input().labels, testing::ElementsAre(1, 2));
    EXPECT_EQ(both.input().label, std::nullopt);
    EXPECT_EQ(both.input().iso, std::nullopt);
    EXPECT_THAT(refusal([&] {
                    open(image, {.labels = {1, 3}});
                }),
                HasSubstr("no voxel has the label 3; labels found"));
    image.componentType = "float32";
    image.integral = false;
    EXPECT_EQ(points({}), all);
    for (float& v : image.values) v *= 0.5f;
    EXPECT_THAT(refusal([&] { open(image); }), HasSubstr("--iso is missing"));
}

TEST(Masks, SayTheVolumeOfTheirVoxels) {
    Image image = labelImage();
    image.indexToWorld.axis[2][2] = 3;
    std::array<double, 3> voxels{};
    for (const float value : image.values) ++voxels[static_cast<std::size_t>(value)];
    const auto volume = [&](const SolidOptions& options) { return open(image, options).input().volume; };
    const double each = 3 * image.indexToWorld.axis[0][0] * image.indexToWorld.axis[1][1];
    for (const FitMethod fit : {FitMethod::mask, FitMethod::binary, FitMethod::distance}) {
        EXPECT_DOUBLE_EQ(volume({.fit = fit}).value(), each * (voxels[1] + voxels[2]));
        EXPECT_DOUBLE_EQ(volume({.label = 2, .fit = fit}).value(), each * voxels[2]);
    }
    EXPECT_EQ(volume({.openBorder = true}), std::nullopt) << "the solid goes on beyond the voxels";
    EXPECT_EQ(volume({.iso = 0.3}), std::nullopt) << "the surface lies between the voxels";
}

// A NIfTI file whose voxels are scaled.
void writeScaled(const std::filesystem::path& file, float slope, float intercept) {
    const Size size{24, 24, 16};
    const auto labels = ringAndBall(size, 7, 3, true);
    tools_test::writeNifti(file, size, std::vector<std::int16_t>(labels.begin(), labels.end()));
    std::fstream header(file, std::ios::in | std::ios::out | std::ios::binary);
    header.seekp(112);
    header.write(reinterpret_cast<const char*>(&slope), 4);
    header.write(reinterpret_cast<const char*>(&intercept), 4);
}

TEST(Labels, AreComparedWithTheScaledValue) {
    const test::TempFolder folder;
    const auto pointsOf = [&](float slope, float intercept, double label) {
        writeScaled(folder / "a.nii", slope, intercept);
        return makeLevel(open(folder / "a.nii", {.label = label}), 0).mesh.points;
    };
    const auto ring = pointsOf(1, 0, 1), ball = pointsOf(1, 0, 2);
    EXPECT_NE(ring, ball);
    const struct {
        float slope, intercept;
        double ring, ball;
    } scalings[] = {
        {0.1f, 0, 0.1, 0.2}, {0.7f, 1000, 1000.7, 1001.4}, {20000000, 0, 20000000, 40000000}, {-1, 5, 4, 3}};
    for (const auto& s : scalings) {
        EXPECT_EQ(pointsOf(s.slope, s.intercept, s.ring), ring) << s.slope;
        EXPECT_EQ(pointsOf(s.slope, s.intercept, s.ball), ball) << s.slope;
    }
    EXPECT_THROW(pointsOf(0.1f, 0, 1), InputError) << "1 is what is stored, not a value";
}

TEST(Headerless, ImagesAreReadAsTheOptionsSay) {
    const test::TempFolder folder;
    const Size size{20, 24, 28};
    auto values = tools_test::greyBall(size, 6);
    for (std::int16_t& v : values)  // big-endian
        v = static_cast<std::int16_t>(static_cast<std::uint16_t>(v) << 8 |
                                      static_cast<std::uint16_t>(v) >> 8);
    std::ofstream out(folder / "a.bin", std::ios::binary);
    out << "12345";
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(2 * values.size()));
    out.close();
    SolidOptions options{.iso = 0};
    options.image.raw = RawLayout{.size = {20, 24, 28}, .type = "int16", .bigEndian = true, .headerBytes = 5};
    options.image.spacing = {1, 1, 2};
    const Solid solid = open(folder / "a.bin", options);
    EXPECT_EQ(*solid.input().dimensions, (std::array<std::int64_t, 3>{20, 24, 28}));
    EXPECT_EQ(*solid.input().spacing, (std::array<double, 3>{1, 1, 2}));
    EXPECT_NEAR(finestOf(solid).topology.volume, 2 * 4.0 / 3.0 * kPi * 216, 60);
    options.image.raw->type.clear();
    EXPECT_THAT(refusal([&] { open(folder / "a.bin", options); }), HasSubstr("usage: --size needs --type"));
}

// A rod along the first axis through the whole image, which lies turned in the world.
Image rodImage() {
    Image image = imageOf({20, 24, 24}, [](int, int, int) { return 0; });
    image.values =
        sampled<float>({20, 24, 24}, [](int, int y, int z) { return 8 - std::hypot(y - 11.3, z - 12.1); });
    image.indexToWorld = {{{{0, 2, 0}, {-2, 0, 0}, {0, 0, 2}}}, {5, 6, 7}};
    image.componentType = "float32";
    image.integral = false;
    return image;
}

TEST(OpenBorder, LeavesTheCapOutAlsoWhenItComesFromAPyramid) {
    const test::TempFolder folder;
    const Image rod = rodImage();
    const LevelOptions two{.levels = StepRange{0, 1}};
    EXPECT_TRUE(finestOf(open(rod, {.iso = 0})).topology.closed());
    analyse(open(rod, {.iso = 0, .openBorder = true})).save(folder / "rod.vdb");
    const double tube = 2 * kPi * 16 * 38;  // radius 8 and length 19 voxels of 2 mm
    for (const Solid& solid : {open(rod, {.iso = 0, .openBorder = true}), open(folder / "rod.vdb")})
        for (const LevelReport& level : levelsOf(solid, two)) {
            EXPECT_FALSE(level.topology.closed());
            EXPECT_TRUE(level.topology.manifold());
            EXPECT_FALSE(level.isoDistance);
            EXPECT_NEAR(level.topology.area, tube, 0.03 * tube);
        }
}

// ---- meshes

TEST(MeshSolid, KeepsTheHoleOfARing) {
    const Solid solid = open(ringMesh(), {.voxels = 48});
    EXPECT_EQ(solid.input().kind, InputReport::Kind::mesh);
    EXPECT_EQ(solid.input().triangles, 2 * 48 * 24);
    EXPECT_EQ(solid.space(), Space::unspecified);
    EXPECT_EQ(solid.fit()->method, FitMethod::distance);
    EXPECT_EQ(solid.fit()->halfWidth, 4);
    EXPECT_EQ(solid.fit()->band, 2);
    const MeshTopology ring = finestOf(solid).topology;
    const double volume = 2 * kPi * kPi * 20 * 64;
    EXPECT_EQ(ring.genus, 1);
    EXPECT_NEAR(ring.volume, volume, 0.03 * volume);  // the polyhedron is smaller
}

TEST(MeshSolid, SaysItsOwnVolumeAndCountsWhatOverlapsOnce) {
    const TriangleMesh ring = ringMesh();
    const double volume = topologyOf(ring).volume;
    EXPECT_NEAR(open(ring, {.voxels = 32}).input().volume.value(), volume, 1e-9 * volume);
    TriangleMesh insideOut = ring;
    for (Triangle& t : insideOut.triangles) std::swap(t[0], t[1]);
    EXPECT_NEAR(open(insideOut, {.voxels = 32}).input().volume.value(), volume, 1e-9 * volume);
    TriangleMesh overlapping = ring;
    for (Point p : ring.points) overlapping.points.push_back({p[0], p[1], p[2] + 4});
    const auto more = static_cast<std::uint32_t>(ring.points.size());
    for (const auto& [a, b, c] : ring.triangles)
        overlapping.triangles.push_back({a + more, b + more, c + more});
    const InputReport coarse = open(overlapping, {.voxels = 32}).input(),
                      fine = open(overlapping, {.voxels = 128}).input();
    EXPECT_GT(coarse.volume.value(), volume);
    EXPECT_LT(coarse.volume.value(), 1.9 * volume);
    EXPECT_NEAR(coarse.volume.value(), fine.volume.value(), 2e-3 * volume);
    EXPECT_EQ(coarse.handles, std::nullopt) << "one solid, with other counts than its parts";
    // Which is said: silence means that level 0 has the input's.
    Remarks remarks;
    open(overlapping, {.voxels = 32}, remarks.progress());
    EXPECT_THAT(remarks.text,
                ::testing::HasSubstr("handles and cavities it has is not known: parts of it overlap"));
    remarks.text.clear();
    EXPECT_EQ(open(ring, {.voxels = 32}, remarks.progress()).input().handles, 1);
    EXPECT_EQ(remarks.text.find("not known"), std::string::npos);
}

TEST(MeshSolid, IsThereWhereNoLatticePointIsInside) {
    TriangleMesh sheet;
    for (int i = 0; i < 8; ++i)
        sheet.points.push_back({i & 1 ? 60.0 : 0.0, i & 2 ? 40.0 : 0.0, i & 4 ? 0.5 : 0.0});
    sheet.triangles.assign(zoo::kBoxTriangles.begin(), zoo::kBoxTriangles.end());
    const Solid solid = open(sheet, {.voxel = 1.0});
    EXPECT_EQ(solid.input().parts, 1);
    const Ladder ladder = makeLadder(solid, {.levels = StepRange{0, 0}});
    ASSERT_EQ(ladder.levels.size(), 1u);
    const LevelReport& level = ladder.levels[0].report;
    EXPECT_EQ(level.topology.parts, 1);
    EXPECT_EQ(level.topology.genus, 0);
    EXPECT_NEAR(level.topology.volume, 1200, 0.02 * 1200);
}

TEST(MeshSolid, TakesTheVoxelSizeOrTheCountOrADefaultThatItNames) {
    const auto spacing = [](const SolidOptions& options, const Progress& progress = {}) {
        return (*open(ringMesh(), options, progress).input().spacing)[0];
    };
    EXPECT_DOUBLE_EQ(spacing({.voxel = 1.5}), 1.5);
    EXPECT_NEAR(spacing({.voxels = 28}), 2.0, 1e-6);
    Remarks remarks;
    EXPECT_NEAR(spacing({}, remarks.progress()), 56.0 / 256, 1e-6);
    EXPECT_THAT(remarks.text, HasSubstr("--voxels 256"));
    EXPECT_THAT(refusal([&] { spacing({.voxels = 28, .voxel = 1.5}); }),
                HasSubstr("usage: --voxel and --voxels"));
}

TEST(MeshSolid, KeepsTheAxesThatAMeshNames) {
    const test::TempFolder folder;
    tools_test::writePly(folder / "ras.ply", tools_test::torus(20, 8), "SPACE=RAS");
    EXPECT_EQ(open(folder / "ras.ply", {.voxels = 32}).space(), Space::ras);
    EXPECT_EQ(open(ringMesh(), {.voxels = 32}, {}, Space::lps).space(), Space::lps);
}

TEST(MeshSolid, IsRefusedWhereItWouldTakeMoreMemoryThanAllowed) {
    EXPECT_THAT(refusal([] { open(ringMesh(), {.voxels = 48, .maxMemory = 1e6}); }),
                HasSubstr("over the limit of 1 MB; give fewer --voxels"));
    EXPECT_EQ(refusal([] { open(ringMesh(), {.voxels = 48, .maxMemory = 8e9}); }), "");
    // A pyramid takes less than levels.
    double least = 1e6;
    while (!refusal([&] { open(ringMesh(), {.voxels = 48, .maxMemory = least}); }).empty()) least *= 1.1;
    EXPECT_EQ(refusal([&] { open(ringMesh(), {.voxels = 48, .maxMemory = 0.4 * least, .fieldOnly = true}); }),
              "");
    EXPECT_NE(refusal([&] { open(ringMesh(), {.voxels = 48, .maxMemory = 0.2 * least, .fieldOnly = true}); }),
              "");
}

// ---- level sets

openvdb::FloatGrid::Ptr ballLevelSet(double radius) {
    openvdb::initialize();
    auto grid = openvdb::FloatGrid::create(3.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    const int reach = static_cast<int>(radius) + 6;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach; z <= reach; ++z) {
                const double d = std::sqrt(double(x * x + y * y + z * z)) - radius;
                if (std::abs(d) < 3)
                    grid->tree().setValueOn({x, y, z}, static_cast<float>(d));
                else if (d < 0)
                    grid->tree().setValueOff({x, y, z}, -3.0f);
            }
    return grid;
}

double ballVolume(double radius) { return 4.0 / 3.0 * kPi * std::pow(radius, 3); }

TEST(LevelSet, IsInsideWhereItIsNegative) {
    const openvdb::FloatGrid::Ptr ball = ballLevelSet(10);
    Remarks remarks;
    const Solid solid = open(*ball, {}, remarks.progress());
    EXPECT_THAT(remarks.text, HasSubstr("iso 0"));
    EXPECT_EQ(solid.input().kind, InputReport::Kind::levelSet);
    EXPECT_EQ(solid.input().iso, 0);
    EXPECT_EQ(solid.fit()->method, FitMethod::distance);
    EXPECT_NEAR(finestOf(solid).topology.volume, ballVolume(10), 0.01 * ballVolume(10));
    EXPECT_NEAR(finestOf(open(*ball, {.iso = 1})).topology.volume, ballVolume(11), 0.01 * ballVolume(11));
    EXPECT_NEAR(finestOf(open(*ball, {.fit = FitMethod::binary})).topology.volume, ballVolume(10),
                0.05 * ballVolume(10));
}

// A damaged place of a node leaves a leaf ten million voxels away: 49 s and 8 GB for a box that is empty.
TEST(LevelSet, IsRefusedInABoxThatIsNearlyEmpty) {
    const openvdb::FloatGrid::Ptr ball = ballLevelSet(6);
    ball->tree().setValueOn({0, 10'000'000, 0}, 1.0f);
    EXPECT_THAT(refusal([&] { open(*ball); }), HasSubstr("x 10000009 x"));
    ball->tree().setValueOff({0, 10'000'000, 0}, 3.0f);
    EXPECT_EQ(refusal([&] { open(*ball); }), "");
}

TEST(LevelSet, WithPositiveInsideIsReadWithInvert) {
    const openvdb::FloatGrid::Ptr negative = ballLevelSet(10);
    const openvdb::FloatGrid::Ptr positive = negative->deepCopy();
    for (auto value = positive->beginValueAll(); value; ++value) value.setValue(-*value);
    positive->tree().root().setBackground(-3.0f, false);
    EXPECT_EQ(finestOf(open(*positive, {.iso = -1, .invert = true})).topology.volume,
              finestOf(open(*negative, {.iso = 1})).topology.volume);
    // The other two would be everything but a ball, without end.
    EXPECT_THAT(refusal([&] { open(*positive); }), HasSubstr("a solid must be finite"));
    EXPECT_THAT(refusal([&] { open(*negative, {.invert = true}); }), HasSubstr("a solid must be finite"));
}

// ---- fields

TEST(FieldOfASolid, HasItsZeroSetAtTheSurfaceAndAGradientThatPointsOutwards) {
    const Field field = fieldOf(open(ringMesh(), {.voxels = 48}));
    EXPECT_LT(field.value({20, 0, 0}), 0) << "the middle of the tube";
    EXPECT_DOUBLE_EQ(field.value({0, 0, 0}), field.K()) << "far outside";
    EXPECT_NEAR(field.value({28, 0, 0}), 0, 0.05);
    const Point gradient = field.gradient({28, 0, 0});
    const double perVoxel = field.K() / 4;  // the half-width
    EXPECT_NEAR(gradient[0] * field.spacing()[0], perVoxel, 0.05 * perVoxel);
    EXPECT_NEAR(gradient[2] * field.spacing()[2], 0, 0.05 * perVoxel);
    const Level level = makeLevel(open(ringMesh(), {.voxels = 48}), 0);
    EXPECT_EQ(field.polygonize().points, level.mesh.points);
    EXPECT_GT(topologyOf(field.polygonize({.iso = 0.1})).volume, level.report.topology.volume);
    EXPECT_EQ(gridOf(field)->activeVoxelCount(), static_cast<openvdb::Index64>(field.controlPointCount()));
}

}  // namespace
}  // namespace isowave::lod_test
