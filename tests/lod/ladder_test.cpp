// The ladder as a whole: which levels, handed on or kept, measured, ended; and report.json as a function of it.
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "lod/source.h"
#include "tests/lod/solids.h"
#include "tools/report/ladder_report.h"

namespace isowave::lod_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Solid ball(double radius = 9) { return open(ballImage({32, 32, 32}, radius, 0.5), {.iso = 0}); }

std::vector<int> stepsOf(const Ladder& ladder) {
    std::vector<int> steps;
    for (const Level& level : ladder.levels) steps.push_back(level.report.step);
    return steps;
}

TEST(BallLadder, HasTheLevelsThatWereAskedFor) {
    EXPECT_THAT(stepsOf(makeLadder(ball(), {.levels = StepRange{1, 2}})), ElementsAre(3, 6));
    const Ladder steps = makeLadder(ball(), {.steps = StepRange{1, 3}});
    EXPECT_THAT(stepsOf(steps), ElementsAre(1, 2, 3));
    EXPECT_EQ(steps.levels[0].report.level, std::nullopt);
    EXPECT_EQ(steps.levels[2].report.level, 1);
    const Ladder one = makeLadder(ball(), {.levels = StepRange{1, 1}});
    EXPECT_THAT(stepsOf(one), ElementsAre(3));
    EXPECT_EQ(one.levels[0].mesh.points, steps.levels[2].mesh.points);
    EXPECT_GT(one.levels[0].report.rmsToLevel0, 0) << "measured against level 0 all the same";
    EXPECT_THROW(makeLadder(ball(), {.levels = StepRange{30, 30}}), InputError);
}

TEST(BallLadder, MeasuresTheBall) {
    const auto levels = levelsOf(ball());
    ASSERT_GE(levels.size(), 3u);
    EXPECT_EQ(levels[0].topology.components, 1);
    EXPECT_EQ(levels[0].topology.genus, 0);
    expectSound(levels[0].topology);
    EXPECT_EQ(levels[0].rmsToLevel0, 0);
    EXPECT_EQ(levels[0].spacing, (std::array<double, 3>{0.5, 0.5, 0.5}));
    EXPECT_EQ(levels[1].spacing, (std::array<double, 3>{1, 1, 1}));
    EXPECT_GT(levels[1].rmsToLevel0, 0);
    EXPECT_LT(levels[1].rmsToLevel0, 0.15 * 0.5);
    EXPECT_GE(*levels[1].maxToLevel0, *levels[1].rmsToLevel0);
    EXPECT_LT(static_cast<double>(levels[1].topology.triangles),
              0.4 * static_cast<double>(levels[0].topology.triangles));
    // Of a leaf's 512 lattice points, 4 bytes each, so many are control points.
    EXPECT_GT(levels[0].leafOccupancy, 0.1);  // seen 0.37
    EXPECT_LE(levels[0].leafOccupancy, 1);
    EXPECT_GT(static_cast<double>(levels[0].memoryBytes),
              4 * static_cast<double>(levels[0].controlPoints) / levels[0].leafOccupancy);
}

TEST(BallLadder, HandsOnTheMeshesThatItWouldKeep) {
    const Ladder kept = makeLadder(ball());
    std::vector<LevelReport> reports;
    std::vector<TriangleMesh> meshes;
    bool released = false;
    const LadderVisitor visitor{.level =
                                    [&](const LevelReport& report, const TriangleMesh& mesh) {
                                        reports.push_back(report);
                                        meshes.push_back(mesh);
                                    },
                                .beforeMeasuring = [&] { released = true; }};
    const Ladder passed = makeLadder(ball(), {}, visitor);
    ASSERT_EQ(passed.levels.size(), kept.levels.size());
    std::size_t seen = 0;
    for (std::size_t i = 0; i < kept.levels.size(); ++i) {
        EXPECT_TRUE(passed.levels[i].mesh.triangles.empty());
        if (kept.levels[i].report.vanished()) continue;
        ASSERT_LT(seen, meshes.size());
        EXPECT_EQ(meshes[seen].points, kept.levels[i].mesh.points) << i;
        EXPECT_EQ(meshes[seen].normals, kept.levels[i].mesh.normals) << i;
        EXPECT_EQ(reports[seen].step, kept.levels[i].report.step);
        EXPECT_EQ(reports[seen].maxFromLevel0, kept.levels[i].report.maxFromLevel0);
        ++seen;
    }
    EXPECT_EQ(seen, meshes.size());
    EXPECT_TRUE(released);
}

