#include "volume/fit.h"

#include <openvdb/tree/LeafManager.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <type_traits>
#include <vector>

#include "isowave/error.h"
#include "volume/fit/known.h"
#include "volume/fit/repair.h"
#include "volume/leaf_words.h"
#include "volume/padded_leaf.h"

// Passes of both fits:
//   known, origin, shape, field   volume/fit/known.h
//   weigh   control points on I (±K, or quasi-interpolated distances)
//   smooth  (binary only) Laplacian passes
//   repair  until every lattice point of I has the input's sign by a margin
// invariant of weigh, smooth and repair: what is not known stays ±K.

namespace isowave {

using namespace fitting;

namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using Mask = openvdb::MaskTree;
using MaskLeaf = Mask::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

// ---- smooth

// One pass of the discrete Laplacian filter on I: c <- (c + mean of the six neighbours)/2, all at once.
void laplacianPass(openvdb::tree::LeafManager<openvdb::FloatTree>& leaves, const openvdb::FloatTree& tree) {
    leaves.foreach ([&](FloatLeaf& leaf, std::size_t index) {
        ConstAccessor<openvdb::FloatTree> accessor(tree);
        PaddedLeaf<double, 1, 1> c;
        c.gather(accessor, leaf.origin());
        auto& out = leaves.getBuffer(index, 1);
        for (auto known = leaf.cbeginValueOn(); known; ++known) {
            const int x = int(known.pos() >> 6), y = int(known.pos() >> 3) & 7, z = int(known.pos()) & 7;
            const double sum = c.at(x - 1, y, z) + c.at(x + 1, y, z) + c.at(x, y - 1, z) + c.at(x, y + 1, z) +
                               c.at(x, y, z - 1) + c.at(x, y, z + 1);
            out.setValue(known.pos(), static_cast<float>(0.5 * (c.at(x, y, z) + sum / 6)));
        }
    });
    leaves.swapLeafBuffer(1);
}

// ---- distances

// Nodes with a corner nearer than `band`, and nodes whose corner signs differ.
Mask nodesNear(const openvdb::FloatTree& distance, float band) {
    Mask nodes;
    openvdb::tree::ValueAccessor<Mask> toTouch(nodes);
    for (auto leaf = distance.cbeginLeaf(); leaf; ++leaf)
        for (int b = 0; b < 8; ++b)
            toTouch.touchLeaf(leaf->origin().offsetBy(-8 * (b >> 2), -8 * ((b >> 1) & 1), -8 * (b & 1)));
    openvdb::tree::LeafManager<Mask> leaves(nodes);
    leaves.foreach ([&distance, band](MaskLeaf& leaf, std::size_t) {
        ConstAccessor<openvdb::FloatTree> accessor(distance);
        PaddedLeaf<float, 0, 1> d;
        d.gather(accessor, leaf.origin());
        LeafWords kept{};
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                std::array<float, 9> nearest;  // of the four edges along z that a node has, at either end
                std::array<int, 9> inside;
                const auto row = [&](int dx, int dy) { return &d.values[d.index(x + dx, y + dy, 0)]; };
                const float *p = row(0, 0), *q = row(0, 1), *r = row(1, 0), *s = row(1, 1);
                for (int z = 0; z < 9; ++z) {
                    nearest[z] = std::min(std::min(std::abs(p[z]), std::abs(q[z])),
                                          std::min(std::abs(r[z]), std::abs(s[z])));
                    inside[z] = int(p[z] < 0) + int(q[z] < 0) + int(r[z] < 0) + int(s[z] < 0);
                }
                for (int z = 0; z < 8; ++z) {
                    const int corners = inside[z] + inside[z + 1];
                    const bool stabbed = corners != 0 && corners != 8;
                    const bool near = std::min(nearest[z], nearest[z + 1]) < band;
                    kept[x] |= std::uint64_t(stabbed || near) << (8 * y + z);
                }
            }
        leaf.setValueMask(maskOf(kept));
    });
    return nodes;
}

