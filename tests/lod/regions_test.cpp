// Levels that keep a finer level in regions (LevelOptions::fine).
#include <tbb/global_control.h>

#include <map>
#include <set>

#include "lod/regions/fine_regions.h"
#include "polygonize/clip.h"
#include "polygonize/knot_insertion.h"
#include "tests/lod/solids.h"
#include "tests/zoo/zoo.h"
#include "wavelets/pyramid.h"

namespace isowave::lod_test {
namespace {

using lod::FineRegions;
using testing::HasSubstr;

// A box 44 x 44 x 10 voxels with four holes of radius 1.5, 2.5, 4 and 6 through it; world units are half a voxel.
double plate(double x, double y, double z) {
    const double radius[] = {1.5, 2.5, 4, 6};
    double d = std::max({std::abs(x - 27.3) - 22.2, std::abs(y - 27.4) - 22.1, std::abs(z - 12.2) - 5.1});
    for (int i = 0; i < 4; ++i)
        d = std::max(d, radius[i] - std::hypot(x - 16.6 - 21.7 * (i % 2), y - 16.1 - 22.3 * (i / 2)));
    return d;
}
Solid plateSolid() { return open(distanceImage({56, 56, 26}, plate), {.iso = 0}); }
// Around the hole of radius 2.5, in the middle of which x = 38.3, y = 16.1 voxels.
constexpr RegionBox kHole{{16.8, 5.7, 0}, {21.4, 10.3, 13}};
constexpr RegionBox kEverything{{-100, -100, -100}, {200, 200, 200}};

LevelOptions keeping(std::vector<FineRegion> regions, StepRange levels = {0, 3}) {
    return {.levels = levels, .fine = std::move(regions)};
}
FineRegion boxRegion(const RegionBox& box, int level = 0, double within = 0) { return {box, level, within}; }

bool isIn(const RegionBox& box, const Point& p) {
    for (std::size_t a = 0; a < 3; ++a)
        if (p[a] < box.low[a] || p[a] > box.high[a]) return false;
    return true;
}

using Corners = std::array<Point, 3>;
// From the least corner on, so that the same triangle is the same wherever its list begins.
Corners cornersOf(const TriangleMesh& mesh, const Triangle& t) {
    Corners corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
}
std::set<Corners> trianglesIn(const RegionBox& box, const TriangleMesh& mesh) {
    std::set<Corners> found;
    for (const Triangle& t : mesh.triangles) {
        const Corners corners = cornersOf(mesh, t);
        if (std::all_of(corners.begin(), corners.end(), [&](const Point& p) { return isIn(box, p); }))
            found.insert(corners);
    }
    return found;
}

// What is left of a mesh in a box. The cut has no pinches (clipToBox()), so that each border point has two border edges.
struct Cut {
    std::int64_t pieces = 0, loops = 0, euler = 0;
    std::int64_t handles() const { return pieces - (euler + loops) / 2; }
    friend bool operator==(const Cut&, const Cut&) = default;
};
Cut cutOf(const RegionBox& box, const TriangleMesh& mesh) {
    const auto vec = [](const Point& p) { return openvdb::Vec3d(p[0], p[1], p[2]); };
    const TriangleMesh part = clipToBox(mesh, openvdb::Mat4d::identity(), vec(box.low), vec(box.high));
    std::map<std::uint32_t, std::uint32_t> next;  // along borders
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : part.triangles)
        for (int k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
    std::int64_t count = 0;
    for (const auto& [a, b] : edges) {
        const bool isBorder = !edges.contains({b, a});
        count += isBorder || a < b;
        if (isBorder) next[a] = b;
    }
    Cut cut;
    while (!next.empty()) {
        ++cut.loops;
        for (auto at = next.begin(); at != next.end();) {
            const std::uint32_t to = at->second;
            next.erase(at);
            at = next.find(to);
        }
    }
    cut.pieces = topologyOf(part).components;
    cut.euler = static_cast<std::int64_t>(part.points.size() + part.triangles.size()) - count;
    return cut;
}
const Cut kOpenHole{1, 2, 0}, kClosedHole{2, 2, 2};  // a tube; two disks

void expectWhole(const TriangleMesh& mesh) {
    expectSound(topologyOf(mesh));
    EXPECT_EQ(countSelfIntersections(mesh), 0);
}

// ---- the blend

// The field of a ball about (24, 24, 24) with a dent, and that of its level 2.
struct Pair {
    BSplineField fine, coarse;
    Pair() {
        const auto distance = [](const openvdb::Vec3d& p) {
            const double dent = 6 - (p - openvdb::Vec3d(24 + 17, 24, 24)).length();
            return std::max((p - openvdb::Vec3d(24)).length() - 17, dent);
        };
        zoo::Solid solid;
        solid.box = {openvdb::Coord(0), openvdb::Coord(48)};
        solid.distance = distance;
        fine = zoo::distanceField(solid);
        coarse = wavelets::analyse(fine, {.maxSteps = 6}).field(6);
    }
};

lod::Blend blended(const Pair& fields, const RegionBox& box, double width) {
    const auto& lattice = fields.fine.transform();
    auto region = std::make_shared<const lod::ShapeDistance>(lod::regionShapeOf(boxRegion(box), {}),
                                                             lattice.copy(), Progress{});
    lod::FadeWeights weights(lod::Fade({lod::fading(region, lattice, width)}, lattice), lattice);
    return lod::blend(insertKnots(insertKnots(fields.coarse)), fields.fine, weights, {});
}

TEST(Fade, IsTheFinerLevelInTheRegionAndTheCoarserFarFromIt) {
    const Pair fields;
    const RegionBox box{{30, 15, 15}, {54, 33, 33}};
    ASSERT_LT(evaluate(fields.fine, openvdb::Vec3d(24, 24, 24)), 0);
    ASSERT_GT(evaluate(fields.fine, openvdb::Vec3d(39, 24, 24)), 0);
    const BSplineField field = blended(fields, box, 4).field;
    const double reach = 4 + 4 * std::sqrt(3.0);  // width + 2 margin
    int inside = 0, outside = 0;
    double between = 0;
    for (int x = 4; x <= 44; ++x)
        for (int y = 4; y <= 44; ++y)
            for (int z = 4; z <= 44; z += 3) {
                const openvdb::Vec3d p(x + 0.37, y + 0.61, z + 0.13);
                const double fine = evaluate(fields.fine, p), coarse = evaluate(fields.coarse, p / 4);
                const double now = evaluate(field, p);
                const double beyond =
                    std::max({30 - p.x(), std::abs(p.y() - 24) - 9, std::abs(p.z() - 24) - 9});
                if (beyond <= 0) {
                    EXPECT_EQ(now, fine) << p;
                    ++inside;
                } else if (beyond > reach) {
                    EXPECT_NEAR(now, coarse, 2e-6 * field.K) << p;  // float32 of the inserted control points
                    ++outside;
                } else {
                    between = std::max(between, std::abs(now - coarse));
                }
            }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(outside, 1000);
    EXPECT_GT(between, 0.01 * field.K);
}

// b = w f + (1 - w) P c with w = t^2 (3 - 2 t), computed anew from the distance to a half-space.
TEST(Fade, WeighsBothFieldsByASmoothStep) {
    const Pair fields;
    const BSplineField inserted = insertKnots(insertKnots(fields.coarse));
    const BSplineField field = blended(fields, {{26, -99, -99}, {99, 99, 99}}, 6).field;
    const auto value = [](const BSplineField& f, const openvdb::Coord& p) {
        return double(f.controlPoints->tree().getValue(p));
    };
    for (int x = 12; x <= 36; ++x)
        for (int y = 6; y <= 42; ++y) {
            const openvdb::Coord p(x, y, 29);
            const double t = std::clamp(1 - (26 - x - 2 * std::sqrt(3.0)) / 6, 0.0, 1.0),
                         w = t * t * (3 - 2 * t);
            EXPECT_NEAR(value(field, p), w * value(fields.fine, p) + (1 - w) * value(inserted, p),
                        1e-6 * field.K)
                << p;
        }
}

TEST(Fade, IsTheInsertedFieldToTheBitWhereNothingIsKept) {
    const Pair fields;
    const lod::Blend blend = blended(fields, {{60, 60, 60}, {70, 70, 70}}, 4);
    EXPECT_FALSE(blend.differs);
    EXPECT_EQ(blend.finePoints, 0);
    const BSplineField inserted = insertKnots(insertKnots(fields.coarse));
    for (auto it = inserted.controlPoints->cbeginValueOn(); it; ++it)
        ASSERT_EQ(blend.field.controlPoints->tree().getValue(it.getCoord()), *it);
    EXPECT_EQ(blend.field.controlPointCount(), inserted.controlPointCount());
}

// ---- ladders

TEST(Regions, KeepAHoleThatTheLevelCloses) {
    const Ladder plain = makeLadder(plateSolid(), {.levels = StepRange{0, 3}});
    const Ladder kept = makeLadder(plateSolid(), keeping({boxRegion(kHole)}));
    ASSERT_EQ(kept.levels.size(), 4u);
    const TriangleMesh& level0 = plain.levels[0].mesh;
    ASSERT_EQ(plain.levels[0].report.refine, 1);
    ASSERT_EQ(cutOf(kHole, level0), kOpenHole);
    ASSERT_EQ(cutOf(kHole, plain.levels[3].mesh), kClosedHole);
    EXPECT_EQ(kept.levels[0].mesh.points, level0.points);
    const auto inBox = trianglesIn(kHole, level0);
    ASSERT_GT(inBox.size(), 500u);
    for (int level = 1; level <= 3; ++level) {
        const Level& l = kept.levels[static_cast<std::size_t>(level)];
        EXPECT_EQ(trianglesIn(kHole, l.mesh), inBox) << level;  // all of them, to the bit, and no other
        EXPECT_EQ(cutOf(kHole, l.mesh), kOpenHole) << level;
        expectWhole(l.mesh);
        ASSERT_TRUE(l.report.regions) << level;
        const RegionSummary& r = *l.report.regions;
        EXPECT_GE(r.trianglesInside, static_cast<std::int64_t>(inBox.size()));
        EXPECT_EQ(r.trianglesInside + r.trianglesFading + r.trianglesOutside, l.report.topology.triangles);
        // World units; seen 8e-5: a point made where details fade out may come to lie inside.
        EXPECT_LT(*r.maxInside, 1e-3);
        EXPECT_GT(*r.rmsOutside, 10 * *r.rmsInside);
        EXPECT_GT(r.finePoints, 1000);
        EXPECT_GT(r.coarsePoints, 0);
        EXPECT_LT(r.coarsePoints, plain.levels[static_cast<std::size_t>(level)].report.controlPoints);
    }
    EXPECT_GT(kept.levels[3].report.topology.genus, plain.levels[3].report.topology.genus);
    EXPECT_FALSE(kept.levels[0].report.regions);
}

// Beside the region a level has the plain one's triangles, about.
TEST(Regions, TrianglesFollowTheLocalLevel) {
    const Ladder plain = makeLadder(plateSolid(), {.levels = StepRange{0, 2}});
    const Ladder kept = makeLadder(plateSolid(), keeping({boxRegion(kHole)}, {0, 2}));
    const RegionBox far{{0, 17, 0}, {11, 28, 13}};
    for (const std::size_t level : {1u, 2u}) {
        const auto expected = trianglesIn(far, plain.levels[level].mesh).size();
        const auto found = trianglesIn(far, kept.levels[level].mesh).size();
        EXPECT_LT(found, 2 * expected) << level;
        EXPECT_GT(found, expected / 2) << level;
    }
}

TEST(Regions, WithoutSurfaceLeaveTheLevelAsItIs) {
    const Solid ring = open(ringMesh(), {.voxels = 40});
    const Ladder plain = makeLadder(ring, {.levels = StepRange{0, 2}});
    Remarks remarks;
    const Ladder kept =
        makeLadder(ring, keeping({boxRegion({{-1, -1, -1}, {1, 1, 1}})}, {0, 2}), {}, remarks.progress());
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(kept.levels[i].mesh.points, plain.levels[i].mesh.points) << i;
        EXPECT_EQ(kept.levels[i].mesh.triangles, plain.levels[i].mesh.triangles) << i;
        EXPECT_EQ(kept.levels[i].mesh.normals, plain.levels[i].mesh.normals) << i;
        EXPECT_FALSE(kept.levels[i].report.regions);
    }
    EXPECT_THAT(remarks.text, HasSubstr("nothing in the regions of --fine differs from a finer level"));
}

TEST(Regions, OfEverythingAreTheFinerLevelItself) {
    const Ladder kept = makeLadder(plateSolid(), keeping({boxRegion(kEverything)}, {0, 2}));
    EXPECT_EQ(kept.levels[2].mesh.points, kept.levels[0].mesh.points);
    EXPECT_EQ(kept.levels[2].mesh.triangles, kept.levels[0].mesh.triangles);
    EXPECT_EQ(kept.levels[2].report.regions->coarsePoints, 0);
    EXPECT_EQ(kept.levels[2].report.regions->trianglesFading, 0);
    EXPECT_FALSE(kept.levels[2].report.regions->maxOutside);
    // A level that is sampled twice, and collapsed, comes out the same, too; so does level 1 in level 2.
    const Solid ring = open(ringMesh(), {.voxels = 40});
    const Ladder whole = makeLadder(ring, keeping({boxRegion(kEverything, 1)}, {1, 2}));
    EXPECT_EQ(whole.levels[1].mesh.points, whole.levels[0].mesh.points);
    EXPECT_EQ(whole.levels[1].mesh.triangles, whole.levels[0].mesh.triangles);
}

TEST(Regions, LeaveLevelsUpToTheirOwnAsTheyAre) {
    const Ladder plain = makeLadder(plateSolid(), {.levels = StepRange{0, 2}});
    const Ladder kept = makeLadder(plateSolid(), keeping({boxRegion(kHole, 1, 0.5)}, {0, 2}));
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(kept.levels[i].mesh.points, plain.levels[i].mesh.points) << i;
    const auto inBox = trianglesIn(kHole, plain.levels[1].mesh);
    ASSERT_GT(inBox.size(), 50u);
    ASSERT_EQ(plain.levels[1].report.refine, 1);
    EXPECT_EQ(trianglesIn(kHole, kept.levels[2].mesh), inBox);
    expectWhole(kept.levels[2].mesh);
}

TEST(Regions, AreKeptWhereTheirLevelIsNotAskedFor) {
    const Ladder all = makeLadder(plateSolid(), keeping({boxRegion(kHole, 1)}, {0, 3}));
    const Ladder one = makeLadder(plateSolid(), keeping({boxRegion(kHole, 1)}, {3, 3}));
    ASSERT_EQ(one.levels.size(), 1u);
    EXPECT_EQ(trianglesIn(kHole, one.levels[0].mesh), trianglesIn(kHole, all.levels[3].mesh));
    const Level made = makeLevel(plateSolid(), 9, keeping({boxRegion(kHole, 1)}));
    EXPECT_EQ(made.mesh.points, one.levels[0].mesh.points);
}

TEST(Regions, TheFinestCountsWhereTheyOverlap) {
    const Ladder kept =
        makeLadder(plateSolid(), keeping({boxRegion(kEverything, 1), boxRegion(kHole)}, {0, 2}));
    EXPECT_EQ(trianglesIn(kHole, kept.levels[2].mesh), trianglesIn(kHole, kept.levels[0].mesh));
    expectWhole(kept.levels[2].mesh);
    EXPECT_EQ(kept.levels[2].report.regions->coarsePoints, 0);
    EXPECT_EQ(kept.levels[2].report.topology.genus, kept.levels[1].report.topology.genus);
}

TEST(Regions, OfAMeshAreWhatLiesInIt) {
    TriangleMesh ball = makeLevel(open(ballImage({24, 24, 24}, 8), {.iso = 0}), 0).mesh;
    ball.normals.clear();
    for (Point& p : ball.points)  // radius 4, about the middle of the hole of radius 4 voxels
        p = {(p[0] - 11.5) / 2 + 8.3, (p[1] - 11.5) / 2 + 19.2, (p[2] - 11.5) / 2 + 6.1};
    const Ladder kept = makeLadder(plateSolid(), keeping({{ball, 0, 0}}));
    const RegionBox inBall{{6, 16.9, 4.5}, {10.6, 21.5, 7.7}};  // its corners lie within 3.7 of the middle
    const auto inBox = trianglesIn(inBall, kept.levels[0].mesh);
    ASSERT_GT(inBox.size(), 100u);
    EXPECT_EQ(trianglesIn(inBall, kept.levels[3].mesh), inBox);
    expectWhole(kept.levels[3].mesh);
    // Inside out it is the same region.
    for (Triangle& t : ball.triangles) std::swap(t[0], t[1]);
    EXPECT_EQ(makeLadder(plateSolid(), keeping({{ball, 0, 0}})).levels[3].mesh.points,
              kept.levels[3].mesh.points);
}

// Numbers as large as they come are a region of everything.
TEST(Regions, MayReachAsFarAsNumbersGo) {
    const Solid ring = open(ringMesh(), {.voxels = 24});
    const Ladder whole = makeLadder(ring, keeping({boxRegion(kEverything)}, {0, 1}));
    for (const FineRegion& region : {boxRegion({{-1e300, -1e300, -1e300}, {1e300, 1e300, 1e300}}),
                                     boxRegion({{0, 0, 0}, {1, 1, 1}}, 0, 1e308)})
        EXPECT_EQ(makeLadder(ring, keeping({region}, {0, 1})).levels[1].mesh.points,
                  whole.levels[1].mesh.points);
}

// A turned coupling with holes, walls and a rim: half of it kept.
TEST(Regions, OfARealPartHaveTheHandlesOfLevel0) {
    const Solid part =
        open(std::filesystem::path(ISOWAVE_TEST_DATA) / "meshes/couplingdown.off", {.voxels = 64});
    const Ladder plain = makeLadder(part, {.levels = StepRange{0, 3}});
    PointBox bounds;
    for (const Point& p : plain.levels[0].mesh.points) bounds.add(p);
    RegionBox half{bounds.low, bounds.high};
    for (std::size_t a = 0; a < 3; ++a) half.low[a] -= 1, half.high[a] += 1;
    half.high[0] = bounds.low[0] + 0.47 * bounds.extent(0);
    const Ladder kept = makeLadder(part, keeping({boxRegion(half)}));
    const std::int64_t handles = cutOf(half, plain.levels[0].mesh).handles();
    EXPECT_GT(handles, cutOf(half, plain.levels[3].mesh).handles());  // or this test shows nothing
    for (std::size_t level = 1; level < kept.levels.size(); ++level) {
        SCOPED_TRACE(level);
        expectWhole(kept.levels[level].mesh);
        EXPECT_EQ(cutOf(half, kept.levels[level].mesh).handles(), handles);
        EXPECT_LT(*kept.levels[level].report.regions->rmsInside,
                  0.2 * *kept.levels[level].report.regions->rmsOutside);
    }
}

TEST(Regions, TheThreadsDoNotChangeABit) {
    const auto made = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return makeLadder(plateSolid(),
                          keeping({boxRegion(kHole), boxRegion({{15, 3, 0}, {19, 8, 13}}, 1)}, {2, 3}));
    };
    const Ladder one = made(1), four = made(4);
    for (std::size_t i = 0; i < one.levels.size(); ++i) {
        EXPECT_EQ(one.levels[i].mesh.points, four.levels[i].mesh.points);
        EXPECT_EQ(one.levels[i].mesh.triangles, four.levels[i].mesh.triangles);
        EXPECT_EQ(one.levels[i].mesh.normals, four.levels[i].mesh.normals);
    }
}

