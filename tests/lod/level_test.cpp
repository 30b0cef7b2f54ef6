// What a level's mesh is made like, and what is told about it: the iso-value, specks, topology, features, sampling.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/lod/solids.h"
#include "tests/zoo/zoo.h"
#include "tools/report/level_story.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;

// A box 40 x 40 x 14 with four holes of radius 1.5, 2.5, 4 and 6 voxels through it, and a grain of radius 1.7 beside it.
double plate(double x, double y, double z) {
    const double radius[] = {1.5, 2.5, 4, 6};
    double d = std::max({std::abs(x - 27.3) - 22.2, std::abs(y - 27.4) - 22.1, std::abs(z - 12.2) - 5.1});
    for (int i = 0; i < 4; ++i)
        d = std::max(d, radius[i] - std::hypot(x - 16.6 - 21.7 * (i % 2), y - 16.1 - 22.3 * (i / 2)));
    return std::min(d, std::hypot(x - 27, y - 27, z - 24.1) - 1.7);
}

// A wall 2 voxels thick, in a frame that is 8 thick.
double framedWall(double x, double y, double z) {
    const double a = std::max(std::abs(x - 30.2), std::abs(y - 29.7)), h = std::abs(z + 0.15 * x - 20.3);
    return std::min(std::max(h - 1, a - 22), std::max({h - 4, a - 22, 16 - a}));
}

Solid plateSolid() { return open(distanceImage({56, 56, 30}, plate), {.iso = 0}); }
Solid wallSolid() { return open(distanceImage({62, 62, 36}, framedWall), {.iso = 0}); }

// A block with a slit 0.3 wide, 12 deep and 9 long, turned: 1 part, no handle.
TriangleMesh slitMesh() {
    const double polygon[8][2] = {{0, 0},    {12, 0},   {12, 16},   {6.15, 16},
                                  {6.15, 4}, {5.85, 4}, {5.85, 16}, {0, 16}};
    const double turn = std::numbers::pi / 6, tilt = 0.4;
    TriangleMesh mesh;
    for (const double z : {0.0, 9.0})
        for (const auto& [x, y] : polygon) {
            const double u = x * std::cos(turn) - y * std::sin(turn),
                         v = x * std::sin(turn) + y * std::cos(turn);
            mesh.points.push_back(
                {u, v * std::cos(tilt) - z * std::sin(tilt), v * std::sin(tilt) + z * std::cos(tilt)});
        }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 1, 4, 5}, {1, 2, 3, 4}, {5, 6, 7, 0}}) {
        quad(d, c, b, a);
        quad(a + 8, b + 8, c + 8, d + 8);
    }
    for (std::uint32_t i = 0; i < 8; ++i) quad(i, (i + 1) % 8, (i + 1) % 8 + 8, i + 8);
    return mesh;
}

Solid realSolid(const std::string& file, const SolidOptions& options) {
    return open(std::filesystem::path(ISOWAVE_TEST_DATA) / file, options);
}

TEST(Levels, KeepTheVolumeOfLevel0) {
    const auto levels = levelsOf(plateSolid(), {.levels = StepRange{0, 3}, .preserveVolume = true});
    ASSERT_GE(levels.size(), 3u);
    const double volume = levels[0].topology.volume;
    EXPECT_EQ(levels[0].isoShift, 0);
    EXPECT_EQ(levels[0].volumeError, 0);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const LevelReport& level = levels[i];
        EXPECT_LT(std::abs(*level.volumeError), 1e-4) << i;
        EXPECT_NEAR(level.topology.volume, volume, 1.0001e-4 * volume) << i;
        EXPECT_NE(level.isoShift, 0) << i;
        EXPECT_LT(std::abs(level.isoShift), 0.75) << i;
        // The distance is what the volume grew by, over the area.
        const double grown = level.topology.volume - *level.volumeAtIso0;
        EXPECT_NEAR(*level.isoDistance, grown / level.topology.area, 0.3 * std::abs(*level.isoDistance)) << i;
        expectSound(level.topology);
        EXPECT_THAT(tools::storyText(level, " mm"), HasSubstr("moves the surface by"));
    }
    const auto free = levelsOf(plateSolid(), {.levels = StepRange{0, 2}});
    EXPECT_EQ(free[1].isoShift, 0);
    EXPECT_EQ(free[1].topology.volume, levels[1].volumeAtIso0);
}

