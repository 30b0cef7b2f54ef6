// Solids whose voxels are no cubes: the first levels halve the short edges alone.
#include "lod/dry_run/dry_run.h"
#include "lod/pyramid_state.h"
#include "tests/lod/solids.h"
#include "tests/temp_folder.h"
#include "wavelets/exact.h"

namespace isowave::lod_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Voxel = std::array<double, 3>;

// A plate 30 x 28 x 16 mm with two holes and a ball on it, sampled by voxels of any size; 20 HU a mm.
double plate(double x, double y, double z) {
    double d = std::max({std::abs(x - 20.3) - 15.2, std::abs(y - 19.4) - 14.1, std::abs(z - 12.1) - 8.1});
    d = std::max({d, 3.1 - std::hypot(x - 12.2, y - 19.4), 5.2 - std::hypot(x - 26.3, y - 19.1)});
    return std::min(d, std::hypot(x - 20.3, y - 8.4, z - 22.3) - 3.7);
}

Image sampledPlate(const Voxel& voxel) {
    const Size size{static_cast<int>(41 / voxel[0]), static_cast<int>(39 / voxel[1]),
                    static_cast<int>(34 / voxel[2])};
    Image image = imageOf(size, [&](int x, int y, int z) {
        return std::lround(
            std::clamp(-20.0 * plate(x * voxel[0], y * voxel[1], z * voxel[2]), -200.0, 200.0));
    });
    for (std::size_t a = 0; a < 3; ++a) image.indexToWorld.axis[a][a] = voxel[a];
    return image;
}

constexpr Voxel kFlat{0.5, 0.5, 2};       // "xy", "xy"
constexpr Voxel kTall{1, 1, 0.4};         // "z"
constexpr Voxel kLikeCt{0.6, 0.6, 0.94};  // none; "xy" by StepAxes::cubes
const SolidOptions kAtZero{.iso = 0};

Solid solidOf(const Voxel& voxel, const SolidOptions& options = kAtZero, const Progress& progress = {}) {
    return open(sampledPlate(voxel), options, progress);
}

