#include "hold/lattice_patch.h"

#include <gtest/gtest.h>

#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using testing::fieldFromDistance;
using testing::noiseField;
using testing::torus;

LatticePatch patchOf(const BSplineField& field, int refine) {
    CoordBBox box;
    field.controlPoints->tree().evalLeafBoundingBox(box);
    box.expand(3);
    LatticeFunction c{box.dim(), {}};
    for (auto at = box.begin(); at; ++at) c.values.push_back(field.controlPoints->tree().getValue(*at));
    return {c, box.min(), refine};
}

TEST(LatticePatch, HasTheValuesOfTheLatticeThatTheMeshSamples) {
    const BSplineField field = noiseField(6, 7);
    for (const int refine : {1, 2, 4}) {
        const MeshLattice all = meshLattice(field, refine);
        const LatticePatch patch = patchOf(field, refine);
        EXPECT_EQ(patch.lattice().finer, refine);
        for (std::int64_t i = 0; i < std::int64_t(all.function.values.size()); ++i) {
            const Coord at = all.coordOf(i);
            ASSERT_TRUE(patch.lattice().contains(at)) << at;
            ASSERT_NEAR(patch.lattice().at(at), all.function.values[i], 1e-6) << at;
        }
    }
}

TEST(LatticePatch, CountsTheEulerNumberOfTheMesh) {
    for (const BSplineField& field :
         {fieldFromDistance(16, torus(5, 2)), noiseField(6, 1), noiseField(8, 2), noiseField(10, 3)})
        for (const int refine : {1, 2, 4}) {
            const MeshTopology mesh = topologyOf(polygonize(field, {.refine = refine}));
            EXPECT_EQ(patchOf(field, refine).twiceEuler(), 2 * (2 * mesh.components - 2 * mesh.genus));
        }
}

}  // namespace
}  // namespace isowave