TEST(Levels, AreMeasuredByTheInputsVolumeAndKeepIt) {
    const TriangleMesh ring = ringMesh();
    const double volume = topologyOf(ring).volume;
    const auto levels = [&](bool preserve) {
        return levelsOf(open(ring, {.voxels = 40}), {.levels = StepRange{0, 2}, .preserveVolume = preserve});
    };
    for (const LevelReport& level : levels(false))
        EXPECT_NEAR(*level.volumeError, level.topology.volume / volume - 1, 1e-9);
    for (const LevelReport& level : levels(true)) {
        EXPECT_NEAR(level.topology.volume, volume, 1.0001e-4 * volume);
        EXPECT_LT(std::abs(*level.volumeError), 1e-4);
        EXPECT_NE(level.isoShift, 0) << "level 0's polyhedron is smaller than the ring, too";
    }
}

TEST(Levels, SayWhereTheVolumeIsOutOfReach) {
    const Image ball = distanceImage(
        {24, 24, 24}, [](int x, int y, int z) { return std::hypot(x - 11.6, y - 11.4, z - 11.8) - 1.2; });
    Remarks remarks;
    bool missed = false;
    for (const LevelReport& level :
         levelsOf(open(ball, {.iso = 0}), {.preserveVolume = true}, remarks.progress()))
        missed = missed || (level.volumeError && std::abs(*level.volumeError) > 1e-4);
    EXPECT_THAT(remarks.text, HasSubstr("the volume of level 0 is out of reach"));
    EXPECT_TRUE(missed);
    remarks.text.clear();
    levelsOf(plateSolid(), {.levels = StepRange{0, 2}, .preserveVolume = true}, remarks.progress());
    EXPECT_EQ(remarks.text.find("out of reach"), std::string::npos) << remarks.text;
}

// One remark, by the first of those that are more than 10 % off; none by a ladder that ends before it.
TEST(Levels, SayWhichIsTheFirstFarFromTheVolume) {
    const auto isFar = [](const LevelReport& l) {
        return l.step != 0 && std::abs(l.volumeError.value_or(0)) > 0.1;
    };
    Remarks remarks;
    const auto levels =
        levelsOf(wallSolid(), {.levels = StepRange{0, 3}, .hold = Holding::none}, remarks.progress());
    const auto first = std::find_if(levels.begin(), levels.end(), isFar);
    ASSERT_NE(first, levels.end()) << "the wall is torn or gone";
    ASSERT_GT(*first->level, 1);
    const auto told = remarks.text.find("% less than level 0's, beyond 10 %");
    EXPECT_THAT(remarks.text, HasSubstr("level " + std::to_string(*first->level) + ": "));
    ASSERT_NE(told, std::string::npos) << remarks.text;
    EXPECT_EQ(remarks.text.find("beyond 10 %", told + 50), std::string::npos) << remarks.text;
    remarks.text.clear();
    levelsOf(wallSolid(), {.levels = StepRange{0, *first->level - 1}, .hold = Holding::none},
             remarks.progress());
    EXPECT_EQ(remarks.text.find("beyond 10 %"), std::string::npos) << remarks.text;
}

// After a gain that was told of, too: the last levels of a solid often swell before they are a splinter.
TEST(Levels, SayWhenMostOfTheSolidIsGone) {
    const auto isGone = [](const LevelReport& l) {
        return l.step != 0 && !l.vanished() && l.volumeError.value_or(0) < -0.5;
    };
    Remarks remarks;
    const auto levels = levelsOf(wallSolid(), {.hold = Holding::none}, remarks.progress());
    const auto gone = std::find_if(levels.begin(), levels.end(), isGone);
    ASSERT_NE(gone, levels.end());
    const std::string said = "level " + std::to_string(*gone->level) + ": its volume is ";
    EXPECT_THAT(remarks.text, HasSubstr(said));
    const auto told = remarks.text.find("most of the solid is gone");
    ASSERT_NE(told, std::string::npos) << remarks.text;
    EXPECT_EQ(remarks.text.find("most of the solid is gone", told + 1), std::string::npos) << remarks.text;
}

