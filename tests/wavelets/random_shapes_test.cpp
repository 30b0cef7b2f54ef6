// The promises of direction.h on thousands of small random masks: whatever the shape, the axes and their
// order.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "volume/distance.h"
#include "volume/fit.h"
#include "wavelets/direction.h"

namespace isowave::wavelets {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

// ---- random fields

// The same numbers on every machine (the standard's distributions are not).
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    int between(int low, int high) {
        return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1));
    }
    bool oneIn(int n) { return engine_() % static_cast<unsigned>(n) == 0; }
    float unit() { return static_cast<float>(engine_() >> 8) / static_cast<float>(1u << 24); }  // [0, 1)
    Coord coord(const Coord& low, const Coord& high) {
        return {between(low.x(), high.x()), between(low.y(), high.y()), between(low.z(), high.z())};
    }

  private:
    std::mt19937 engine_;
};

// kMasks random masks in one box: a tree of OpenVDB costs as much as a hundred of them. They lie a few
// lattice points apart or many, so that intervals of neighbours are joined at one step or another. Noise of
// any density, or boxes put together and taken away; half of them one voxel thick along a random axis, which
// are solids of the plane.
constexpr int kPerAxis = 5, kPitch = 22, kMasks = kPerAxis * kPerAxis * kPerAxis;

class Masks {
  public:
    Masks(Random& random)
        : box_(CoordBBox::createCube(random.coord(Coord(-40), Coord(40)), kPerAxis * kPitch)),
          inside_(box_.volume(), 0) {
        for (int x = 0; x < kPerAxis; ++x)
            for (int y = 0; y < kPerAxis; ++y)
                for (int z = 0; z < kPerAxis; ++z)
                    draw(random, box_.min().offsetBy(x * kPitch, y * kPitch, z * kPitch));
    }
    NodeCollection nodes() const {
        return nodesFromFunction([this](const Coord& c) { return inside_[at(c)] != 0; }, box_);
    }

  private:
    void draw(Random& random, const Coord& corner) {
        const bool flat = random.oneIn(2);
        Coord size = random.coord(Coord(1), Coord(flat ? kPitch - 1 : kPitch / 2));
        if (flat) size[random.between(0, 2)] = 1;
        const Coord low = random.coord(corner, corner + Coord(kPitch) - size);
        const CoordBBox box(low, low + size.offsetBy(-1));
        if (random.oneIn(2)) {
            const int density = random.between(2, 30);
            for (auto c = box.begin(); c; ++c) inside_[at(*c)] = random.oneIn(density);
        } else {
            for (int k = random.between(1, 5); k-- > 0;) {
                const Coord a = random.coord(box.min(), box.max()), b = random.coord(a, box.max());
                const CoordBBox part(a, b);
                const char value = !random.oneIn(3);
                for (auto c = part.begin(); c; ++c) inside_[at(*c)] = value;
            }
        }
        inside_[at(random.coord(box.min(), box.max()))] = 1;
    }
    std::size_t at(const Coord& c) const {
        const Coord d = c - box_.min(), n = box_.dim();
        return std::size_t((d.x() * n.y() + d.y()) * n.z() + d.z());
    }

    CoordBBox box_;
    std::vector<char> inside_;
};

// What the fit makes of the masks; every second time with control points that no fit would give, any in [-K,
// K).
BSplineField randomField(Random& random) {
    BSplineField field = fitBinary(Masks(random).nodes(), {.passes = random.between(0, 3)});
    if (random.oneIn(2))
        for (auto c = field.controlPoints->beginValueOn(); c; ++c) c.setValue(2 * random.unit() - 1);
    return field;
}

// One order of the three axes after another, then up to four directions of any axis.
std::vector<int> axesOf(unsigned seed, Random& random) {
    std::vector<int> axes = {0, 1, 2};
    for (unsigned k = seed % 6; k-- > 0;) std::next_permutation(axes.begin(), axes.end());
    for (int k = random.between(0, 4); k-- > 0;) axes.push_back(random.between(0, 2));
    return axes;
}

// Calls check(field, axes, random) for `count` random masks or a few more.
template <class Check>
void forRandomMasks(int count, const Check& check) {
    for (unsigned seed = 0; static_cast<int>(seed) * kMasks < count; ++seed) {
        Random random(seed);
        const BSplineField field = randomField(random);
        const std::vector<int> axes = axesOf(seed, random);
        std::string order;
        for (const int axis : axes) order += "xyz"[axis];
        SCOPED_TRACE("seed " + std::to_string(seed) + ", axes " + order);
        check(field, axes, random);
        if (testing::Test::HasFailure()) return;  // one is enough to look at
    }
}

// ---- what is compared

struct Taken {
    std::vector<Shape::Ptr> shapes;  // of the finer fields
    std::vector<DetailGrid::Ptr> details;
    BSplineField coarse;
};

Taken takeApart(const BSplineField& field, const std::vector<int>& axes) {
    Taken taken;
    taken.coarse = field;
    for (const int axis : axes) {
        DirectionResult result = analyseDirection(taken.coarse, axis);
        taken.shapes.push_back(taken.coarse.shape);
        taken.details.push_back(result.details);
        taken.coarse = std::move(result.coarse);
    }
    return taken;
}

BSplineField putTogether(const Taken& taken, const std::vector<int>& axes) {
    BSplineField field = taken.coarse;
    for (std::size_t s = axes.size(); s-- > 0;)
        field = synthesiseDirection(field, *taken.details[s], *taken.shapes[s], axes[s]);
    return field;
}

