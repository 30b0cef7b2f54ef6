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

// Pieces of one sign that do not reach the border, by flooding from point to point.
std::int64_t floodedPieces(const LatticeFunction& f) {
    std::vector<bool> seen(f.values.size());
    std::int64_t closed = 0;
    for (std::size_t start = 0; start < seen.size(); ++start) {
        if (seen[start]) continue;
        std::vector<std::int64_t> points{static_cast<std::int64_t>(start)};
        seen[start] = true;
        bool atBorder = false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Coord c = f.point(points[i]);
            for (int n = 0; n < 27; ++n) {
                const Coord next = c.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
                bool beyond = false;
                for (int a = 0; a < 3; ++a) beyond = beyond || next[a] < 0 || next[a] >= f.size[a];
                atBorder = atBorder || beyond;
                if (beyond) continue;
                const std::int64_t at = f.index(next[0], next[1], next[2]);
                if (seen[at] || (f.values[at] < 0) != (f.values[start] < 0)) continue;
                seen[at] = true;
                points.push_back(at);
            }
        }
        closed += !atBorder;
    }
    return closed;
}

TEST(LatticePatch, CountsThePiecesThatLieInItAsAWhole) {
    std::int64_t found = 0;
    for (int seed = 1; seed <= 30; ++seed) {
        const LatticePatch patch = patchOf(noiseField(3 + seed % 6, seed), seed % 3 == 0   ? 1
                                                                           : seed % 3 == 1 ? 2
                                                                                           : 4);
        const std::int64_t pieces = floodedPieces(patch.lattice().function);
        EXPECT_EQ(patch.closedPieces(), pieces) << seed;
        found += pieces;
    }
    EXPECT_GT(found, 30);
    EXPECT_EQ(patchOf(fieldFromDistance(16, torus(5, 2)), 2).closedPieces(), 1);
}

}  // namespace
}  // namespace isowave