TEST(BallLadder, IsTheSameForEveryNumberOfThreads) {
    const auto made = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Ladder ladder = makeLadder(ball());
        EXPECT_EQ(ladder.threads, static_cast<std::int64_t>(threads));
        nlohmann::json report = nlohmann::json::parse(tools::jsonOf(ladder));
        for (const char* key : {"seconds", "peak_memory_bytes", "threads"}) report.erase(key);
        for (auto& level : report["levels"]) level.erase("seconds");
        std::vector<std::vector<Point>> points;
        for (Level& level : ladder.levels) points.push_back(std::move(level.mesh.points));
        return std::pair(report, points);
    };
    const auto one = made(1);
    EXPECT_EQ(made(2), one);
    EXPECT_EQ(made(4), one);
}

TEST(BallLadder, EndsWhereTheSolidVanishes) {
    Remarks remarks;
    const Ladder ladder =
        makeLadder(open(ballImage({32, 32, 32}, 3), {.iso = 0}), {}, {}, remarks.progress());
    ASSERT_TRUE(ladder.levels.back().report.vanished());
    for (std::size_t i = 0; i + 1 < ladder.levels.size(); ++i)
        EXPECT_FALSE(ladder.levels[i].report.vanished()) << "nothing comes after it";
    EXPECT_EQ(ladder.levels.back().report.rmsToLevel0, std::nullopt);
    EXPECT_THAT(remarks.text, HasSubstr("the whole solid has vanished; the ladder ends before it"));
    EXPECT_THROW(makeLevel(open(ballImage({32, 32, 32}, 3), {.iso = 0}), ladder.levels.back().report.step),
                 InputError);
}

TEST(BallLadder, StopsWhenAsked) {
    Progress progress;
    progress.stopRequested = [] { return true; };
    EXPECT_THROW(makeLadder(ball(), {}, {}, progress), Cancelled);
}

TEST(BallLadder, LeavesASolidThatIsStillHeldAsItWas) {
    const Solid solid = ball();
    const Ladder first = makeLadder(solid), second = makeLadder(solid);
    EXPECT_EQ(first.levels[1].mesh.points, second.levels[1].mesh.points);
}

TEST(ReportJson, TellsOpeningAndMakingByStage) {
    const Ladder ladder = makeLadder(ball());
    const nlohmann::json seconds = nlohmann::json::parse(tools::jsonOf(ladder))["seconds"];
    for (const char* stage : {"read", "distance", "fit", "analyse", "polygonize", "measure", "total"})
        EXPECT_TRUE(seconds.contains(stage)) << stage;
    EXPECT_GE(seconds["total"].get<double>(), seconds["analyse"].get<double>());
}

// What a pyramid's file says of its solid is what the report of the solid says, and comes back with types.
TEST(Source, IsTheReportOfTheInputAndComesBack) {
    const Solid solid = ball();
    const auto source = lod::sourceOf(solid.input(), solid.fit());
    EXPECT_EQ(source.at("input.kind"), "\"grey image\"");
    EXPECT_EQ(source.at("input.spacing"), "[0.5,0.5,0.5]");
    EXPECT_EQ(source.at("fit.method"), "\"distance\"");
    const auto input = lod::inputOfSource(source);
    EXPECT_EQ(input->kind, solid.input().kind);
    EXPECT_EQ(input->dimensions, solid.input().dimensions);
    EXPECT_EQ(input->origin, solid.input().origin);
    EXPECT_EQ(input->direction, solid.input().direction);
    EXPECT_EQ(input->space, Space::lps);
    const auto fit = lod::fitOfSource(source);
    EXPECT_EQ(fit->latticePoints, solid.fit()->latticePoints);
    EXPECT_EQ(fit->repairAgreed, solid.fit()->repairAgreed);
    EXPECT_EQ(lod::sourceOf(*input, fit), source);
}

TEST(Source, OfAnotherProgramIsTakenAsFarAsItIsUnderstood) {
    EXPECT_FALSE(lod::inputOfSource({{"author", "me"}}));
    const auto input = lod::inputOfSource(
        {{"input.path", "plain text"}, {"input.spacing", "3"}, {"input.open_border", "\"perhaps\""}});
    EXPECT_EQ(input->path, "plain text");
    EXPECT_FALSE(input->spacing);
    EXPECT_FALSE(input->openBorder);
    EXPECT_FALSE(lod::borderOf(*input));
}

TEST(Version, IsThatOfTheProject) { EXPECT_STREQ(ISOWAVE_VERSION, ISOWAVE_PROJECT_VERSION); }

}  // namespace
}  // namespace isowave::lod_test
