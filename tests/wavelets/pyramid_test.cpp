// The promises of direction.h and pyramid.h on the whole zoo, and agreement with the oracle.
#include "wavelets/pyramid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/tools/Count.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "isowave/error.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "zoo/zoo.h"

namespace isowave::wavelets {
namespace {

// Largest difference of control points over both known sets; infinite where the known sets differ.
double difference(const BSplineField& a, const BSplineField& b) {
    if (a.controlPointCount() != b.controlPointCount()) return INFINITY;
    const auto other = b.controlPoints->getConstAccessor();
    double largest = 0;
    for (auto c = a.controlPoints->cbeginValueOn(); c; ++c) {
        if (!other.isValueOn(c.getCoord())) return INFINITY;
        largest = std::max(largest, std::abs(double(*c) - other.getValue(c.getCoord())));
    }
    return largest;
}

bool sameToTheBit(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    if (!a.tree().hasSameTopology(b.tree())) return false;
    for (auto v = a.cbeginValueAll(); v; ++v)
        if (b.tree().getValue(v.getCoord()) != *v) return false;
    return true;
}

TEST(Pyramid, RoundTripOfTheWholeZooIsWithinTenToTheMinusFiveOfK) {
    for (const auto& [name, field] : zoo::allFields()) {
        const Pyramid pyramid = analyse(field);
        const BSplineField back = pyramid.field(0);
        EXPECT_LT(difference(field, back), 1e-5 * field.K) << name;  // seen 6e-7
        EXPECT_EQ(back.transform(), field.transform()) << name;
    }
}

TEST(Pyramid, DescendingWithoutItMeetsTheSameFieldsAndCountsTheSameCoefficients) {
    for (const auto& [name, field] : zoo::allFields()) {
        std::vector<openvdb::FloatGrid::Ptr> expected;
        const Pyramid pyramid = analyse(
            field, {}, {}, [&](int, const BSplineField& step) { expected.push_back(step.controlPoints); });
        std::size_t met = 0;
        const Descent descent = descend(field, {}, {}, [&, name = name](int step, const BSplineField& f) {
            ASSERT_EQ(step, static_cast<int>(met));
            ASSERT_LT(met, expected.size());
            EXPECT_TRUE(sameToTheBit(*f.controlPoints, *expected[met++])) << name << ' ' << step;
        });
        EXPECT_EQ(met, expected.size()) << name;
        EXPECT_EQ(descent.steps, pyramid.stepCount()) << name;
        EXPECT_EQ(descent.coefficientsStored, pyramid.coefficientsStored()) << name;
        EXPECT_TRUE(sameToTheBit(*descent.coarsest.controlPoints, *pyramid.coarsest.controlPoints)) << name;
    }
}

TEST(Pyramid, DescendingLetsGoOfTheFinerFields) {
    BSplineField field = zoo::allFields().front().field;
    field = {field.controlPoints->deepCopy(), field.shape->deepCopy(), field.K};
    std::vector<std::weak_ptr<openvdb::FloatGrid>> met;
    descend(std::move(field), {}, {}, [&](int, const BSplineField& f) {
        for (const auto& finer : met) EXPECT_TRUE(finer.expired());
        met.push_back(f.controlPoints);
    });
    EXPECT_GT(met.size(), 3u);
}

TEST(Pyramid, EverySolidEndsAtOneNode) {
    for (const auto& [name, field] : zoo::allFields()) {
        const Pyramid pyramid = analyse(field);
        EXPECT_EQ(pyramid.coarsest.controlPointCount(), field.controlPointCount() == 0 ? 0 : 64) << name;
    }
}

TEST(Pyramid, ASmallSolidEndsAtOneNodeWhereverItLies) {
    // A run of 5 control points at 6 .. 10 needs four levels before there is one less: 2 .. 6, 0 .. 4, -1 ..
    // 3, -1 .. 2.
    for (const int size : {1, 2, 3})
        for (int at = 0; at < 40; ++at) {
            const openvdb::Coord low(at, (at * 7) % 40, (at * 13) % 40);
            const auto nodes = nodesFromFunction([](const openvdb::Coord&) { return true; },
                                                 openvdb::CoordBBox(low, low.offsetBy(size - 1)));
            const Pyramid pyramid = analyse(fitBinary(nodes));
            ASSERT_EQ(pyramid.coarsest.controlPointCount(), 64) << size << " at " << low;
        }
}

TEST(Pyramid, ADomainThatStraddlesTheOriginStopsAtTwoNodes) {
    // Not made by a fit, which would have moved the origin.
    BSplineField field;
    field.controlPoints = openvdb::FloatGrid::create(1.0f);
    field.shape = Shape::create(false);
    for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y)
            for (int z = -4; z <= 4; ++z) {
                const openvdb::Coord c(x, y, z);
                field.controlPoints->tree().setValueOn(c, c == openvdb::Coord(0) ? -1.0f : 1.0f);
                field.shape->tree().setValueOn(c, c == openvdb::Coord(0));
            }
    const Pyramid pyramid = analyse(field);
    EXPECT_EQ(pyramid.coarsest.controlPointCount(), 125);
    EXPECT_LE(pyramid.stepCount(), 12);
    EXPECT_LT(difference(field, pyramid.field(0)), 1e-5);
}

TEST(Pyramid, AnyStepComesBackAsItWasOnTheWayDown) {
    for (const auto& [name, field] : zoo::allFields()) {
        std::vector<BSplineField> onTheWay;
        const Pyramid pyramid = analyse(field, {}, {}, [&](int step, const BSplineField& f) {
            EXPECT_EQ(step, static_cast<int>(onTheWay.size()));
            onTheWay.push_back(f);
        });
        ASSERT_EQ(onTheWay.size(), pyramid.steps.size() + 1);
        for (int step = 0; step <= pyramid.stepCount(); step += 4)
            EXPECT_LT(difference(onTheWay[step], pyramid.field(step)), 1e-5 * field.K)
                << name << " step " << step;
    }
}

TEST(Pyramid, ControlPointsOutsideIAreExactlyPlusOrMinusK) {
    for (const auto& [name, field] : zoo::allFields())
        analyse(field, {}, {},
                [&, name = name, K = static_cast<float>(field.K)](int step, const BSplineField& f) {
                    const auto inside = f.shape->getConstAccessor();
                    ASSERT_TRUE(f.shape->tree().hasSameTopology(f.controlPoints->tree())) << name << step;
                    ASSERT_FALSE(f.controlPoints->tree().hasActiveTiles()) << name << step;
                    EXPECT_EQ(f.controlPoints->background(), K);
                    for (auto c = f.controlPoints->cbeginValueOff(); c; ++c)
                        ASSERT_EQ(*c, inside.getValue(c.getCoord()) ? -K : K)
                            << name << " step " << step << c.getCoord();
                });
}

TEST(Pyramid, SignsOfACoarseShapeAreThoseOfTheEvenFinePoints) {
    for (const auto& [name, field] : zoo::allFields()) {
        const Pyramid pyramid = analyse(field);
        for (int step = 0; step + 1 < pyramid.stepCount(); ++step) {
            const auto& fine = *pyramid.steps[step].shape;
            const auto& coarse = *pyramid.steps[step + 1].shape;
            const int axis = pyramid.steps[step].axis;
            for (auto v = coarse.cbeginValueAll(); v; ++v) {
                openvdb::Coord c = v.getCoord();
                c[axis] *= 2;
                ASSERT_EQ(*v, fine.tree().getValue(c)) << name << " step " << step;
            }
        }
    }
}

TEST(Pyramid, RunsAreFourOrLongerAfterEveryStep) {
    for (const auto& [name, field] : zoo::allFields())
        analyse(field, {}, {}, [&, name = name](int step, const BSplineField& f) {
            const auto known = f.controlPoints->getConstAccessor();
            for (auto c = f.controlPoints->cbeginValueOn(); c; ++c)
                for (int axis = 0; axis < 3; ++axis) {
                    openvdb::Coord before = c.getCoord(), at = c.getCoord();
                    before[axis] -= 1;
                    if (known.isValueOn(before)) continue;
                    int length = 0;
                    for (; known.isValueOn(at); ++at[axis]) ++length;
                    ASSERT_GE(length, 4) << name << " step " << step << " axis " << axis << c.getCoord();
                }
        });
}

TEST(Pyramid, ResultsAreTheSameToTheBitForOneTwoAndFourThreads) {
    const auto solid = zoo::noisySolids()[0];
    const BSplineField field = zoo::binaryField(solid);
    std::vector<Pyramid> results;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_TRUE(sameToTheBit(*zoo::binaryField(solid).controlPoints, *field.controlPoints));
        results.push_back(analyse(field));
        const BSplineField back = results.back().field(0);
        EXPECT_TRUE(sameToTheBit(*back.controlPoints, *results[0].field(0).controlPoints));
    }
    for (const Pyramid& p : results) {
        ASSERT_EQ(p.steps.size(), results[0].steps.size());
        EXPECT_TRUE(sameToTheBit(*p.coarsest.controlPoints, *results[0].coarsest.controlPoints));
        for (std::size_t s = 0; s < p.steps.size(); ++s)
            EXPECT_TRUE(sameToTheBit(*p.steps[s].details, *results[0].steps[s].details));
    }
}

