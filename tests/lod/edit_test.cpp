// Edits: the volume of the tool, all else to the bit, a way back, and one line for what makes no sense.
#include <map>
#include <numbers>

#include "isowave/openvdb.h"
#include "lod/pyramid_state.h"
#include "tests/lod/solids.h"
#include "tests/temp_folder.h"
#include "tests/zoo/box.h"
#include "wavelets/exact.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;

TriangleMesh boxMesh(const Point& low, const Point& high) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.points.push_back(
            {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]});
    mesh.triangles.assign(zoo::kBoxTriangles.begin(), zoo::kBoxTriangles.end());
    return mesh;
}

void append(TriangleMesh& to, const TriangleMesh& more) {
    const auto first = static_cast<std::uint32_t>(to.points.size());
    to.points.insert(to.points.end(), more.points.begin(), more.points.end());
    for (const Triangle& t : more.triangles)
        to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// 40 x 36 x 20 voxels; its lettering is three ribs on the top, 1.5 voxels wide and high.
Pyramid plate() {
    TriangleMesh mesh = boxMesh({0, 0, 0}, {40, 36, 20});
    for (const double y : {4.0, 8.0, 12.0}) append(mesh, boxMesh({3, y, 19}, {37, y + 1.5, 21.5}));
    return analyse(open(mesh, {.voxel = 1}));
}
Pyramid ring() { return analyse(open(ringMesh(24, 11), {.voxel = 1})); }
// In the middle of 48^3 voxels of 0.5 mm, 9 mm large.
Pyramid imageBall() { return analyse(open(ballImage({48, 48, 48}, 18, 0.5), {.iso = 0})); }

double ballVolume(double r) { return 4.0 / 3 * std::numbers::pi * r * r * r; }

double change(const EditStory& edit) { return edit.volumeAfter - edit.volumeBefore; }

// Whether a lattice point's control point, sign and being known are the same in both.
bool sameAt(const BSplineField& a, const BSplineField& b, const openvdb::Coord& at) {
    float x = 0, y = 0;
    const bool inA = a.controlPoints->constTree().probeValue(at, x),
               inB = b.controlPoints->constTree().probeValue(at, y);
    return inA == inB && x == y && a.shape->constTree().getValue(at) == b.shape->constTree().getValue(at);
}

struct Elsewhere {
    std::int64_t same = 0, different = 0;
};
// Of the points known in either level 0 and for which `near` is false.
template <class Near>
Elsewhere elsewhere(const Pyramid& before, const Pyramid& after, const Near& near) {
    const BSplineField a = PyramidAccess::of(before).field(0), b = PyramidAccess::of(after).field(0);
    openvdb::MaskTree either(a.controlPoints->constTree(), false, openvdb::TopologyCopy());
    either.topologyUnion(b.controlPoints->constTree());
    Elsewhere result;
    for (auto point = either.cbeginValueOn(); point; ++point) {
        const openvdb::Vec3d world = a.transform().indexToWorld(point.getCoord());
        if (near(world)) continue;
        ++(sameAt(a, b, point.getCoord()) ? result.same : result.different);
    }
    return result;
}

// F' differs within the half-width of 4 voxels; control points two voxels farther.
auto nearBall(const Ball& ball, double voxel) {
    return [=](const openvdb::Vec3d& p) {
        return (p - openvdb::Vec3d(ball.centre.data())).length() < ball.radius + 6 * voxel;
    };
}

TEST(Edit, ChangesTheVolumeByTheTools) {
    struct Case {
        const char* name;
        Pyramid pyramid;
        Edit edit;
        double wanted;
    };
    const Ball inPlate{{20.3, 25.1, 9.7}, 6}, onPlate{{20.3, 25.1, 20}, 6}, inBall{{12, 12, 11}, 4};
    const RegionBox inRing{{18.2, -5.1, -5.3}, {29.1, 5.2, 5.4}};
    const Case cases[] = {
        {"a ball in the plate", plate(), EditCut{inPlate}, -ballVolume(6)},
        {"half a ball on the plate", plate(), EditAdd{onPlate}, ballVolume(6) / 2},
        {"half a ball off the plate", plate(), EditCut{onPlate}, -ballVolume(6) / 2},
        {"a box in the ring", ring(), EditCut{inRing}, -10.9 * 10.3 * 10.7},
        {"a mesh in the ring's hole", ring(), EditAdd{boxMesh({-5.1, -4.9, -5.2}, {5.3, 5.2, 4.8})},
         10.4 * 10.1 * 10},
        {"a ball in an image", imageBall(), EditCut{inBall}, -ballVolume(4)},
        {"a ball beside an image's", imageBall(), EditAdd{Ball{{12, 12, 26}, 3}}, ballVolume(3)}};
    for (const auto& [name, pyramid, what, wanted] : cases)
        for (const int level : {0, 1}) {
            const EditReport report =
                edit(pyramid, {what}, {.level = level, .checkSteps = level == 1}).report;
            EXPECT_NEAR(change(report.edits[0]) / wanted, 1, 0.02) << name << ", level " << level;
            EXPECT_EQ(report.closedSteps, report.checkedSteps) << name;
            EXPECT_TRUE(level == 0 || *report.closedSteps > 6) << name;
            std::printf("%s, level %d: %.5f\n", name, level, change(report.edits[0]) / wanted);
        }
}

TEST(Edit, LeavesEverythingElseToTheBit) {
    const Ball boss{{20.3, 25.1, 20}, 6};
    for (const Edit& what : {Edit(EditAdd{boss}), Edit(EditCut{boss})}) {
        const Pyramid before = plate();
        const EditedPyramid edited = edit(before, {what}, {.level = 1});
        const Elsewhere seen = elsewhere(before, edited.pyramid, nearBall(boss, 1));
        EXPECT_EQ(seen.different, 0);
        EXPECT_GT(seen.same, 10'000);
        EXPECT_GT(elsewhere(before, edited.pyramid, [](const auto&) { return false; }).different, 500);
        const EditedPyramid round = edit(before, {what}, {.level = 1, .blend = 7});
        EXPECT_EQ(elsewhere(before, round.pyramid, nearBall({boss.centre, boss.radius + 7 - 3}, 1)).different,
                  0);
        EXPECT_GT(elsewhere(before, round.pyramid, nearBall(boss, 1)).different, 0);
    }
}

double distanceTo(const RegionBox& box, const openvdb::Vec3d& p) {
    openvdb::Vec3d out;
    for (std::size_t axis = 0; axis < 3; ++axis)
        out[static_cast<int>(axis)] = std::max(
            {box.low[axis] - p[static_cast<int>(axis)], 0.0, p[static_cast<int>(axis)] - box.high[axis]});
    return out.length();
}

// How far from the tool a point's control point, sign or being known differs. distance: not above 0 in the tool.
template <class Distance>
double reachOfChange(const Pyramid& before, const Pyramid& after, const Distance& distance) {
    const BSplineField a = PyramidAccess::of(before).field(0), b = PyramidAccess::of(after).field(0);
    openvdb::MaskTree either(a.controlPoints->constTree(), false, openvdb::TopologyCopy());
    either.topologyUnion(b.controlPoints->constTree());
    double farthest = 0;
    for (auto point = either.cbeginValueOn(); point; ++point)
        if (!sameAt(a, b, point.getCoord()))
            farthest = std::max(farthest, distance(a.transform().indexToWorld(point.getCoord())));
    return farthest;
}

// Seen: 5.6 voxels where the half-width is 4, and R + 2.1 at a corner of the box on level 1's lattice.
TEST(Edit, ReachesNoFartherThanSixVoxelsOrTheFilletAndThree) {
    const RegionBox box{{11.2, 12.1, 14.3}, {24.1, 25.2, 29.4}};
    const Ball ball{{20.3, 25.1, 20}, 6};
    const Pyramid before = plate();
    const auto toBox = [&](const openvdb::Vec3d& p) { return distanceTo(box, p); };
    const auto toBall = [&](const openvdb::Vec3d& p) {
        return (p - openvdb::Vec3d(ball.centre.data())).length() - ball.radius;
    };
    for (const int level : {0, 1, 3})
        for (const double r : {0.0, 5.0})
            for (const bool cut : {false, true}) {
                const EditingOptions how{level, r > 0 ? std::optional(r) : std::nullopt};
                const auto made = [&](const EditTool& tool) {
                    return edit(before, {cut ? Edit(EditCut{tool}) : Edit(EditAdd{tool})}, how).pyramid;
                };
                const double ofBox = reachOfChange(before, made(box), toBox),
                             ofBall = reachOfChange(before, made(ball), toBall);
                std::printf("level %d, radius %g, %s: box %.3f, ball %.3f\n", level, r, cut ? "cut" : "add",
                            ofBox, ofBall);
                EXPECT_LE(ofBox, std::max(6.0, r + 3)) << level << ' ' << r << ' ' << cut;
                EXPECT_LE(ofBall, std::max(6.0, r + 3)) << level << ' ' << r << ' ' << cut;
                EXPECT_GT(ofBall, 3);
            }
}

TEST(Edit, KeepsTheBitsInAFile) {
    const test::TempFolder folder;
    const Ball boss{{20.3, 25.1, 20}, 6};
    const Pyramid before = plate();
    const EditedPyramid edited = edit(before, {EditAdd{boss}});
    edited.pyramid.save(folder / "new.pyramid.vdb");
    const Pyramid read = Pyramid::open(folder / "new.pyramid.vdb");
    EXPECT_TRUE(
        wavelets::areSame(PyramidAccess::of(read).field(0), PyramidAccess::of(edited.pyramid).field(0)));
    EXPECT_EQ(elsewhere(before, read, nearBall(boss, 1)).different, 0);
    EXPECT_EQ(read.source().at("edit.0"),
              "\"--add ball:20.3,25.1,20,6 --level 0\"");  // JSON, as all of a source
    EXPECT_EQ(read.source().count("input.volume"), 0U);
    // Of a pyramid without those control points the bits are others: the test can fail.
    wavelets::Pyramid without = PyramidAccess::of(read);
    without.exact = nullptr;
    EXPECT_GT(elsewhere(before, PyramidAccess::make(without), nearBall(boss, 1)).different, 0);
}

TEST(Edit, WithTheOldPyramidUndoesAll) {
    const Pyramid before = plate();
    const Pyramid edited =
        edit(before, {EditAdd{Ball{{20.3, 25.1, 20}, 6}}}, {.level = 1, .blend = 3}).pyramid;
    const EditedPyramid undone = edit(edited, {EditWith{before}});
    for (int step = 0; step <= before.stepCount(); ++step)
        EXPECT_TRUE(wavelets::areSame(PyramidAccess::of(before).field(step),
                                      PyramidAccess::of(undone.pyramid).field(step)))
            << step;
    EXPECT_GT(undone.report.edits[0].touched, 500);
    EXPECT_THROW(edit(undone.pyramid, {EditWith{before}}), InputError);
}

// The surface is where F is 0 on the way between two lattice points: F over its slope is how far it moves.
TEST(Edit, ACutOfWhatWasAddedBesideTheSolidGivesItsSurfaceBack) {
    const Ball beside{{20.3, 18.1, 33}, 5};
    const Pyramid before = plate();
    const EditedPyramid twice = edit(before, {EditAdd{beside}, EditCut{beside}});
    EXPECT_EQ(elsewhere(before, twice.pyramid, nearBall(beside, 1)).different, 0);
    const TriangleMesh a = before.field(0).polygonize(), b = twice.pyramid.field(0).polygonize();
    ASSERT_EQ(a.points.size(), b.points.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            largest = std::max(largest, std::abs(a.points[i][axis] - b.points[i][axis]));
    EXPECT_LT(largest, 1e-4);  // voxels
    EXPECT_EQ(twice.report.edits[1].partsAfter, 1);
}

TEST(Edit, LeavesNoGhostOfASurfaceThatItCoversOrTakesAway) {
    const RegionBox over{{-8, -8, 8}, {48, 24, 36}};  // all the ribs
    for (const Edit& what : {Edit(EditAdd{over}), Edit(EditCut{over})}) {
        const EditedPyramid edited = edit(plate(), {what}, {.checkSteps = true});
        const MeshTopology topology = topologyOf(edited.pyramid.field(0).polygonize({.refine = 2}));
        EXPECT_EQ(topology.components, 1);
        EXPECT_EQ(topology.genus, 0);
        EXPECT_EQ(edited.report.closedSteps, edited.report.checkedSteps);
        EXPECT_GT(edited.report.edits[0].forgotten, 1000);
    }
}

// Fillet of radius r: along an edge of length l (1 - pi/4) r^2 l; around the tool's four edges once a full turn,
// 2 pi (5/6 - pi/4) r^3 (Pappus).
TEST(Edit, BlendsWithAFilletOfThatRadius) {
    const RegionBox block{{12.2, 18.1, 15}, {28.3, 32.2, 34}};
    const double r = 3, along = 2 * (16.1 + 14.1), pi = std::numbers::pi;
    const Pyramid before = plate();
    const double sharp = change(edit(before, {EditAdd{block}}).report.edits[0]),
                 round =
                     change(edit(before, {EditAdd{block}}, {.blend = r, .checkSteps = true}).report.edits[0]),
                 wanted = (1 - pi / 4) * r * r * along + 2 * pi * (5.0 / 6 - pi / 4) * r * r * r;
    EXPECT_NEAR((round - sharp) / wanted, 1, 0.1);
    std::printf("fillet: %.4f of %.4f\n", round - sharp, wanted);
}

TEST(Edit, MovesAPartWithItsDetails) {
    TriangleMesh mesh = boxMesh({0, 0, 0}, {40, 36, 20});
    append(mesh, boxMesh({6, 6, 19}, {14, 14, 28}));
    append(mesh, boxMesh({7, 9, 27}, {13, 11, 30}));  // a rib on it
    const Pyramid before = analyse(open(mesh, {.voxel = 1}));
    const EditedPyramid moved =
        edit(before, {EditMove{{{3, 3, 20.01}, {17, 17, 34}}, {15.3, 12.6, 0}}}, {.checkSteps = true});
    EXPECT_NEAR(change(moved.report.edits[0]), 0, 0.02 * 8 * 8 * 8);
    std::printf("moved: %.4f\n", change(moved.report.edits[0]));
    EXPECT_EQ(moved.report.edits[0].partsAfter, 1);
    EXPECT_EQ(moved.report.closedSteps, moved.report.checkedSteps);
    EXPECT_GT(before.field(0).value({25.3, 22.6, 24}), 0);
    EXPECT_LT(moved.pyramid.field(0).value({25.3, 22.6, 24}), 0);
    EXPECT_LT(moved.pyramid.field(0).value({25.3, 22.6, 29.5}), 0);  // the rib
    EXPECT_GT(moved.pyramid.field(0).value({10, 10, 24}), 0);
}

// A bump in level 1's control points: the ribs on it ride along, and nothing else changes.
TEST(Edit, TakesALevelsControlPointsAndKeepsTheDetails) {
    const Pyramid before = plate();
    const Field level = before.field(kStepsPerLevel);
    const auto grid = gridOf(level)->deepCopy();
    const openvdb::Vec3d middle(20, 8, 20);
    for (auto point = grid->beginValueOn(); point; ++point) {
        const double d = (grid->transform().indexToWorld(point.getCoord()) - middle).length();
        if (d < 8)
            point.setValue(static_cast<float>(
                *point - 0.1 * level.K() * std::pow(std::cos(d / 8 * std::numbers::pi / 2), 2)));
    }
    auto signs = openvdb::BoolGrid::create(false);
    const EditedPyramid edited =
        edit(before, {EditWith{fieldOf(grid, signs, level.K())}}, {.level = 1, .checkSteps = true});
    EXPECT_GT(change(edited.report.edits[0]), 10);
    EXPECT_EQ(edited.report.closedSteps, edited.report.checkedSteps);
    const Elsewhere far = elsewhere(before, edited.pyramid, [&](const openvdb::Vec3d& p) {
        return (p - middle).length() < 8 + 2 * 2 * std::sqrt(3.0);
    });
    EXPECT_EQ(far.different, 0);
    EXPECT_GT(far.same, 10'000);
    // Between ribs and on them, seen from above: the ribs are as high as they were.
    const auto height = [](const Field& field, double y) {
        double z = 18;
        while (field.value({20, y, z}) < 0) z += 0.01;
        return z;
    };
    const double rib = height(before.field(0), 8.75) - height(before.field(0), 10.75),
                 ribAfter = height(edited.pyramid.field(0), 8.75) - height(edited.pyramid.field(0), 10.75);
    EXPECT_GT(height(edited.pyramid.field(0), 8.75), height(before.field(0), 8.75) + 0.1);
    EXPECT_NEAR(ribAfter, rib, 0.3);
    EXPECT_THROW(edit(before, {EditWith{level}}, {.level = 1}), InputError);
    EXPECT_THROW(edit(before, {EditWith{level}}, {.level = 0}), InputError);
}

// What lod/edit/unite.h leaves: min() of the level's values and of the tool's, cut as level 0 is, fitted on the level's lattice.
double volumeByMinOnTheLevel(const Pyramid& before, const Ball& ball, int level) {
    const Field field = before.field(kStepsPerLevel * level);
    const auto grid = gridOf(field)->deepCopy();
    const openvdb::math::Transform& lattice = grid->transform();
    const double h = field.spacing()[0], halfWidth = 4;
    const auto united = [&](const openvdb::Coord& at) {
        const openvdb::Vec3d p = lattice.indexToWorld(at);
        const double T = (p - openvdb::Vec3d(ball.centre.data())).length() - ball.radius;
        return std::min(field.value({p.x(), p.y(), p.z()}), field.K() * std::clamp(T / halfWidth, -1.0, 1.0));
    };
    const openvdb::Coord middle =
        openvdb::Coord::round(lattice.worldToIndex(openvdb::Vec3d(ball.centre.data())));
    const int reach = static_cast<int>((ball.radius + halfWidth) / h) + 2;
    std::map<openvdb::Coord, double> values;
    const auto around = [&](int by, const auto& call) {
        for (int x = -by; x <= by; ++x)
            for (int y = -by; y <= by; ++y)
                for (int z = -by; z <= by; ++z) call(middle.offsetBy(x, y, z));
    };
    around(reach + 1, [&](const openvdb::Coord& at) { values[at] = united(at); });
    around(reach, [&](const openvdb::Coord& at) {
        double c = 0;
        for (int b = 0; b < 27; ++b) {
            const openvdb::Coord by(b / 9 - 1, b / 3 % 3 - 1, b % 3 - 1);
            double weight = 1;
            for (int axis = 0; axis < 3; ++axis) weight *= by[axis] == 0 ? 8.0 / 6 : -1.0 / 6;
            c += weight * values[at + by];
        }
        grid->tree().setValueOn(at, static_cast<float>(c));
    });
    const Field changed = fieldOf(grid, openvdb::BoolGrid::create(false), field.K());
    return change(edit(before, {EditWith{changed}}, {.level = level}).report.edits[0]);
}

TEST(Edit, IsNearerToTheToolThanAnEditOfTheLevelsControlPoints) {
    const Ball onPlate{{20.3, 25.1, 20}, 8};
    const Pyramid before = plate();
    for (const int level : {1, 2}) {
        const double wanted = ballVolume(8) / 2, far = volumeByMinOnTheLevel(before, onPlate, level),
                     near = change(edit(before, {EditAdd{onPlate}}, {.level = level}).report.edits[0]);
        std::printf("level %d: %.4f, on its control points %.4f\n", level, near / wanted, far / wanted);
        EXPECT_LT(std::abs(near / wanted - 1), 0.02);
        EXPECT_GT(std::abs(far / wanted - 1), 2 * std::abs(near / wanted - 1));
    }
}

TEST(Edit, RefusesWhatMakesNoSense) {
    const Pyramid pyramid = plate();
    const auto message = [&](const std::vector<Edit>& edits, const EditingOptions& options) -> std::string {
        try {
            edit(pyramid, edits, options);
        } catch (const UsageError& error) {
            return std::string("usage: ") + error.what();
        } catch (const InputError& error) {
            return error.what();
        }
        return "none";
    };
    const Ball far{{200, 0, 0}, 3}, inside{{20, 18, 8}, 3};
    const double nan = std::nan("");
    EXPECT_THAT(message({}, {}), HasSubstr("no edit"));
    EXPECT_THAT(message({EditCut{far}}, {}), HasSubstr("--cut ball:200,0,0,3: misses the solid"));
    EXPECT_THAT(message({EditMove{{{100, 100, 100}, {110, 110, 110}}, {1, 0, 0}}}, {}),
                HasSubstr("misses the solid"));
    EXPECT_THAT(message({EditAdd{inside}}, {}), HasSubstr("lies in the solid altogether"));
    EXPECT_THAT(message({EditAdd{Ball{{20.5, 18.5, 30.5}, 0.3}}}, {}),
                HasSubstr("lies in the solid, or changes it by less than a voxel of level 0"));
    EXPECT_THAT(message({EditCut{Ball{{20, 18, 10}, 60}}}, {}), HasSubstr("removes all of the solid"));
    EXPECT_THAT(message({EditAdd{Ball{{0, 0, 0}, 1e6}}}, {}), HasSubstr("units of the solid"));
    EXPECT_THAT(message({EditAdd{Ball{{1e12, 0, 0}, 1}}}, {}), HasSubstr("units of the solid"));
    for (const double bad : {0.0, -1.0, nan}) {
        EXPECT_THAT(message({EditCut{inside}}, {.blend = bad}), HasSubstr("usage: --blend"));
        EXPECT_THAT(message({EditCut{Ball{{20, 18, 8}, bad}}}, {}), HasSubstr("usage: --cut"));
    }
    EXPECT_THAT(message({EditCut{Ball{{nan, 18, 8}, 1}}}, {}), HasSubstr("no finite number"));
    EXPECT_THAT(message({EditCut{RegionBox{{0, 0, 0}, {1, 0, 1}}}}, {}), HasSubstr("no extent along y"));
    EXPECT_THAT(message({EditMove{{{0, 0, 0}, {1, 1, 1}}, {0, 0, 0}}}, {}), HasSubstr("moves by nothing"));
    EXPECT_THAT(message({EditMove{{{0, 0, 0}, {9, 9, 9}}, {0, 0, 1}}}, {.blend = 1}),
                HasSubstr("--blend is of"));
    EXPECT_THAT(message({EditCut{inside}}, {.level = 90}), HasSubstr("--level: the pyramid has levels 0 to"));
    EXPECT_THAT(message({EditCut{inside}}, {.level = -1}), HasSubstr("--level"));
    for (const int level : {0, 1})
        EXPECT_THAT(
            message({EditAdd{Ball{{20, 18, 10}, 1500}}}, {.level = level, .maxMemory = 1e9}),
            testing::AllOf(HasSubstr("--add ball:20,18,10,1500: would take about "),
                           HasSubstr("over the limit of 1 GB; give a smaller one, or raise the limit")));
    EXPECT_THAT(message({EditCut{inside}}, {.maxMemory = 1000}), HasSubstr("would take about"));
    EXPECT_THAT(message({EditCut{inside}}, {.maxMemory = -1}), HasSubstr("usage: --max-memory"));
    TriangleMesh open = boxMesh({0, 0, 0}, {5, 5, 5});
    open.triangles.pop_back();
    EXPECT_THAT(message({EditCut{open}}, {}), HasSubstr("is open"));
}

TEST(Edit, SaysThatAnAddedPartTouchesNothing) {
    Remarks remarks;
    const EditedPyramid edited = edit(plate(), {EditAdd{Ball{{20, 18, 60}, 4}}}, {}, remarks.progress());
    EXPECT_EQ(edited.report.edits[0].partsAfter, 2);
    EXPECT_THAT(remarks.text, HasSubstr("touches nothing"));
}

}  // namespace
}  // namespace isowave::lod_test
