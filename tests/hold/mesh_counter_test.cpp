#include "hold/mesh_counter.h"

#include <gtest/gtest.h>

#include "hold/local_edit.h"
#include "polygonize/fields.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using testing::fieldFromDistance;
using testing::noiseField;
using testing::torus;

BSplineField copyOf(const BSplineField& field) {
    BSplineField copy = field;
    copy.controlPoints = field.controlPoints->deepCopy();
    copy.shape = field.shape->deepCopy();
    return copy;
}

// Other noise in the control points of the box.
void replace(BSplineField& field, const CoordBBox& box, int seed) {
    const BSplineField other = noiseField(12, seed);
    auto values = field.controlPoints->getAccessor();
    for (auto at = box.begin(); at; ++at)
        if (field.controlPoints->tree().isValueOn(*at))
            values.setValueOn(*at, other.controlPoints->tree().getValue(*at));
}

TEST(MeshCounter, CountsWhatTheMeshHas) {
    EXPECT_EQ(MeshCounter(fieldFromDistance(16, torus(8, 3)), 1, 0).counts(), (SolidCounts{1, 1, 0}));
    for (int seed = 1; seed <= 6; ++seed)
        for (const int refine : {1, 2, 4})
            for (const double smallest : {0.0, 1.0, 30.0}) {
                const BSplineField field = noiseField(12, seed);
                EXPECT_EQ(MeshCounter(field, refine, smallest).counts(),
                          meshedCounts(field, refine, smallest))
                    << seed << ' ' << refine << ' ' << smallest;
            }
}

TEST(MeshCounter, CountsAgainWhereTheFieldChanges) {
    std::int64_t changed = 0;
    for (const int refine : {1, 2, 4}) {
        BSplineField field = noiseField(12, 7);
        MeshCounter counter(field, refine, 1.0);
        for (int k = 0; k < 12; ++k) {
            const SolidCounts before = counter.counts();
            const CoordBBox box = CoordBBox::createCube(Coord(2 * k % 9, 3 * k % 7, 5 * k % 8), 3 + k % 3);
            BSplineField other = copyOf(field);
            replace(other, box, 20 + k);
            counter.change(other, {box});
            const SolidCounts after = meshedCounts(other, refine, 1.0);
            ASSERT_EQ(counter.counts(), after) << refine << ' ' << k;
            changed += after != before;
            if (k % 3 == 0) {
                field = other;
                continue;
            }
            counter.undo();
            ASSERT_EQ(counter.counts(), before) << refine << ' ' << k;
        }
    }
    EXPECT_GT(changed, 18);
}

TEST(MeshCounter, CountsInBlocksThatHadNoSurface) {
    BSplineField field = fieldFromDistance(30, torus(8, 3));
    for (const int refine : {1, 2}) {
        BSplineField other = copyOf(field);
        const CoordBBox box = CoordBBox::createCube(Coord(20), 3);
        auto values = other.controlPoints->getAccessor();
        for (auto at = box.begin(); at; ++at) values.setValueOn(*at, -1.0f);
        MeshCounter counter(field, refine, 0);
        counter.change(other, {box});
        EXPECT_EQ(counter.counts(), (SolidCounts{2, 1, 0}));
        counter.undo();
        EXPECT_EQ(counter.counts(), (SolidCounts{1, 1, 0}));
    }
}

}  // namespace
}  // namespace isowave