TEST(Levels, KeepThinWallsWhenAsked) {
    const auto torn = levelsOf(wallSolid(), {.levels = StepRange{0, 2}, .hold = Holding::none}),
               kept = levelsOf(wallSolid(), {.levels = StepRange{0, 2}, .hold = Holding::shift});
    EXPECT_EQ(torn[0].topology.genus, 0);
    EXPECT_GT(torn[2].topology.genus, 0) << "the wall is torn or gone";
    EXPECT_LT(torn[2].thinKept, 0.9);
    EXPECT_EQ(torn[2].thinKept, torn[2].thinKeptAtIso0);
    for (std::size_t i = 1; i <= 2; ++i) {
        EXPECT_GE(kept[i].thinKept, 0.95) << i;
        EXPECT_LE(kept[i].topology.genus, 1) << i;
        EXPECT_EQ(kept[i].topology.parts, 1) << i;
        EXPECT_GE(kept[i].isoShift, 0) << i;
        EXPECT_EQ(kept[i].thinKeptAtIso0, torn[i].thinKept) << i;
    }
    EXPECT_GT(kept[2].isoDistance, 0);
    EXPECT_LT(kept[2].isoDistance, 0.5 * kept[2].spacing[0]);
}

TEST(Levels, AreTheSameAloneAsInALadder) {
    LevelOptions volume, thin, specks;
    volume.preserveVolume = specks.keepSpecks = true;
    thin.hold = Holding::shift;
    for (LevelOptions options : {volume, thin, specks}) {
        const Level alone = makeLevel(wallSolid(), 6, options);
        options.levels = StepRange{0, 2};
        const Ladder ladder = makeLadder(wallSolid(), options);
        EXPECT_EQ(alone.mesh.points, ladder.levels[2].mesh.points);
        EXPECT_EQ(alone.mesh.triangles, ladder.levels[2].mesh.triangles);
        EXPECT_EQ(alone.report.isoShift, ladder.levels[2].report.isoShift);
    }
}

TEST(Levels, AreTheZeroSetsOfTheirFields) {
    const Level level = makeLevel(wallSolid(), 6);
    const Field field = makeLevelField(wallSolid(), 6);
    const MeshTopology held = topologyOf(field.polygonize({.refine = level.report.refine})),
                       plain =
                           topologyOf(fieldOf(wallSolid(), 6).polygonize({.refine = level.report.refine}));
    EXPECT_EQ(held.genus, level.report.topology.genus);
    EXPECT_EQ(held.parts, level.report.topology.parts);
    EXPECT_NEAR(held.volume, level.report.topology.volume, 0.02 * held.volume) << "collapsed";
    EXPECT_GT(plain.genus, held.genus) << "torn";
    EXPECT_THROW(makeLevelField(wallSolid(), 6, {.hold = Holding::shift}), UsageError);
    EXPECT_THROW(makeLevelField(wallSolid(), 6, {.preserveVolume = true}), UsageError);
}

TEST(Levels, RefuseTwoReasonsForOneIsoValue) {
    EXPECT_THROW(makeLadder(wallSolid(), {.hold = Holding::shift, .preserveVolume = true}), UsageError);
    const Image wall = distanceImage({62, 62, 36}, framedWall);
    EXPECT_THROW(makeLadder(open(wall, {.iso = 0, .openBorder = true}), {.preserveVolume = true}),
                 UsageError);
    for (const LevelOptions& limits : {LevelOptions{.maxGenus = 0}, LevelOptions{.maxParts = 1}})
        EXPECT_THROW(makeLadder(open(wall, {.iso = 0, .openBorder = true}), limits), UsageError);
    EXPECT_THROW(makeLadder(wallSolid(), {.levels = StepRange{}, .steps = StepRange{}}), UsageError);
}