TEST(StepAxes, LevelsOfFlatVoxelsMakeThemCubesFirst) {
    Remarks remarks;
    const Solid solid = solidOf(kFlat, kAtZero, remarks.progress());
    EXPECT_THAT(solid.order().first, ElementsAre("xy", "xy"));
    EXPECT_THAT(remarks.text,
                HasSubstr("image: voxels are 0.5 x 0.5 x 2: the first 2 levels halve x and y only, later "
                          "ones x, y and z (--axes xyz: all of them)\n"));
    const Ladder ladder = makeLadder(solid, {.levels = StepRange{0, 3}});
    EXPECT_EQ(ladder.order, solid.order());
    std::vector<int> steps, levels;
    std::vector<Voxel> voxels;
    for (const LevelReport& report : reportsOf(ladder)) {
        steps.push_back(report.step);
        levels.push_back(report.level.value_or(-1));
        voxels.push_back(report.spacing);
    }
    EXPECT_THAT(steps, ElementsAre(0, 2, 4, 7));
    EXPECT_THAT(levels, ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(voxels, ElementsAre(kFlat, Voxel{1, 1, 2}, Voxel{2, 2, 2}, Voxel{4, 4, 4}));
}

TEST(StepAxes, XyzHalvesAllAxesFromTheStart) {
    Remarks remarks;
    const Solid solid = solidOf(kFlat, {.iso = 0, .axes = StepAxes::xyz}, remarks.progress());
    EXPECT_THAT(solid.order().first, IsEmpty());
    EXPECT_THAT(remarks.text, testing::Not(HasSubstr("halve")));
    const std::vector<LevelReport> levels = levelsOf(solid, {.levels = StepRange{0, 2}});
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_EQ(levels[1].step, 3);
    EXPECT_EQ(levels[2].spacing, (Voxel{2, 2, 8}));
}

TEST(StepAxes, OfCubesAreInTurnAndNothingIsSaid) {
    Remarks remarks;
    EXPECT_THAT(solidOf(kLikeCt, kAtZero, remarks.progress()).order().first, IsEmpty());
    EXPECT_THAT(open(ringMesh(), {.voxels = 30}, remarks.progress()).order().first, IsEmpty());
    EXPECT_THAT(remarks.text, testing::Not(HasSubstr("halve")));
}

TEST(StepAxes, CubesHalvesWhereverThatBringsVoxelsNearerToOne) {
    const SolidOptions cubes{.iso = 0, .axes = StepAxes::cubes};
    EXPECT_THAT(solidOf(kLikeCt, cubes).order().first, ElementsAre("xy"));
    EXPECT_THAT(solidOf({1, 1, 1.3}, cubes).order().first, IsEmpty());
}

TEST(StepAxes, LevelsHoldLikeAnyOther) {
    for (const Voxel& voxel : {kFlat, kTall, kLikeCt}) {
        const std::vector<LevelReport> levels = levelsOf(solidOf(voxel, {.iso = 0, .axes = StepAxes::cubes}));
        ASSERT_GE(levels.size(), 4u);
        EXPECT_EQ(countsOf(levels[0].topology), (SolidCounts{1, 2, 0}));
        for (const LevelReport& level : levels) {
            if (level.vanished()) break;
            expectSound(level.topology);
            EXPECT_EQ(level.level, static_cast<int>(&level - levels.data()));
            EXPECT_LE(level.change.parts, 0) << level.step;
            EXPECT_LE(level.change.handles, 0) << level.step;
            EXPECT_LE(level.change.cavities, 0) << level.step;
            EXPECT_FALSE(level.limitsMissed) << *level.limitsMissed;
        }
    }
}

// At equal resolution across the slices the level keeps the one between them, so it is nearer to level 0.
TEST(StepAxes, LevelsOfFlatVoxelsAreNearerToLevel0) {
    const std::vector<LevelReport> nearer = levelsOf(solidOf(kFlat), {.levels = StepRange{0, 2}}),
                                   inTurn = levelsOf(solidOf(kFlat, {.iso = 0, .axes = StepAxes::xyz}),
                                                     {.levels = StepRange{0, 2}});
    if (!canMeasureDistances()) GTEST_SKIP() << "distances need simplify/";
    for (const std::size_t level : {1u, 2u})
        EXPECT_LT(*nearer[level].rmsToLevel0, 0.75 * *inTurn[level].rmsToLevel0)
            << level;  // seen 0.61 at level 2
}

class StoredSteps : public ::testing::Test {
  protected:
    test::TempFolder folder;
};

void expectSameLevels(const std::vector<Level>& direct, const std::vector<Level>& again) {
    ASSERT_EQ(direct.size(), again.size());
    for (std::size_t i = 0; i < direct.size(); ++i) {
        EXPECT_EQ(again[i].report.step, direct[i].report.step);
        EXPECT_EQ(again[i].report.level, direct[i].report.level);
        EXPECT_EQ(again[i].report.spacing, direct[i].report.spacing);
        EXPECT_EQ(again[i].report.controlPoints, direct[i].report.controlPoints);
    }
}

TEST_F(StoredSteps, APyramidsFileKeepsTheirOrder) {
    const Solid solid = solidOf(kFlat);
    const LevelOptions plain{.hold = Holding::none};
    const Pyramid pyramid = analyse(solid);
    EXPECT_EQ(pyramid.order(), solid.order());
    pyramid.save(folder / "a.vdb");
    EXPECT_EQ(Pyramid::open(folder / "a.vdb").order(), solid.order());
    const Ladder direct = makeLadder(solid, plain), again = makeLadder(open(folder / "a.vdb"), plain);
    EXPECT_EQ(again.order, direct.order);
    expectSameLevels(direct.levels, again.levels);
    const Solid fromLevel2 = open(folder / "a.vdb", {.finestLevel = 2});
    EXPECT_EQ(makeLevel(fromLevel2, fromLevel2.order().stepOf(2), plain).report.topology.triangles,
              direct.levels[2].report.topology.triangles);
    EXPECT_THROW(open(folder / "a.vdb", {.finestLevel = -1}), UsageError);
    EXPECT_THROW(open(folder / "a.vdb", {.finestStep = -1}), UsageError);
    for (const int far : {1'000'000'000, 2'000'000'000})
        EXPECT_THROW(makeLevel(solid, solid.order().stepOf(far), plain), InputError);
    EXPECT_THROW(makeLadder(solid, {.levels = StepRange{1'000'000'000, {}}, .hold = Holding::none}),
                 InputError);
    EXPECT_THROW(makeLevel(fromLevel2, 3, plain), UsageError);  // step 3 is finer, and was not read
    std::vector<std::optional<int>> levels;
    for (const StepFacts& facts : pyramid.steps()) levels.push_back(facts.level);
    levels.resize(8);
    EXPECT_THAT(levels, ElementsAre(0, std::nullopt, 1, std::nullopt, 2, std::nullopt, std::nullopt, 3));
    const std::vector<LevelReport> described = describeLevels(pyramid, plain);
    ASSERT_GE(described.size(), 3u);
    EXPECT_EQ(described[2].step, 4);
    EXPECT_EQ(described[2].topology.triangles, direct.levels[2].report.topology.triangles);
}

TEST_F(StoredSteps, APackedSolidKeepsThemToTheBit) {
    pack(solidOf(kFlat), folder / "a.iwz");
    const Solid again = open(folder / "a.iwz");
    EXPECT_THAT(again.order().first, ElementsAre("xy", "xy"));
    EXPECT_FALSE(again.input().source.contains("levels.first"));
    const Ladder direct = makeLadder(solidOf(kFlat)), unpacked = makeLadder(again);
    expectSameLevels(direct.levels, unpacked.levels);
    for (std::size_t i = 0; i < direct.levels.size(); ++i)
        EXPECT_EQ(unpacked.levels[i].mesh.points, direct.levels[i].mesh.points) << i;
    EXPECT_EQ(Pyramid::open(folder / "a.iwz").order(), again.order());
    // And on: packed again, or made a pyramid of.
    pack(again, folder / "b.iwz");
    analyse(open(folder / "b.iwz")).save(folder / "c.iwz");
    EXPECT_EQ(open(folder / "c.iwz").order(), again.order());
    // Without a word of them, as files were before, levels halve all axes.
    pack(solidOf(kFlat, {.iso = 0, .axes = StepAxes::xyz}), folder / "in_turn.iwz");
    EXPECT_THAT(open(folder / "in_turn.iwz").order().first, IsEmpty());
}

TEST_F(StoredSteps, ThoseOfAPyramidCannotBeChosenAgain) {
    analyse(solidOf(kFlat)).save(folder / "a.vdb");
    pack(solidOf(kFlat), folder / "a.iwz");
    for (const char* name : {"a.vdb", "a.iwz"}) try {
            open(folder / name, {.axes = StepAxes::xyz});
            ADD_FAILURE() << name;
        } catch (const UsageError& error) {
            EXPECT_THAT(error.what(), HasSubstr("--axes has no meaning for"));
        }
}

TEST(StepAxes, BudgetsAreMadeOfTheirSteps) {
    if (!canMeasureDistances()) GTEST_SKIP() << "budgets need simplify/";
    const Ladder ladder = makeBudget(solidOf(kFlat), {.triangles = {600}, .tolerances = {1.5}});
    for (const BudgetLevel& budget : ladder.budgets) {
        expectSound(budget.report.topology);
        EXPECT_EQ(budget.report.level, ladder.order.levelOf(budget.report.step));
    }
    EXPECT_LE(ladder.budgets[0].report.topology.triangles, 600);
    EXPECT_LE(ladder.budgets[1].report.toLevel0.maxBound, 1.5);
}

TEST(StepAxes, RegionsKeepAFinerLevelInPlace) {
    const RegionBox around{{6, 13, -10}, {18, 26, 40}};  // the small hole
    const Ladder plain = makeLadder(solidOf(kFlat), {.levels = StepRange{0, 4}});
    for (const int level : {0, 1}) {
        const Ladder kept =
            makeLadder(solidOf(kFlat), {.levels = StepRange{0, 4}, .fine = {{around, level, 0}}});
        ASSERT_EQ(kept.levels.size(), 5u);
        for (int l = level + 1; l <= 4; ++l) {
            const LevelReport &report = kept.levels[static_cast<std::size_t>(l)].report,
                              &without = plain.levels[static_cast<std::size_t>(l)].report;
            expectSound(report.topology);
            ASSERT_TRUE(report.regions) << l;
            EXPECT_GT(report.regions->trianglesInside, 100) << l;
            EXPECT_LT(report.topology.triangles,
                      plain.levels[static_cast<std::size_t>(level)].report.topology.triangles)
                << l;
            EXPECT_GE(report.topology.genus, without.topology.genus) << l;
            EXPECT_TRUE(level == 1 || report.regions->maxInside.value_or(0) < 0.2) << l;  // seen 0.11 mm
        }
    }
}

TEST(StepAxes, EditsAreMadeOnTheirLevels) {
    const Ball ball{{20.3, 30.1, 12.3}, 5};  // in the plate, but for a bit
    const Pyramid before = analyse(solidOf(kFlat));
    for (const int level : {0, 1, 2}) {
        const EditedPyramid edited = edit(before, {EditCut{Ball{{18.6, 26.9, 12.3}, 5.5}}},
                                          {.level = level, .checkSteps = level == 1});
        EXPECT_EQ(edited.pyramid.order(), before.order());
        const EditStory& story = edited.report.edits[0];
        EXPECT_NEAR((story.volumeAfter - story.volumeBefore) / -*story.toolVolume, 1, 0.06) << level;
        EXPECT_EQ(edited.report.closedSteps, edited.report.checkedSteps);
        const EditedPyramid undone = edit(edited.pyramid, {EditWith{before}});
        EXPECT_TRUE(wavelets::areSame(PyramidAccess::of(undone.pyramid).field(0),
                                      PyramidAccess::of(before).field(0)));
    }
    // A level's field that another program changed: that of the same level with the ball cut off.
    const Pyramid cut = edit(before, {EditCut{ball}}).pyramid;
    const int step = before.order().stepOf(1);
    const EditedPyramid taken = edit(before, {EditWith{cut.field(step)}}, {.level = 1});
    const EditStory& story = taken.report.edits[0];
    EXPECT_LT(story.volumeAfter, story.volumeBefore - 100);
    const Pyramid inTurn = analyse(solidOf(kFlat, {.iso = 0, .axes = StepAxes::xyz}));
    try {
        edit(cut, {EditWith{inTurn}});
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("was made with other --axes than the pyramid"));
    }
}

TEST(StepAxes, StepsThatDoNotExistAreToldByTheirLevels) {
    const Pyramid pyramid = analyse(solidOf(kFlat));
    try {
        makeLevel(isowave::solidOf(pyramid), pyramid.stepCount() + 1);
        ADD_FAILURE();
    } catch (const InputError& error) {
        const int last = pyramid.order().levelUpTo(pyramid.stepCount());
        EXPECT_THAT(error.what(), HasSubstr("(levels 0 to " + std::to_string(last) + ")"));
    }
}

}  // namespace
}  // namespace isowave::lod_test