// Largest difference of b, moved by `by`, from a; infinite where other values are active.
template <class Grid>
double difference(const Grid& a, const Grid& b, const Coord& by = Coord(0)) {
    if (a.activeVoxelCount() != b.activeVoxelCount()) return INFINITY;
    const auto other = b.getConstAccessor();
    double largest = 0;
    for (auto c = a.cbeginValueOn(); c; ++c) {
        typename Grid::ValueType value;
        if (!other.probeValue(c.getCoord() + by, value)) return INFINITY;
        largest = std::max(largest, std::abs(double(*c) - double(value)));
    }
    return largest;
}

// The shortest run of active values along any axis.
int shortestRun(const openvdb::FloatGrid& grid) {
    const auto known = grid.getConstAccessor();
    int shortest = 1 << 20;
    for (auto c = grid.cbeginValueOn(); c; ++c)
        for (int axis = 0; axis < 3; ++axis) {
            Coord at = c.getCoord();
            --at[axis];
            if (known.isValueOn(at)) continue;
            int length = 0;
            do ++length, ++at[axis];
            while (length < shortest && known.isValueOn(at.offsetBy(axis == 0, axis == 1, axis == 2)));
            shortest = std::min(shortest, length);
        }
    return shortest;
}

// ---- the promises

TEST(RandomShapes, ComeBackWhateverTheOrderOfTheAxes) {
    forRandomMasks(3000, [&](const BSplineField& field, const std::vector<int>& axes, Random&) {
        const BSplineField back = putTogether(takeApart(field, axes), axes);
        const double d = difference(*field.controlPoints, *back.controlPoints);
        EXPECT_LT(d, 1e-5);  // seen 1e-6
        EXPECT_EQ(back.transform(), field.transform());
    });
}

TEST(RandomShapes, HaveRunsOfFourOrMoreAlongEveryAxisAfterEveryStep) {
    forRandomMasks(2000, [&](BSplineField field, const std::vector<int>& axes, Random&) {
        for (const int axis : axes) {
            field = analyseDirection(field, axis).coarse;
            EXPECT_GE(shortestRun(*field.controlPoints), 4);
        }
    });
}

TEST(RandomShapes, GiveTheSameBitsForOneTwoAndFourThreads) {
    forRandomMasks(2000, [&](const BSplineField& field, const std::vector<int>& axes, Random&) {
        Taken one;
        BSplineField back;
        for (const int threads : {1, 2, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            Taken now = takeApart(field, axes);
            const BSplineField backNow = putTogether(now, axes);
            if (threads == 1) {
                one = std::move(now);
                back = backNow;
                continue;
            }
            for (std::size_t s = 0; s < axes.size(); ++s)
                EXPECT_EQ(difference(*one.details[s], *now.details[s]), 0);
            EXPECT_EQ(difference(*one.coarse.controlPoints, *now.coarse.controlPoints), 0);
            EXPECT_EQ(difference(*one.coarse.shape, *now.coarse.shape), 0);
            EXPECT_EQ(difference(*back.controlPoints, *backNow.controlPoints), 0);
        }
    });
}

// The same field elsewhere: leaves and columns are cut at other places.
BSplineField moved(const BSplineField& field, const Coord& by) {
    BSplineField result;
    result.K = field.K;
    const auto k = static_cast<float>(field.K);
    result.controlPoints = openvdb::FloatGrid::create(k);
    result.shape = Shape::create(false);
    // Unknown values too: all of them are -K or +K by sign, +K and outside beyond the leaves.
    CoordBBox box;
    field.controlPoints->tree().evalLeafBoundingBox(box);
    const auto signs = field.shape->getConstAccessor();
    const auto values = field.controlPoints->getConstAccessor();
    for (auto c = box.begin(); c; ++c) {
        const bool inside = signs.getValue(*c);
        if (values.isValueOn(*c)) {
            result.controlPoints->tree().setValueOn(*c + by, values.getValue(*c));
            result.shape->tree().setValueOn(*c + by, inside);
        } else if (inside) {
            result.controlPoints->tree().setValueOff(*c + by, -k);
            result.shape->tree().setValueOff(*c + by, true);
        }
    }
    return result;
}

TEST(RandomShapes, MovedByEvenOffsetsGiveTheSameBitsMoved) {
    forRandomMasks(2000, [&](const BSplineField& field, const std::vector<int>& axes, Random& random) {
        // A multiple of 2 for every time that an axis is halved.
        Coord by = random.coord(Coord(-6), Coord(6));
        for (const int axis : axes) by[axis] *= 2;
        const Taken a = takeApart(field, axes), b = takeApart(moved(field, by), axes);
        for (std::size_t s = 0; s < axes.size(); ++s) {
            by[axes[s]] /= 2;
            EXPECT_EQ(difference(*a.details[s], *b.details[s], by), 0) << "step " << s;
        }
        EXPECT_EQ(difference(*a.coarse.controlPoints, *b.coarse.controlPoints, by), 0);
        EXPECT_EQ(difference(*a.coarse.shape, *b.coarse.shape, by), 0);
    });
}

// So that the test above can fail: an odd offset does not commute.
TEST(RandomShapes, MovedByOneGiveOtherCoefficients) {
    int other = 0, all = 0;
    forRandomMasks(1000, [&](const BSplineField& field, const std::vector<int>&, Random&) {
        const auto a = analyseDirection(field, 0), b = analyseDirection(moved(field, Coord(1, 0, 0)), 0);
        other += difference(*a.details, *b.details) > 1e-3;
        ++all;
    });
    EXPECT_EQ(other, all);
}

}  // namespace
}  // namespace isowave::wavelets