TEST(Levels, LoseSpecksUnlessTheyAreToBeKept) {
    const auto clean = levelsOf(plateSolid(), {.steps = StepRange{0, 4}}),
               all = levelsOf(plateSolid(), {.steps = StepRange{0, 4}, .keepSpecks = true});
    EXPECT_EQ(clean[0].topology.parts, 2) << "a grain of the input is data";
    EXPECT_EQ(clean[0].specksRemoved, 0);
    bool removed = false;
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const LevelReport &c = clean[i], &a = all[i];
        EXPECT_EQ(a.specksRemoved, 0);
        EXPECT_EQ(a.topology.parts, c.topology.parts + c.specksRemoved) << i;
        EXPECT_EQ(a.topology.cavities, c.topology.cavities + c.bubblesRemoved) << i;
        EXPECT_NEAR(a.topology.volume, c.topology.volume + c.speckVolume - c.bubbleVolume, 1e-9);
        if (c.specksRemoved > 0) {
            EXPECT_LT(c.speckVolume / static_cast<double>(c.specksRemoved),
                      c.spacing[0] * c.spacing[1] * c.spacing[2]);
            removed = true;
        }
        expectSound(c.topology);
    }
    EXPECT_TRUE(removed) << "the grain becomes smaller than a node at some step";
}

TEST(Levels, TellWhatBecameOfHolesAndParts) {
    const auto levels = levelsOf(plateSolid(), {.levels = StepRange{0, 3}, .features = true});
    const FeatureReport& f0 = *levels[0].features;
    EXPECT_EQ(f0.handles.survived, 4);
    EXPECT_EQ(f0.parts.survived, 2);
    EXPECT_NEAR(*f0.handles.smallestSurviving, 0.5 * 1.5, 0.4);
    EXPECT_EQ(f0.handles.largestVanished, std::nullopt);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const LevelReport& level = levels[i];
        const SolidCounts now = countsOf(level.topology), before = countsOf(levels[i - 1].topology);
        const FeatureFate &holes = level.features->handles, &parts = level.features->parts;
        EXPECT_EQ(holes.survived + holes.vanished + holes.torn, 4) << i;
        EXPECT_EQ(level.change.handles, now.handles - before.handles);
        EXPECT_EQ(level.change.parts, now.parts - before.parts);
        // Components and handles never rise by more than what is explained.
        EXPECT_LE(now.handles, holes.survived + holes.more);
        EXPECT_LE(now.parts, parts.survived + parts.more);
        if (i <= 2) {
            EXPECT_EQ(holes.more, 0) << i;
            EXPECT_EQ(parts.more, 0) << i;
        }
    }
    const std::string story = tools::storyText(levels[2], " mm");
    EXPECT_THAT(story, HasSubstr("level 2 (2 mm): "));
    EXPECT_THAT(story, HasSubstr("holes closed up to radius"));
    EXPECT_FALSE(levelsOf(plateSolid(), {.levels = StepRange{0, 1}})[1].features);
}

// The rule of docs/topology.md: of what a level has beyond the level before, a finer lattice does not find what the
// mesh's sampling adds; what is left is torn, so that something thin is lost. Returns how many were explained.
std::int64_t explainedBySampling(const std::vector<LevelReport>& levels, const std::string& what) {
    std::int64_t explained = 0;
    for (const LevelReport& level : levels) {
        const SolidCounts counts = countsOf(level.topology), &change = level.change;
        const bool more = change.parts > 0 || change.handles > 0 || change.cavities > 0;
        EXPECT_EQ(level.sampling.has_value(), more) << what << level.step;
        if (!level.sampling) continue;
        EXPECT_GT(level.sampling->refine, level.refine);
        for (const auto kind : {&SolidCounts::parts, &SolidCounts::handles, &SolidCounts::cavities}) {
            const std::int64_t now = counts.*kind, before = now - change.*kind,
                               finer = level.sampling->counts.*kind;
            if (now <= before) continue;
            explained += std::clamp<std::int64_t>(now - finer, 0, now - before);
            if (finer > before) {
                // Parts that grow together may close a ring: a handle for nothing that is lost.
                const bool joined = kind == &SolidCounts::handles && change.parts < 0;
                if (joined) continue;
                EXPECT_LT(level.sampling->thinKept, 1.0)
                    << what << level.step << ": " << finer - before << " of unknown origin";
            }
        }
    }
    return explained;
}

TEST(Levels, OfRealSolidsRiseOnlyBySamplingAndTearing) {
    const auto explained = [](const std::string& file, const SolidOptions& options,
                              const LevelOptions& levels) {
        return explainedBySampling(levelsOf(realSolid(file, options), levels), file + " ");
    };
    const LevelOptions all{.hold = Holding::none}, steps{.steps = StepRange{0, 9}, .hold = Holding::none};
    std::int64_t sum = explained("ct/cranium_crop.nrrd", {.iso = 300}, all);
    sum += explained("meshes/pinion.off", {.voxels = 64}, all);
    sum += explained("meshes/gearwheel.bin.stl", {.voxels = 64}, steps);
    sum += explained("meshes/bones.off", {.voxels = 64}, steps);
    EXPECT_GT(sum, 0);
}