// ---- bad input

std::string complaintOf(const LevelOptions& options) {
    const Solid ring = open(ringMesh(), {.voxels = 24});
    try {
        makeLadder(ring, options);
    } catch (const InputError& error) {
        return std::string("input: ") + error.what();
    } catch (const UsageError& error) {
        return std::string("usage: ") + error.what();
    }
    return "nothing thrown";
}

TEST(Regions, RefuseWhatIsNone) {
    const auto complaint = [](const FineRegion& region) { return complaintOf(keeping({region}, {0, 2})); };
    EXPECT_THAT(complaint(boxRegion({{0, 0, 0}, {1, 0, 1}})),
                HasSubstr("usage: --fine 0,0,0:1,0,1: the box is empty, it has no extent along y"));
    EXPECT_THAT(complaint(boxRegion({{0, 0, 0}, {1, NAN, 1}})), HasSubstr("usage: --fine 0,0,0:1,nan,1"));
    EXPECT_THAT(complaint(boxRegion({{0, 0, 0}, {1, 1, INFINITY}})), HasSubstr("finite"));
    EXPECT_THAT(complaint(boxRegion(kEverything, 2)),
                HasSubstr("no level is coarser than 2, --levels ends at 2"));
    EXPECT_THAT(complaint(boxRegion(kEverything, -1)), HasSubstr("level -1 is less than 0"));
    EXPECT_THAT(complaint(boxRegion(kEverything, 0, NAN)), HasSubstr("usage: --fine-within: nan"));
    EXPECT_THAT(complaint(boxRegion(kEverything, 0, -1)), HasSubstr("usage: --fine-within: -1"));
    EXPECT_THAT(
        complaint(boxRegion({{90, 90, 90}, {99, 99, 99}})),
        HasSubstr(
            "input: --fine 90,90,90:99,99,99: the region is outside the solid, which lies between -27.9,"));
    TriangleMesh open = ringMesh();
    open.triangles.resize(open.triangles.size() - 40);
    EXPECT_THAT(complaint({open}), HasSubstr("input: the mesh of a region: is open"));
    TriangleMesh huge = ringMesh();
    for (Point& p : huge.points)
        for (double& x : p) x *= 1e4;
    EXPECT_THAT(complaint({huge}), HasSubstr("input: --fine a mesh: the mesh is"));
    EXPECT_THAT(complaint({std::filesystem::path("/nowhere/jaw.stl")}), HasSubstr("input: /nowhere/jaw.stl"));
    EXPECT_THAT(complaintOf({.fine = {boxRegion(kEverything, 40)}}),
                HasSubstr("no level is coarser than level 40"));
}