TEST(Pyramid, ALevelScalesTheTransformByTwoAndNothingShifts) {
    BSplineField field = zoo::binaryField(zoo::thinSolids()[1]);
    const openvdb::Mat4R skew(0.8, 0.1, 0., 0., -0.2, 1.1, 0.3, 0., 0., 0.05, 2.5, 0., 100., -20., 7., 1.);
    field.controlPoints->setTransform(openvdb::math::Transform::createLinearTransform(skew));
    field.shape->setTransform(openvdb::math::Transform::createLinearTransform(skew));
    const Pyramid pyramid = analyse(field, {.maxSteps = 4});  // x, y, z, x
    const openvdb::Vec3d coarse(3, -2, 5), fine(12, -4, 10);
    EXPECT_LT(
        (pyramid.coarsest.transform().indexToWorld(coarse) - field.transform().indexToWorld(fine)).length(),
        1e-12);
}

TEST(Pyramid, ShiftingTheSolidByAnEvenVectorShiftsTheResult) {
    auto solid = zoo::cadSolids()[0];
    const openvdb::Coord centre(40);  // no control point below -1, so the fits keep the lattice's origin
    solid.inside = [inside = solid.inside, centre](const openvdb::Coord& c) { return inside(c - centre); };
    solid.box.translate(centre);
    auto shifted = solid;
    const openvdb::Coord by(8, -16, 24);  // 8 = 2^3: even on the first nine steps' grids
    shifted.inside = [&](const openvdb::Coord& c) { return solid.inside(c - by); };
    shifted.box.translate(by);
    const Pyramid a = analyse(zoo::binaryField(solid), {.maxSteps = 9});
    const Pyramid b = analyse(zoo::binaryField(shifted), {.maxSteps = 9});
    const openvdb::Coord coarseBy(1, -2, 3);
    ASSERT_EQ(a.coarsest.controlPointCount(), b.coarsest.controlPointCount());
    for (auto c = a.coarsest.controlPoints->cbeginValueOn(); c; ++c)
        ASSERT_EQ(*c, b.coarsest.controlPoints->tree().getValue(c.getCoord() + coarseBy));
}