// Whatever is thin, and whatever a plain level tears: from level to level nothing becomes more.
TEST(Levels, ThatHoldNeverRise) {
    for (const auto& [file, options] :
         {std::pair<std::string, SolidOptions>{"ct/cranium_crop.nrrd", {.iso = 300}},
          {"meshes/pinion.off", {.voxels = 64}},
          {"meshes/couplingdown.off", {.voxels = 64}},
          {"meshes/gearwheel.bin.stl", {.voxels = 64}},
          {"meshes/gearwheel.bin.stl", {.voxels = 96}}}) {  // a handle at level 2 goes as a ball only
        const auto levels = levelsOf(realSolid(file, options), {.levels = StepRange{0, 3}});
        for (const LevelReport& level : levels) {
            EXPECT_LE(level.change.parts, 0) << file << level.step;
            EXPECT_LE(level.change.handles, 0) << file << level.step;
            EXPECT_LE(level.change.cavities, 0) << file << level.step;
            EXPECT_FALSE(level.limitsMissed) << file << level.step << *level.limitsMissed;
            EXPECT_GE(level.thinKept.value_or(1), 0.995) << file << level.step;
            expectSound(level.topology, file);
        }
    }
}

TEST(Levels, OfAThinWallHold) {
    const auto plain = levelsOf(wallSolid(), {.levels = StepRange{0, 2}, .hold = Holding::none}),
               held = levelsOf(wallSolid(), {.levels = StepRange{0, 2}});
    EXPECT_LT(plain[2].thinKept, 0.9);
    for (std::size_t i = 1; i <= 2; ++i) {
        EXPECT_EQ(countsOf(held[i].topology), countsOf(held[0].topology)) << i;
        EXPECT_EQ(held[i].thinKept, 1) << i;
        ASSERT_TRUE(held[i].hold);
        EXPECT_EQ(held[i].hold->inside, held[i].hold->samples);
        EXPECT_LE(held[i].topology.triangles, 1.3 * static_cast<double>(held[i - 1].topology.triangles) / 3);
    }
}

TEST(Levels, SayHowThickTheWallsAre) {
    const Image image = imageOf({48, 48, 48}, [](int x, int y, int z) {
        return -100 *
               std::max({std::abs(x - 23.7) - 2.5, std::abs(y - 24.0) - 15.2, std::abs(z - 24.0) - 15.2});
    });
    const auto levels = levelsOf(open(image, {.iso = 0}), {.levels = StepRange{0, 1}});
    ASSERT_EQ(levels[0].walls.size(), 3u);
    for (const WallThickness& wall : levels[0].walls) EXPECT_GE(wall.voxels, 4.5) << wall.share;
    EXPECT_NEAR(levels[0].walls[1].voxels, 5, 0.1);  // a plate 5 voxels thick
    EXPECT_NEAR(levels[0].walls[1].world, 5, 0.1);
    EXPECT_EQ(levels[0].walls[1].heldUpTo, 4);  // voxels of 16: a quarter of one is less than 5 / 0.9
    EXPECT_TRUE(levels[1].walls.empty());
}

// Voxels of 1 x 1 x 4: of two plates, the one that is 5 thick along x is thicker in voxels and thinner in the world than the one of 3 voxels
// along z.
TEST(Levels, SortTheWallsByEachUnitOnItsOwn) {
    Image image = imageOf({40, 40, 30}, [](int x, int y, int z) {
        const double upright =
            std::max({std::abs(x - 8.3) - 2.5, std::abs(y - 20.0) - 15.2, std::abs(z - 15.0) - 11.2});
        const double lying =
            std::max({std::abs(x - 26.3) - 9.2, std::abs(y - 20.0) - 15.2, std::abs(z - 15.2) - 1.5});
        return -100 * std::min(upright, lying);
    });
    image.indexToWorld.axis[2][2] = 4;
    const auto levels = levelsOf(open(image, {.iso = 0}), {.levels = StepRange{0, 0}});
    const std::vector<WallThickness>& walls = levels[0].walls;
    ASSERT_EQ(walls.size(), 3u);
    for (std::size_t i = 1; i < 3; ++i) {
        EXPECT_LE(walls[i - 1].voxels, walls[i].voxels);
        EXPECT_LE(walls[i - 1].world, walls[i].world);
    }
    EXPECT_NEAR(walls[0].voxels, 3, 0.3);
    EXPECT_NEAR(walls[0].world, 5, 0.5);
}