TEST(Regions, RefuseOptionsThatTheyDoNotGoWith) {
    const auto complaint = [](LevelOptions options) {
        options.fine = {boxRegion(kEverything)};
        return complaintOf(options);
    };
    EXPECT_THAT(complaint({.steps = StepRange{0, 3}}),
                HasSubstr("usage: --fine and --steps exclude each other"));
    EXPECT_THAT(complaint({.preserveVolume = true}), HasSubstr("usage: --fine and --preserve-volume"));
    EXPECT_THAT(complaint({.hold = Holding::shift}), HasSubstr("usage: --fine and --hold shift"));
    EXPECT_THAT(complaint({.refine = 2, .compact = true}), HasSubstr("usage: --fine and --compact"));
    EXPECT_THAT(complaint({.maxParts = 1}), HasSubstr("usage: --fine and --max-genus or --max-parts"));
    EXPECT_THROW(
        makeBudget(open(ringMesh(), {.voxels = 24}), {.triangles = {500}}, keeping({boxRegion(kEverything)})),
        UsageError);
    EXPECT_THROW(makeLevel(open(ringMesh(), {.voxels = 24}), 4, keeping({boxRegion(kEverything)})),
                 UsageError);
}

// Everything else that makes a level goes with regions.
TEST(Regions, GoWithWhatElseMakesALevel) {
    LevelOptions options = keeping({boxRegion(kHole)}, {2, 2});
    for (const Holding hold : {Holding::none, Holding::local})
        for (const std::optional<int> refine : {std::optional<int>{}, std::optional<int>{2}}) {
            options.hold = hold, options.refine = refine;
            options.features = options.deviation = options.refit = hold == Holding::local;
            options.relax = refine ? 2 : 0;
            const Ladder ladder = makeLadder(plateSolid(), options);
            expectSound(ladder.levels[0].report.topology);
            EXPECT_EQ(cutOf(kHole, ladder.levels[0].mesh), kOpenHole);
            EXPECT_EQ(ladder.levels[0].report.features.has_value(), options.features);
        }
    options.fine = {boxRegion({{4, 4, 0}, {9, 9, 13}})};
    const Ladder cut =
        makeLadder(open(distanceImage({30, 56, 26}, plate), {.iso = 0, .openBorder = true}), options);
    EXPECT_TRUE(cut.levels[0].report.topology.manifold());
    EXPECT_FALSE(cut.levels[0].report.topology.closed());
}

}  // namespace
}  // namespace isowave::lod_test