TEST(Pyramid, StoredCoefficientsStayNearTheNumberOfControlPoints) {
    for (const auto& solid : zoo::smoothSolids()) {
        const BSplineField field = zoo::distanceField(solid);
        const double ratio = double(analyse(field).coefficientsStored()) / double(field.controlPointCount());
        EXPECT_GE(ratio, 1.0);
        EXPECT_LT(ratio, 1.45) << solid.name;  // these solids are small: 24 voxels across
    }
}

TEST(Pyramid, CancellingStopsAndLeavesNothing) {
    const BSplineField field = zoo::binaryField(zoo::smoothSolids()[0]);
    int asked = 0;
    Progress progress;
    progress.stopRequested = [&asked] { return ++asked > 3; };
    EXPECT_THROW(analyse(field, {}, progress), Cancelled);
}

TEST(Pyramid, RefusesAShapeWhoseRunsAreTooShort) {
    BSplineField field = zoo::binaryField(zoo::thinSolids()[0]);
    // Lattice point (3, -2, 7) of the solid; the fit has moved the origin.
    field.shape->tree().setValueOff(
        field.shape->transform().worldToIndexNodeCentered(openvdb::Vec3d(3, -2, 7)));
    EXPECT_THROW(analyseDirection(field, 0), InputError);
}

TEST(Pyramid, RefusesAShapeThatKnowsPointsWhichTheFieldHasNot) {
    BSplineField field = zoo::binaryField(zoo::smoothSolids()[0]);
    const auto origin = field.shape->tree().cbeginLeaf()->origin();
    field.controlPoints->tree().addTile(1, origin, static_cast<float>(field.K), false);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_THROW(
            {
                try {
                    analyseDirection(field, axis);
                } catch (const InputError& error) {
                    EXPECT_THAT(error.what(), testing::HasSubstr("no control point at ("));
                    throw;
                }
            },
            InputError);
}

// ---- other orders of the axes

const std::vector<StepOrder>& someOrders() {
    static const std::vector<StepOrder> orders{
        {{"xy", "xy"}}, {{"z"}}, {{"x", "x", "x", "x"}}, {{"zy", "x", "yyz"}}};
    return orders;
}