// The spline bridges a slit of a third of a voxel at places.
TEST(Levels, HaveNoHandleAtLevel0ThatTheInputHasNot) {
    const auto level0 = [](Holding hold, const Progress& progress) {
        return levelsOf(open(slitMesh(), {.voxel = 1}),
                        {.levels = StepRange{0, 0}, .refine = 4, .hold = hold}, progress)[0];
    };
    const LevelReport plain = level0(Holding::none, {});
    EXPECT_GT(plain.topology.genus, 0);
    EXPECT_TRUE(plain.edits.empty());
    Remarks remarks;
    const LevelReport mended = level0(Holding::local, remarks.progress());
    EXPECT_EQ(countsOf(mended.topology), (SolidCounts{1, 0, 0}));
    EXPECT_EQ(std::int64_t(mended.edits.size()), plain.topology.genus);
    EXPECT_NEAR(mended.topology.volume, plain.topology.volume, 2);  // of 1685
    EXPECT_THAT(remarks.text, HasSubstr("level 0: 2 cuts and fills (0.741 of volume) made, so "));
}

// A solid without anything thin is drawn as the plain level, to the bit.
TEST(Levels, WithNothingThinAreThePlainOnes) {
    const auto ball = [](Holding hold) {
        const Image image = imageOf(
            {64, 64, 64}, [](int x, int y, int z) { return 24 - std::hypot(x - 31.7, y - 32.2, z - 31.9); });
        return makeLadder(open(image, {.iso = 0}), {.levels = StepRange{0, 1}, .hold = hold});
    };
    const Ladder held = ball(Holding::local), plain = ball(Holding::none);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_FALSE(held.levels[i].report.hold);
        EXPECT_EQ(held.levels[i].mesh.points, plain.levels[i].mesh.points) << i;
        EXPECT_EQ(held.levels[i].mesh.triangles, plain.levels[i].mesh.triangles) << i;
    }
}

// Sums of cosines: holes, necks and cavities of many sizes, with 3 voxels of background around them.
Image waves(std::uint64_t seed) {
    constexpr int kSide = 40, kWaves = 24, kBackground = 3;
    std::uint64_t state = seed * 2654435761u + 12345;
    const auto next = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 33) / (1u << 31);
    };
    struct Wave {
        std::array<int, 3> k;
        double phase;
    };
    std::vector<Wave> all(kWaves);
    for (Wave& w : all) {
        for (int& k : w.k) k = static_cast<int>(next() * 9) - 4;
        w.phase = next() * 2 * std::numbers::pi;
    }
    return imageOf({kSide, kSide, kSide}, [&](int x, int y, int z) {
        for (const int c : {x, y, z})
            if (std::min(c, kSide - 1 - c) < kBackground) return -5.0;
        double sum = 0;
        for (const Wave& w : all)
            sum += std::cos(2 * std::numbers::pi * (w.k[0] * x + w.k[1] * y + w.k[2] * z) / kSide + w.phase);
        return sum;
    });
}

// Level 1 limits level 2, be it asked for or not. Limited by level 0 alone this solid's is another mesh.
TEST(Levels, AreTheSameWhateverIsAskedForBesideThem) {
    const auto solid = [] { return open(waves(0), {.iso = 1}); };
    const Level all = makeLadder(solid(), {.levels = StepRange{0, 2}}).levels.at(2),
                alone = makeLadder(solid(), {.levels = StepRange{2, 2}}).levels.at(0),
                mesh = makeLevel(solid(), 6);
    EXPECT_EQ(alone.mesh.points, all.mesh.points);
    EXPECT_EQ(alone.mesh.triangles, all.mesh.triangles);
    EXPECT_EQ(mesh.mesh.points, all.mesh.points);
    EXPECT_EQ(mesh.mesh.triangles, all.mesh.triangles);
}

