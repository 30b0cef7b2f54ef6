// A pyramid gives back what the solid itself gives.
#include "wavelets/pyramid.h"
#include "isowave/openvdb.h"
#include "tests/lod/solids.h"
#include "tests/temp_folder.h"
#include "wavelets/pyramid_file.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;
using testing::Not;

Solid ring() { return open(ringMesh(), {.voxels = 40}); }

class RingPyramid : public ::testing::Test {
  protected:
    RingPyramid() { analyse(ring()).save(file()); }
    std::filesystem::path file() const { return folder / "ring.pyramid.vdb"; }
    test::TempFolder folder;
};

TEST_F(RingPyramid, GivesTheMeshesThatTheSolidGives) {
    const LevelOptions plain{.hold = Holding::none}, all{.steps = StepRange{0, 4}, .hold = Holding::none};
    const Ladder direct = makeLadder(ring(), all);
    for (int step = 0; step <= 4; ++step) {
        const MeshTopology &got = makeLevel(open(file(), {.finestStep = step}), step, plain).report.topology,
                           &level = direct.levels[std::size_t(step)].report.topology;
        EXPECT_EQ(got.triangles, level.triangles) << step;
        EXPECT_EQ(got.genus, level.genus) << step;
        EXPECT_NEAR(got.volume, level.volume, 1e-5 * level.volume) << step;
    }
}

TEST_F(RingPyramid, NeedsStep0ForWhatMeasuresAgainstIt) {
    EXPECT_THROW(makeLevel(open(file(), {.finestStep = 3}), 3), UsageError);
    EXPECT_THROW(makeLevel(open(file()), -1), InputError);
    EXPECT_EQ(makeLevel(open(file()), 3).report.topology.genus, 1);
}

TEST_F(RingPyramid, IsAnInputLikeTheSolidItself) {
    const Ladder direct = makeLadder(ring()), again = makeLadder(open(file()));
    EXPECT_EQ(again.input.kind, InputReport::Kind::pyramid);
    EXPECT_EQ(again.input.madeFrom->path, direct.input.path);
    EXPECT_EQ(again.input.madeFrom->triangles, direct.input.triangles);
    EXPECT_EQ(again.input.volume, direct.input.volume);
    EXPECT_EQ(again.input.madeFrom->volume, direct.input.volume);
    EXPECT_EQ(again.levels[1].report.volumeError.has_value(), direct.input.volume.has_value());
    EXPECT_EQ(again.fit->method, direct.fit->method);
    EXPECT_EQ(again.fit->repaired, direct.fit->repaired);
    EXPECT_EQ(again.steps, direct.steps);
    EXPECT_EQ(again.coefficientsStored, direct.coefficientsStored);
    EXPECT_EQ(again.controlPoints, direct.controlPoints);
    ASSERT_EQ(again.levels.size(), direct.levels.size());
    for (std::size_t i = 0; i < direct.levels.size(); ++i) {
        const LevelReport &a = again.levels[i].report, &d = direct.levels[i].report;
        EXPECT_EQ(a.step, d.step);
        EXPECT_EQ(a.spacing, d.spacing);
        EXPECT_EQ(a.controlPoints, d.controlPoints);
        EXPECT_EQ(a.nodes, d.nodes);
        EXPECT_EQ(a.topology.triangles, d.topology.triangles);
        EXPECT_EQ(a.topology.genus, d.topology.genus);
    }
}

TEST_F(RingPyramid, GivesItsFieldAsAGrid) {
    const Pyramid pyramid = Pyramid::open(file());
    const openvdb::FloatGrid::ConstPtr grid = gridOf(pyramid.field(0));
    EXPECT_EQ(static_cast<std::int64_t>(grid->activeVoxelCount()), pyramid.controlPoints());
    const auto valueAt = [&](const openvdb::Vec3d& world) {
        return grid->tree().getValue(openvdb::Coord::round(grid->transform().worldToIndex(world)));
    };
    EXPECT_LT(valueAt({20, 0, 0}), 0) << "negative inside";
    EXPECT_GT(valueAt({0, 0, 0}), 0);
}

TEST_F(RingPyramid, IsListedStepByStep) {
    const Pyramid pyramid = Pyramid::open(file());
    const std::vector<StepFacts> steps = pyramid.steps();
    ASSERT_EQ(steps.size(), static_cast<std::size_t>(pyramid.stepCount()) + 1);
    EXPECT_EQ(steps[0].controlPoints, pyramid.controlPoints());
    EXPECT_EQ(steps[0].coefficients, pyramid.coefficientsStored());
    EXPECT_EQ(steps[0].halvedAxis, std::nullopt);
    EXPECT_GT(pyramid.memoryBytes(), 4 * pyramid.coefficientsStored());
    for (std::size_t s = 0; s + 1 < steps.size(); ++s) {
        EXPECT_EQ(steps[s].step, static_cast<int>(s));
        EXPECT_GT(steps[s].leafOccupancy, 0);
        EXPECT_LE(steps[s].leafOccupancy, 1);
        EXPECT_EQ(steps[s].details + steps[s + 1].coefficients, steps[s].coefficients);
        double ratio = 1;  // one axis is halved at a time
        for (std::size_t axis = 0; axis < 3; ++axis)
            ratio *= steps[s + 1].spacing[axis] / steps[s].spacing[axis];
        EXPECT_DOUBLE_EQ(ratio, 2);
    }
    EXPECT_EQ(steps.back().coefficients, steps.back().controlPoints);
    EXPECT_EQ(steps.back().controlPoints, 64) << "one node";
    EXPECT_EQ(steps.back().nodes, 1);
}

TEST_F(RingPyramid, TakesNoOptionOfTheFitAndIsNotAnalysedAgain) {
    EXPECT_THROW(open(file(), {.voxels = 40}), UsageError);
    EXPECT_THROW(open(file(), {.iso = 0}), UsageError);
    EXPECT_THROW(analyse(open(file())), UsageError);
    EXPECT_THROW(makeLevel(open(file()), 1000), InputError);
}

TEST(CutPyramid, EndsTheLadderWithoutClaimingThatOneNodeIsLeft) {
    const test::TempFolder folder;
    analyse(open(ballImage({32, 32, 32}, 9), {.iso = 0})).save(folder / "whole.vdb");
    const auto remarksOf = [&](const char* name) {
        Remarks remarks;
        makeLadder(open(folder / name), {.levels = StepRange{0, 40}}, {}, remarks.progress());
        return remarks.text;
    };
    EXPECT_THAT(remarksOf("whole.vdb"), HasSubstr("one node is left; the ladder ends at step"));

    const wavelets::Pyramid pyramid = wavelets::readPyramid(folder / "whole.vdb");
    const wavelets::Pyramid cut = wavelets::analyse(pyramid.field(0), {.maxSteps = 2});
    ASSERT_GT(cut.coarsest.controlPointCount(), 64);
    wavelets::writePyramid(folder / "cut.vdb", cut);
    const std::string early = remarksOf("cut.vdb");
    EXPECT_THAT(early, Not(HasSubstr("one node")));
    EXPECT_THAT(early, HasSubstr("the ladder ends at step 2"));
}

}  // namespace
}  // namespace isowave::lod_test
