#include "hold/local_edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using testing::fieldFromDistance;
using testing::sphere;
using testing::torus;

// A lattice point beside the surface of a ball of radius 6 that is outside.
EditPlan bump(int refine) {
    EditPlan plan;
    plan.points = {Coord(static_cast<int>(std::ceil(6.05 * refine)), 0, 0)};
    return plan;
}

TEST(EditTrial, MakesWhatIsPlannedAndLittleElseHoweverFineTheLattice) {
    const BSplineField field = fieldFromDistance(12, sphere(6));
    for (const int refine : {1, 2, 4}) {
        const EditPlan plan = bump(refine);
        EditTrial trial(field, refine, plan);
        for (const EditManner manner :
             {EditManner{0.25, false}, EditManner{0.25, true}, EditManner{1, true}}) {
            const auto edit = trial.attempt(manner, 0);  // still a ball
            ASSERT_TRUE(edit);
            BSplineField changed = field;
            changed.controlPoints = field.controlPoints->deepCopy();
            changed.shape = field.shape->deepCopy();
            apply(*edit, changed);
            EXPECT_LT(evaluate(changed, plan.points[0].asVec3d() / refine), 0);
            // A bump a voxel high and some two wide.
            EXPECT_GT(trial.volumeGained(*edit), 0);
            EXPECT_LT(edit->moved, 4);
        }
    }
}

TEST(EditTrial, GivesTheVolumeOfTheWholeMesh) {
    const BSplineField field = fieldFromDistance(12, sphere(6));
    const EditPlan plan = bump(2);
    EditTrial trial(field, 2, plan);
    const auto edit = trial.attempt({});
    ASSERT_TRUE(edit);
    trial.attempt({1.0, true});  // the volume is that of the edit, not of the last attempt
    BSplineField changed = field;
    changed.controlPoints = field.controlPoints->deepCopy();
    changed.shape = field.shape->deepCopy();
    apply(*edit, changed);
    const auto volume = [](const BSplineField& f) { return topologyOf(polygonize(f, {.refine = 2})).volume; };
    EXPECT_NEAR(trial.volumeGained(*edit), volume(changed) - volume(field), 1e-6);
}

TEST(EditTrial, GivesNothingWhereTheEulerNumberWouldNotChangeAsAskedFor) {
    const BSplineField field = fieldFromDistance(12, sphere(6));
    const EditPlan plan = bump(2);
    EditTrial trial(field, 2, plan);
    EXPECT_FALSE(trial.attempt({}, 2));
    EXPECT_TRUE(trial.attempt({}, 0));
}

// The cavity lies in the surroundings as a whole, before: it goes with its ball's Euler number, and that is what is wanted.
TEST(EditTrial, OpensACavityThatIsSmall) {
    const auto hollow = [](const openvdb::Vec3d& p) {
        return std::max(p.length() - 6, 1.4 - (p - openvdb::Vec3d(3.1, 0, 0)).length());
    };
    const BSplineField field = fieldFromDistance(12, hollow);
    ASSERT_EQ(topologyOf(polygonize(field, {.refine = 2})).cavities, 1);
    EditPlan plan;
    plan.fill = false;
    for (int x = 9; x <= 12; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) plan.points.emplace_back(x, y, z);
    const auto edit = EditTrial(field, 2, plan).attempt({1.0, true}, -2);
    ASSERT_TRUE(edit);
    BSplineField changed = field;
    changed.controlPoints = field.controlPoints->deepCopy();
    changed.shape = field.shape->deepCopy();
    apply(*edit, changed);
    const MeshTopology opened = topologyOf(polygonize(changed, {.refine = 2}));
    EXPECT_EQ(opened.cavities, 0);
    EXPECT_EQ(opened.genus, 0);
}

// A blind hole whose mouth is shut becomes a cavity: that is no handle less.
TEST(EditTrial, TakesABubbleThatAppearsForNoHandle) {
    const auto drilled = [](const openvdb::Vec3d& p) {
        const openvdb::Vec3d beyond(std::min(0.0, p.x() - 4.8), p.y(), p.z());
        return std::max(p.length() - 7, 1.2 - beyond.length());
    };
    const BSplineField field = fieldFromDistance(12, drilled);
    ASSERT_EQ(topologyOf(polygonize(field, {.refine = 2})).cavities, 0);
    EditPlan plan;
    for (int x = 13; x <= 14; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -2; z <= 2; ++z) plan.points.emplace_back(x, y, z);
    EditTrial trial(field, 2, plan);
    const auto shut = trial.attempt({1.0, true});
    ASSERT_TRUE(shut);
    BSplineField changed = field;
    changed.controlPoints = field.controlPoints->deepCopy();
    changed.shape = field.shape->deepCopy();
    apply(*shut, changed);
    ASSERT_EQ(topologyOf(polygonize(changed, {.refine = 2})).cavities, 1);
    EXPECT_FALSE(trial.attempt({1.0, true}, 2));
}

TEST(EditTrial, GivesNothingWhereNothingNeedsToChange) {
    const BSplineField field = fieldFromDistance(12, sphere(6));
    EditPlan plan;
    plan.points = {Coord(0, 0, 0)};  // deep inside
    EXPECT_FALSE(EditTrial(field, 1, plan).attempt({}));
}

TEST(EditTrial, LeavesTheFieldAsItIs) {
    const BSplineField field = fieldFromDistance(12, torus(5, 2));
    const openvdb::FloatGrid::Ptr before = field.controlPoints->deepCopy();
    const EditPlan plan = bump(1);
    EditTrial(field, 1, plan).attempt({});
    for (auto v = before->cbeginValueAll(); v; ++v)
        ASSERT_EQ(field.controlPoints->tree().getValue(v.getCoord()), *v);
}

}  // namespace
}  // namespace isowave