// A solid of the zoo as a mask of -1 and 1, 4 voxels of background around it.
Image maskOf(const zoo::Solid& solid) {
    const openvdb::Coord low = solid.box.min().offsetBy(-4), dim = solid.box.dim().offsetBy(8);
    return imageOf({dim.x(), dim.y(), dim.z()}, [&](int x, int y, int z) {
        const openvdb::Coord c = low.offsetBy(x, y, z);
        return solid.box.isInside(c) && solid.inside(c) ? 1 : -1;
    });
}

TEST(Levels, OfTheZooRiseOnlyBySamplingAndTearing) {
    std::int64_t explained = 0;
    int solids = 0;
    for (const auto& group :
         {zoo::smoothSolids(), zoo::cadSolids(), zoo::thinSolids(), zoo::noisySolids(), zoo::borderSolids()})
        for (const zoo::Solid& solid : group) {
            explained += explainedBySampling(
                levelsOf(open(maskOf(solid), {.iso = 0}), {.hold = Holding::none}), solid.name + " ");
            ++solids;
        }
    EXPECT_GE(solids, 12);
    EXPECT_GE(explained, 0);
}

TEST(Levels, SayHowMuchOfARiseIsSampling) {
    EXPECT_FALSE(levelsOf(wallSolid(), {.levels = StepRange{0, 1}})[0].sampling);
    EXPECT_FALSE(levelsOf(plateSolid(), {.levels = StepRange{0, 1}})[1].sampling) << "nothing rises";
    // A second run at that refinement has the same counts.
    const auto pinion = [](int refine) {
        return levelsOf(realSolid("meshes/pinion.off", {.voxels = 64}),
                        {.levels = StepRange{3, 3}, .refine = refine, .hold = Holding::none})[0];
    };
    const LevelReport level = pinion(1), fine = pinion(4);
    EXPECT_EQ(level.change.handles, 5);
    ASSERT_TRUE(level.sampling);
    EXPECT_EQ(level.refine, 1);
    EXPECT_EQ(level.sampling->refine, 4) << "the lattice is doubled as long as something of the rise is left";
    EXPECT_THAT(tools::storyText(level, ""),
                HasSubstr("4 of 5 new handles are the mesh's sampling, --refine 4 has 2"));
    EXPECT_EQ(level.sampling->counts, countsOf(fine.topology));
    EXPECT_EQ(fine.refine, 4);
    EXPECT_FALSE(fine.sampling);
}

TEST(Levels, AreSampledFinerWhereTheMeshPerforatesThinWalls) {
    const auto levels = levelsOf(realSolid("meshes/pinion.off", {.voxels = 64}),
                                 {.levels = StepRange{0, 3}, .hold = Holding::shift});
    const int refine[] = {1, 1, 1, 2};
    for (std::size_t i = 0; i <= 3; ++i) {
        EXPECT_EQ(levels[i].refine, refine[i]) << i;
        EXPECT_LE(levels[i].topology.genus, 2) << i;
    }
    EXPECT_EQ(makeLevel(realSolid("meshes/pinion.off", {.voxels = 64}), 9, {.hold = Holding::shift})
                  .report.topology.triangles,
              levels[3].topology.triangles);
}

TEST(Levels, OfAPyramidAreToldWithoutMeshes) {
    const auto levels = levelsOf(plateSolid());
    const auto told = describeLevels(analyse(plateSolid()));
    ASSERT_GE(told.size(), 3u);
    for (std::size_t i = 0; i < told.size(); ++i) {
        EXPECT_EQ(told[i].level, levels[i].level);
        EXPECT_EQ(told[i].spacing, levels[i].spacing);
        EXPECT_EQ(countsOf(told[i].topology), countsOf(levels[i].topology));
        EXPECT_EQ(told[i].change, levels[i].change);
        EXPECT_EQ(told[i].topology.triangles, levels[i].topology.triangles);
        EXPECT_EQ(told[i].specksRemoved, levels[i].specksRemoved);
    }
    EXPECT_THAT(tools::storyText(told[0], " mm"), HasSubstr("level 0 (0.5 mm): 4 handles, 2 parts"));
}

}  // namespace
}  // namespace isowave::lod_test
