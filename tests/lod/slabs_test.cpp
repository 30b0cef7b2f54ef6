// Images in slabs: the same field, pyramid and levels as of the whole, to the bit.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "isowave/openvdb.h"
#include "isowave/pyramid.h"
#include "lod/pyramid_state.h"
#include "lod/slabs/slab_cuts.h"
#include "lod/solid_state.h"
#include "tests/lod/solids.h"
#include "tests/temp_folder.h"

namespace isowave::lod_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A gyroid whose walls are 5 voxels thick, that touches all borders of the image.
Image gyroid(Size size) {
    return imageOf(size, [](int x, int y, int z) {
        const double k = 0.32, a = k * x, b = k * y, c = k * z;
        const double g = std::sin(a) * std::cos(b) + std::sin(b) * std::cos(c) + std::sin(c) * std::cos(a);
        return std::lround(200 * std::clamp(0.6 - std::abs(g), -1.0, 1.0));
    });
}
const Image& largeGyroid() {
    static const Image image = gyroid({64, 56, 90});
    return image;
}

// Independent voxels: the repair takes the most passes.
Image noise(Size size) {
    std::mt19937 random(7);
    return imageOf(size, [&](int, int, int) { return random() % 2 ? 100 : -100; });
}

std::string bytesOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

std::string refusal(const std::function<void()>& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

class Slabs : public ::testing::Test {
  protected:
    SolidOptions in(int slabs, SolidOptions options = {.iso = 0}) const {
        options.slabs = slabs;
        options.slabFolder = folder.path();
        return options;
    }
    std::string pyramidOf(const Image& image, const SolidOptions& options) const {
        analyse(open(image, options)).save(folder / "p.vdb");
        return bytesOf(folder / "p.vdb");
    }
    std::string writtenAtOnce(const Image& image, const SolidOptions& options) const {
        analyseTo(folder / "p.vdb", open(image, options));
        return bytesOf(folder / "p.vdb");
    }
    void expectSame(const Image& image, const SolidOptions& options, const std::vector<int>& counts) const {
        const std::string whole = pyramidOf(image, options);
        for (const int slabs : counts)
            EXPECT_TRUE(writtenAtOnce(image, in(slabs, options)) == whole) << slabs;
        EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "slabs are gone";
    }
    test::TempFolder folder;
};

TEST(SlabCuts, LieBetweenLeavesAndAreHalvedWithTheLattice) {
    const lod::SlabCuts cuts = lod::SlabCuts::even(2, 90, 4);
    EXPECT_THAT(cuts.at, ElementsAre(24, 48, 64));
    EXPECT_THAT(cuts.halved().at, ElementsAre(16, 24, 32));
    EXPECT_THAT(cuts.halved().halved().at, ElementsAre(8, 16));
    EXPECT_THAT(lod::SlabCuts::even(2, 17, 100).at, ElementsAre(8, 16));
    EXPECT_EQ(cuts.box(1).min().z(), 24);
    EXPECT_EQ(cuts.box(1).max().z(), 47);
}

TEST_F(Slabs, GiveThePyramidOfTheWholeToTheByte) { expectSame(largeGyroid(), {.iso = 0}, {1, 2, 5, 400}); }

TEST_F(Slabs, GiveItInMemoryToo) {
    const std::string whole = pyramidOf(largeGyroid(), {.iso = 0});
    EXPECT_EQ(pyramidOf(largeGyroid(), in(3)), whole);
}

TEST_F(Slabs, CountWhatIsWritten) {
    const Pyramid whole = analyse(open(largeGyroid(), {.iso = 0}));
    for (const SolidOptions& options : {in(3), SolidOptions{.iso = 0}}) {
        const PyramidCounts counts = analyseTo(folder / "p.vdb", open(largeGyroid(), options));
        EXPECT_EQ(counts.steps, whole.stepCount());
        EXPECT_EQ(counts.controlPoints, whole.controlPoints());
        EXPECT_EQ(counts.coefficientsStored, whole.coefficientsStored());
    }
}

TEST_F(Slabs, GiveItForEveryWayToSayWhatIsInside) {
    expectSame(largeGyroid(), {.iso = 0, .invert = true}, {4});
    expectSame(largeGyroid(), {.iso = 0, .openBorder = true}, {4});
    expectSame(largeGyroid(), {.iso = 50, .halfWidth = 3.5, .band = 3}, {4});
    expectSame(largeGyroid(), {.iso = 0, .fit = FitMethod::binary}, {4});
    const Image mask =
        imageOf({40, 44, 60}, [](int x, int y, int z) { return (x / 9 + y / 7 + z / 11) % 3; });
    expectSame(mask, {.labels = {1, 2}, .fit = FitMethod::distance}, {3});
    expectSame(mask, {.label = 2, .fit = FitMethod::binary}, {3});
    expectSame(mask, {.labels = {1, 2}}, {3});
}

TEST_F(Slabs, GiveItForVoxelsThatAreNoCubesAndForEveryFirstAxis) {
    Image flat = largeGyroid();
    flat.indexToWorld.axis[2][2] = 4;
    expectSame(flat, {.iso = 0}, {3});
    flat.indexToWorld.axis[2][2] = 0.25;
    expectSame(flat, {.iso = 0}, {3});  // z alone is halved first
}

// A slab of 150 slices does not see the whole, and what it sees ends in faces that the whole does not have.
TEST_F(Slabs, OfMasksSeeAsFarAsTheirFitReaches) {
    std::mt19937 random(7);
    const Image mask = imageOf({14, 12, 900}, [&](int x, int y, int z) {
        return random() % 16 == 0 || std::hypot(x - 6.5, y - 5.5) < 4 + std::sin(0.11 * z);
    });
    expectSame(mask, {}, {6, 30});
    EXPECT_EQ(open(mask, in(6, {})).fit()->gradientPasses, 60);
}

TEST_F(Slabs, AreMadeThinnerWhereOneWouldTakeMoreMemoryThanItMay) {
    const Image rod = imageOf({40, 40, 400}, [](int x, int y, int) {
        return std::lround(20 * std::clamp(15 - std::hypot(x - 19.3, y - 20.2), -4.0, 4.0));
    });
    SolidOptions options = in(2);
    const auto saidOf = [&](double bytes) {
        std::string said;
        options.slabMemory = bytes;
        Progress progress;
        progress.remark = [&](std::string_view line) { said += line; };
        open(rod, options, progress);
        return said;
    };
    EXPECT_THAT(saidOf(1e9), Not(HasSubstr("instead of")));
    EXPECT_THAT(saidOf(132e6),
                HasSubstr("slabs instead of 2, each of which would take more than 2 MB of memory"));
    expectSame(rod, {.iso = 0, .slabMemory = 132e6}, {2});
    EXPECT_THAT(refusal([&] { saidOf(130.1e6); }),
                HasSubstr("slabs are 8 slices thick as they are, and see"));
    EXPECT_THAT(refusal([&] { saidOf(1e8); }), HasSubstr("the program alone takes 130 MB"));
}

TEST_F(Slabs, AreFittedAgainWhereTheRepairReachesFartherThanTheySaw) {
    const Image image = noise({24, 20, 64});
    const auto fit = open(image, {.iso = 0, .fit = FitMethod::binary}).fit();
    const auto inSlabs = open(image, in(4, {.iso = 0, .fit = FitMethod::binary})).fit();
    EXPECT_GE(fit->repairPasses, 16) << "what is seen at first does not tell that there is no more to do";
    EXPECT_EQ(inSlabs->repairPasses, fit->repairPasses);
    expectSame(image, {.iso = 0, .fit = FitMethod::binary}, {4});
}

TEST_F(Slabs, AreFittedAgainWhereOnlyTheLastOneNeedsMorePasses) {
    std::mt19937 random(7);
    const Image image = imageOf({24, 20, 96}, [&](int x, int y, int z) {
        if (z > 80) return random() % 2 ? 100L : -100L;
        return std::lround(20 * std::clamp(7 - std::hypot(x - 11.6, y - 9.3), -4.0, 4.0));
    });
    EXPECT_GT(open(image, {.iso = 0}).fit()->repairPasses, 4) << "the first slabs are tried with fewer";
    expectSame(image, {.iso = 0}, {3, 6});
}

void expectSameLadders(const Ladder& parts, const Ladder& whole) {
    ASSERT_EQ(parts.levels.size(), whole.levels.size());
    for (std::size_t i = 0; i < whole.levels.size(); ++i) {
        EXPECT_EQ(parts.levels[i].mesh.points, whole.levels[i].mesh.points);
        EXPECT_EQ(parts.levels[i].mesh.triangles, whole.levels[i].mesh.triangles);
    }
    EXPECT_EQ(parts.steps, whole.steps);
    EXPECT_EQ(parts.coefficientsStored, whole.coefficientsStored);
    EXPECT_EQ(parts.controlPoints, whole.controlPoints);
    EXPECT_EQ(parts.fit->repaired, whole.fit->repaired);
    EXPECT_EQ(parts.fit->latticePoints, whole.fit->latticePoints);
    EXPECT_EQ(parts.K, whole.K);
}

TEST_F(Slabs, GiveTheSameLevelsAndReports) {
    const LevelOptions plain{.levels = StepRange{0, 2}, .hold = Holding::none};
    expectSameLadders(makeLadder(open(largeGyroid(), in(5)), plain),
                      makeLadder(open(largeGyroid(), {.iso = 0}), plain));
    // By default, of a box with walls 3 voxels thick.
    const Image box = imageOf({60, 50, 70}, [](int x, int y, int z) {
        const double d =
            std::max({std::abs(x - 29.6) - 24, std::abs(y - 24.4) - 18, std::abs(z - 34.3) - 28});
        return std::lround(20 * std::clamp(1.5 - std::abs(d), -4.0, 4.0));
    });
    expectSameLadders(makeLadder(open(box, in(5)), {.levels = StepRange{0, 2}}),
                      makeLadder(open(box, {.iso = 0}), {.levels = StepRange{0, 2}}));
}

TEST_F(Slabs, TheirTasksMayRunInAnyOrderAndTwice) {
    const fs::path image = folder / "gyroid.nrrd";
    const Image& values = largeGyroid();
    tools_test::writeNrrd(image, {64, 56, 90},
                          std::vector<float>(values.values.begin(), values.values.end()));
    int run = 0;
    SolidOptions options = in(5);
    fs::create_directory(folder / "slabs");
    options.slabFolder = folder / "slabs";
    const auto reversed = [&](const std::vector<std::string>& tasks, const Progress& progress) {
        std::vector<std::string> told(tasks.size());
        for (std::size_t i = tasks.size(); i-- > 0; ++run) {
            told[i] = runSlabTask(image, options, tasks[i], progress);
            EXPECT_EQ(runSlabTask(image, options, tasks[i], progress), told[i]);
        }
        return told;
    };
    SolidOptions mapped = options;
    mapped.slabMap = reversed;
    analyse(open(image, mapped)).save(folder / "mapped.vdb");
    analyse(open(image, {.iso = 0})).save(folder / "whole.vdb");
    EXPECT_EQ(bytesOf(folder / "mapped.vdb"), bytesOf(folder / "whole.vdb"));
    EXPECT_GE(run, 10);

    // A job that begins again goes on: what is told is there, although the task's files are not made again.
    const auto before = fs::last_write_time(folder / "slabs" / "fit_0.vdb");
    analyse(open(image, mapped)).save(folder / "again.vdb");
    EXPECT_EQ(fs::last_write_time(folder / "slabs" / "fit_0.vdb"), before);
    EXPECT_EQ(bytesOf(folder / "again.vdb"), bytesOf(folder / "whole.vdb"));
}

// Jobs that end half way leave files of the same names.
TEST_F(Slabs, OfAnotherJobAreNotTakenForOnesOwn) {
    const fs::path image = folder / "gyroid.nrrd";
    const Image& values = largeGyroid();
    tools_test::writeNrrd(image, {64, 56, 90},
                          std::vector<float>(values.values.begin(), values.values.end()));
    fs::create_directory(folder / "slabs");
    const auto job = [&](double iso, int mostMaps) {
        SolidOptions options{.iso = iso, .slabs = 4, .slabFolder = folder / "slabs"};
        const SolidOptions reading = options;
        options.slabMap = [=, maps = 0](const std::vector<std::string>& tasks,
                                        const Progress& progress) mutable {
            if (maps++ == mostMaps) throw Cancelled();
            std::vector<std::string> told;
            for (const std::string& task : tasks) told.push_back(runSlabTask(image, reading, task, progress));
            return told;
        };
        return options;
    };
    constexpr int kAll = 1000;
    EXPECT_THROW(analyse(open(image, job(0, 2))), Cancelled);
    EXPECT_THROW(analyse(open(image, job(60, 2))), Cancelled);
    analyse(open(image, job(0, kAll))).save(folder / "parts.vdb");
    analyse(open(image, {.iso = 0})).save(folder / "whole.vdb");
    EXPECT_EQ(bytesOf(folder / "parts.vdb"), bytesOf(folder / "whole.vdb"));
    // Steps that end elsewhere, of the same fit.
    const Ladder parts = makeLadder(open(image, job(0, kAll)),
                                    {.levels = StepRange{1, 1}, .hold = Holding::none}),
                 whole =
                     makeLadder(open(image, {.iso = 0}), {.levels = StepRange{1, 1}, .hold = Holding::none});
    EXPECT_EQ(parts.levels[0].mesh.points, whole.levels[0].mesh.points);
    analyse(open(image, job(0, kAll))).save(folder / "again.vdb");
    EXPECT_EQ(bytesOf(folder / "again.vdb"), bytesOf(folder / "whole.vdb"));
}

TEST_F(Slabs, AreRefusedForDistancesThatNeedTheWhole) {
    EXPECT_THAT(refusal([&] { open(largeGyroid(), in(2, {.iso = 0, .halfWidth = 6})); }),
                HasSubstr("take --half-width 4 or less"));
    EXPECT_THAT(refusal([&] { open(ringMesh(), in(2, {})); }), HasSubstr("--slabs has no meaning for mesh"));
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

// A pyramid is made in slabs; levels are made of the whole, but for coarse ones that nothing is held in.
TEST_F(Slabs, AreRefusedWhereLevelsWouldTakeMoreMemoryThanAllowed) {
    SolidOptions options = in(3);
    double refused = 1e6;  // of the whole
    const auto ofWhole = [&] { open(largeGyroid(), {.iso = 0, .maxMemory = refused}); };
    while (!refusal(ofWhole).empty()) refused *= 1.2;
    options.maxMemory = refused / 1.3;
    EXPECT_THAT(refusal([&] {
                    makeLadder(open(largeGyroid(), options), {.levels = StepRange{0, 1}});
                }),
                HasSubstr("levels need the whole: take a coarser one with isowave mesh --hold none"));
    EXPECT_EQ(refusal([&] { makeLevel(open(largeGyroid(), options), 6, {.hold = Holding::none}); }), "");
    options.fieldOnly = true;
    EXPECT_EQ(refusal([&] { analyseTo(folder / "p.vdb", open(largeGyroid(), options)); }), "");
}

TEST_F(Slabs, SayWhatIsWrongWithATask) {
    const fs::path image = folder / "gyroid.nrrd";
    EXPECT_THAT(refusal([&] { runSlabTask(image, {}, "no task"); }), HasSubstr("one version of isowave"));
    EXPECT_THAT(refusal([&] { runSlabTask(image, {}, R"({"task": "fit"})"); }), HasSubstr("lacks a part"));
    SolidOptions options = in(2);
    options.slabMap = [](const auto&, const Progress&) { return std::vector<std::string>{"{}"}; };
    EXPECT_THAT(refusal([&] { open(largeGyroid(), options); }),
                HasSubstr("2 tasks were given away and 1 came back"));
}

TEST_F(Slabs, LeaveNothingBehindWhenTheyAreStopped) {
    const Progress stop{.report = {}, .stopRequested = [&] {
                            return std::any_of(fs::directory_iterator(folder.path()),
                                               fs::directory_iterator(),
                                               [](const auto& entry) { return !fs::is_empty(entry.path()); });
                        }};
    EXPECT_THROW(open(largeGyroid(), in(4), stop), Cancelled);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace isowave::lod_test