TEST(Pyramid, InAnyOrderEachStepIsThatDirectionOfTheStepBefore) {
    for (const auto& [name, field] : zoo::allFields())
        for (const StepOrder& order : someOrders()) {
            BSplineField expected = field;
            const Pyramid pyramid =
                analyse(field, {.order = order, .maxSteps = 8}, {}, [&](int step, const BSplineField& f) {
                    if (step > 0) expected = analyseDirection(expected, order.axisAfter(step - 1)).coarse;
                    EXPECT_TRUE(sameToTheBit(*f.controlPoints, *expected.controlPoints)) << step;
                    EXPECT_EQ(f.transform(), expected.transform());
                });
            EXPECT_EQ(pyramid.order, order);
            for (int step = 0; step < pyramid.stepCount(); ++step)
                EXPECT_EQ(pyramid.steps[static_cast<std::size_t>(step)].axis, order.axisAfter(step));
            EXPECT_LT(difference(field, pyramid.field(0)), 1e-5 * field.K) << name;
        }
}

TEST(Pyramid, InAnyOrderEverySolidEndsAtOneNodeAndComesBack) {
    for (const auto& [name, field] : zoo::allFields())
        for (const StepOrder& order : someOrders()) {
            const Pyramid pyramid = analyse(field, {.order = order});
            EXPECT_EQ(pyramid.coarsest.controlPointCount(), field.controlPointCount() == 0 ? 0 : 64)
                << name << " step " << pyramid.stepCount();
            EXPECT_LT(difference(field, pyramid.field(0)), 1e-5 * field.K) << name;
        }
}

// ---- the oracle

BSplineField fieldFrom(const nlohmann::json& points, double K) {
    BSplineField field;
    field.K = K;
    field.controlPoints = openvdb::FloatGrid::create(static_cast<float>(K));
    field.shape = Shape::create(false);
    for (std::size_t i = 0; i < points["at"].size(); ++i) {
        const auto& at = points["at"][i];
        const openvdb::Coord c(at[0], at[1], at[2]);
        field.controlPoints->tree().setValue(c, points["value"][i].get<float>());
        field.shape->tree().setValueOn(c, points["inside"][i] == 1);
    }
    return field;
}

struct Golden {
    const char* file;
    StepOrder order;
};
void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.file; }
class Oracle : public testing::TestWithParam<Golden> {};

TEST_P(Oracle, AgreesOnCoefficientsDetailsAndShapes) {
    std::ifstream file(std::string(ISOWAVE_TEST_DATA "/oracle/") + GetParam().file + ".json");
    ASSERT_TRUE(file);
    const auto golden = nlohmann::json::parse(file);
    // The golden solids have no inside region without control points, so unknown points are all outside.
    const BSplineField field = fieldFrom(golden["fields"][0], golden["K"]);
    int compared = 0;
    const Pyramid pyramid =
        analyse(field, {.order = GetParam().order, .maxSteps = int(golden["details"].size())}, {},
                [&](int step, const BSplineField& f) {
                    const BSplineField expected = fieldFrom(golden["fields"][step], golden["K"]);
                    ASSERT_LT(difference(f, expected), 1e-6) << "step " << step;
                    for (auto v = expected.shape->cbeginValueOn(); v; ++v)
                        ASSERT_EQ(f.shape->tree().getValue(v.getCoord()), *v) << v.getCoord();
                    ++compared;
                });
    EXPECT_EQ(compared, 8);
    for (int step = 0; step < pyramid.stepCount(); ++step) {
        const auto& expected = golden["details"][step];
        const auto& details = *pyramid.steps[step].details;
        ASSERT_EQ(pyramid.steps[step].axis, expected["axis"].get<int>());
        ASSERT_EQ(details.activeVoxelCount(), expected["at"].size());
        for (std::size_t i = 0; i < expected["at"].size(); ++i) {
            const auto& at = expected["at"][i];
            const openvdb::Coord c(at[0], at[1], at[2]);
            ASSERT_TRUE(details.tree().isValueOn(c)) << c;
            ASSERT_NEAR(details.tree().getValue(c), expected["value"][i].get<double>(), 1e-6)
                << c;  // seen 4e-7
        }
    }
    EXPECT_LT(difference(field, pyramid.field(0)), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Fields, Oracle,
                         testing::Values(Golden{"part", {}}, Golden{"sheet", {}}, Golden{"noise", {}},
                                         Golden{"sheet_any_order", {{"zx", "xyz", "zy"}}}));

}  // namespace
}  // namespace isowave::wavelets