// ---- before the repair

// ±K on I, smoothed; a source's lattice point i is i + shift of the field.
BSplineField smoothedSigns(const NodeCollection& nodes, const Mask& known, const openvdb::Coord& shift,
                           const BinaryFitOptions& options, const Progress& progress) {
    const openvdb::BoolTree& signs = nodes.grid->constTree();
    const auto makeInside = [&signs, &shift] { return Signs(signs, shift); };
    BSplineField field = makeField(makeShape(known, signs, shift, makeInside), options.K,
                                   *shiftedTransform(nodes.grid->transform(), shift));
    if (options.passes == 0) return field;
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(field.controlPoints->tree(), 1);
    for (int pass = 0; pass < options.passes; ++pass) {
        progress("fitting", 0.5 * pass / options.passes);
        laplacianPass(leaves, field.controlPoints->constTree());
    }
    return field;
}

Mask knownOf(const NodeCollection& nodes) {
    return knownAround(Mask(nodes.grid->constTree(), false, openvdb::TopologyCopy()));
}

// On each axis c = (8 v_i - v_{i-1} - v_{i+1})/6, exact for cubics.
void interpolate(const openvdb::FloatTree& distance, const openvdb::Coord& shift,
                 const DistanceFitOptions& options, FloatLeaf& leaf) {
    const double w = options.halfWidth, scale = options.K / w;
    ConstAccessor<openvdb::FloatTree> accessor(distance);
    PaddedLeaf<double, 1, 1> v;
    v.gather(accessor, leaf.origin() - shift);
    for (double& x : v.values) x = scale * std::clamp(x, -w, w);
    std::array<double, 512> c;
    filterThreeTaps(v, 8.0 / 6, -1.0 / 6, c);
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
        leaf.setValueOnly(voxel.pos(), static_cast<float>(c[voxel.pos()]));
}

// Leaves one after the other along x, and where those with the same x begin and end.
template <class Leaf>
struct Layers {
    std::vector<Leaf*> leaves;
    std::vector<std::size_t> at{0};

    explicit Layers(std::vector<Leaf*> all) : leaves(std::move(all)) {
        const auto xOf = [](const Leaf* leaf) { return leaf->origin().x(); };
        std::stable_sort(leaves.begin(), leaves.end(),
                         [&](const Leaf* a, const Leaf* b) { return xOf(a) < xOf(b); });
        for (std::size_t i = 1; i <= leaves.size(); ++i)
            if (i == leaves.size() || xOf(leaves[i]) != xOf(leaves[i - 1])) at.push_back(i);
    }
};

template <class Tree>
auto leavesOf(Tree& tree) {
    using Leaf = typename Tree::LeafNodeType;
    std::vector<std::conditional_t<std::is_const_v<Tree>, const Leaf, Leaf>*> leaves;
    tree.getNodes(leaves);
    return leaves;
}

// Distances, quasi-interpolated on I. Layer by layer, and of those that are given up (null: none are) a leaf goes once no layer to
// come looks at it: so they and the control points together take the memory of one of them.
BSplineField interpolatedDistances(const openvdb::FloatGrid& distance, openvdb::FloatGrid* givenUp,
                                   Mask known, const openvdb::Coord& shift,
                                   const DistanceFitOptions& options) {
    const openvdb::FloatTree& d = distance.constTree();
    const Shape::Ptr shape = makeShape(known, d, shift, [&d, &shift] { return Signs(d, shift); });
    known.clear();
    const Layers layers(leavesOf(shape->constTree()));
    std::vector<FloatLeafPtr> made(layers.leaves.size());
    const Layers given(givenUp ? leavesOf(givenUp->tree()) : std::vector<FloatLeaf*>());
    std::size_t gone = 0;
    for (std::size_t layer = 1; layer < layers.at.size(); ++layer) {
        const int x = layers.leaves[layers.at[layer - 1]]->origin().x() - shift.x();
        for (; gone < given.leaves.size() && given.leaves[gone]->origin().x() < x - 8; ++gone)
            delete givenUp->tree().stealNode<FloatLeaf>(given.leaves[gone]->origin(), d.background(), false);
        tbb::parallel_for(layers.at[layer - 1], layers.at[layer], [&](std::size_t i) {
            made[i] = makeLeaf(*layers.leaves[i], options.K);
            interpolate(d, shift, options, *made[i]);
        });
    }
    if (givenUp) givenUp->clear();
    return fieldOfLeaves(shape, options.K, *shiftedTransform(distance.transform(), shift), std::move(made));
}

Mask knownOf(const openvdb::FloatGrid& distance, const DistanceFitOptions& options) {
    assert(0 < options.band && options.band <= options.halfWidth);
    if (distance.background() < 0)
        throw InputError(distance.getName(), "everything far away is inside; a solid must be finite");
    return knownAround(nodesNear(distance.constTree(), static_cast<float>(options.band)));
}

BSplineField fitted(const openvdb::FloatGrid& distance, openvdb::FloatGrid* givenUp,
                    const DistanceFitOptions& options, FitReport* report, const Progress& progress) {
    progress("fitting", 0);
    Mask known = knownOf(distance, options);
    const openvdb::Coord shift = moveOrigin(known);
    BSplineField field = interpolatedDistances(distance, givenUp, std::move(known), shift, options);
    if (options.adjust && !givenUp) options.adjust(field, shift);
    const double w = options.halfWidth;
    finish(field, kDistanceFloor / w, kDistanceTarget / w, options.mostRepairPasses, {}, report, progress);
    return field;
}

}  // namespace

BSplineField fitBinary(const NodeCollection& nodes, const BinaryFitOptions& options, FitReport* report,
                       const Progress& progress) {
    progress("fitting", 0);
    Mask known = knownOf(nodes);
    const openvdb::Coord shift = moveOrigin(known);
    BSplineField field = smoothedSigns(nodes, known, shift, options, progress);
    FitReport result;
    result.filterPasses = options.passes;
    finish(field, kBinaryFloor, kBinaryTarget, options.mostRepairPasses, result, report, progress);
    return field;
}

BSplineField fitDistance(const openvdb::FloatGrid& distance, const DistanceFitOptions& options,
                         FitReport* report, const Progress& progress) {
    return fitted(distance, nullptr, options, report, progress);
}

BSplineField fitDistance(openvdb::FloatGrid::Ptr&& distance, const DistanceFitOptions& options,
                         FitReport* report, const Progress& progress) {
    const openvdb::FloatGrid::Ptr owned = std::move(distance);
    return fitted(*owned, owned.get(), options, report, progress);
}

BSplineField fitBinaryPart(const NodeCollection& nodes, const BinaryFitOptions& options,
                           const openvdb::CoordBBox& box, PartRepair& repair, const Progress& progress) {
    BSplineField part = smoothedSigns(nodes, knownOf(nodes), openvdb::Coord(0), options, progress);
    repair = finishPart(part, kBinaryFloor, kBinaryTarget, options.mostRepairPasses, box, progress);
    return part;
}

BSplineField fitDistancePart(openvdb::FloatGrid::Ptr&& distance, const DistanceFitOptions& options,
                             const openvdb::CoordBBox& box, PartRepair& repair, const Progress& progress) {
    const openvdb::FloatGrid::Ptr owned = std::move(distance);
    BSplineField part =
        interpolatedDistances(*owned, owned.get(), knownOf(*owned, options), openvdb::Coord(0), options);
    const double w = options.halfWidth;
    repair =
        finishPart(part, kDistanceFloor / w, kDistanceTarget / w, options.mostRepairPasses, box, progress);
    return part;
}

}  // namespace isowave
