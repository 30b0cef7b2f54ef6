#include "volume/fit.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <vector>

#include "isowave/error.h"
#include "volume/leaf_words.h"
#include "volume/padded_leaf.h"
#include "volume/tiles.h"

// Passes of both fits:
//   known   kept nodes -> their corners -> dilated by one: G + {-1,0,1,2} on each axis
//   origin  the lattice's origin moved so that no control point lies below -1
//   shape   the input's sign at every lattice point, in leaves and tiles
//   weigh   control points on I (±K, or quasi-interpolated distances)
//   smooth  (binary only) Laplacian passes
//   repair  until every lattice point of I has the input's sign by a margin
// invariant of weigh, smooth and repair: what is not known stays ±K.

namespace isowave {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using Mask = openvdb::MaskTree;
using MaskLeaf = Mask::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

// ---- known

// The lattice points that are corners of a kept node: voxel i is one when a node of i - {0,1}^3 is kept.
Mask cornersOf(const Mask& nodes) {
    Mask corners;
    openvdb::tree::ValueAccessor<Mask> toTouch(corners);
    for (auto leaf = nodes.cbeginLeaf(); leaf; ++leaf)
        for (int b = 0; b < 8; ++b)
            toTouch.touchLeaf(leaf->origin().offsetBy(8 * (b >> 2), 8 * ((b >> 1) & 1), 8 * (b & 1)));
    openvdb::tree::LeafManager<Mask> leaves(corners);
    leaves.foreach ([&nodes](MaskLeaf& leaf, std::size_t) {
        ConstAccessor<Mask> accessor(nodes);
        PaddedLeaf<bool, 1, 0> kept;
        kept.gather(accessor, leaf.origin(),
                    [](const MaskLeaf& l, openvdb::Index o) { return l.isValueOn(o); });
        LeafWords corner{};
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                const auto row = [&](int dx, int dy) { return &kept.values[kept.index(x - dx, y - dy, 0)]; };
                const bool *a = row(0, 0), *b = row(0, 1), *c = row(1, 0), *d = row(1, 1);
                for (int z = 0; z < 8; ++z) {
                    const bool any = a[z] | b[z] | c[z] | d[z] | a[z - 1] | b[z - 1] | c[z - 1] | d[z - 1];
                    corner[x] |= std::uint64_t(any) << (8 * y + z);
                }
            }
        leaf.setValueMask(maskOf(corner));
    });
    return corners;
}

// I = G dilated by {-1,0,1,2} on each axis = corners of G dilated by {-1,0,1}.
Mask knownAround(const Mask& nodes) {
    Mask known = cornersOf(nodes);
    openvdb::tools::dilateActiveValues(known, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    known.voxelizeActiveTiles();
    // Leaves without a single known point would only cost memory.
    std::vector<openvdb::Coord> empty;
    for (auto leaf = known.cbeginLeaf(); leaf; ++leaf)
        if (leaf->isEmpty()) empty.push_back(leaf->origin());
    for (const auto& origin : empty) known.addTile(1, origin, false, false);
    return known;
}

// ---- origin

// Halving a domain that lies at -1 and above ends at one node, control points -1 .. 2. One that straddles the
// origin ends at -2 .. 2, two nodes, for ever. So the lattice is shifted, by whole leaves, until nothing lies
// below -1. Returns the shift: lattice point i of the source is lattice point i + shift of the field.
openvdb::Coord moveOrigin(Mask& known) {
    openvdb::CoordBBox box;
    known.evalActiveVoxelBoundingBox(box);
    openvdb::Coord shift(0);
    if (known.empty()) return shift;
    for (int a = 0; a < 3; ++a)
        if (box.min()[a] < -1) shift[a] = -(box.min()[a] & ~7);
    if (shift == openvdb::Coord(0)) return shift;
    std::vector<MaskLeaf*> leaves;
    known.stealNodes(leaves);
    Mask moved;
    for (MaskLeaf* leaf : leaves) {
        leaf->setOrigin(leaf->origin() + shift);
        moved.addLeaf(leaf);
    }
    known.clear();
    known.merge(moved);
    return shift;
}

openvdb::math::Transform::Ptr shiftedTransform(const openvdb::math::Transform& transform,
                                               const openvdb::Coord& shift) {
    auto result = transform.copy();
    result->preTranslate(-shift.asVec3d());
    return result;
}

// ---- shape

// Signs of distances, and of a grid that holds signs.
bool isInside(float distance) { return distance < 0; }
bool isInside(bool inside) { return inside; }
LeafWords signsOf(const FloatLeaf& leaf) { return negativeWordsOf(leaf.buffer().data()); }
LeafWords signsOf(const BoolLeaf& leaf) { return insideWordsOf(leaf); }

// The signs of a source, a tree in its own coordinates (lattice point i of the source is i + shift of the
// field; shift is whole leaves), for one thread: of one lattice point of the field, and of a leaf.
template <class Tree>
class Signs {
  public:
    Signs(const Tree& source, const openvdb::Coord& shift) : accessor_(source), shift_(shift) {}
    bool operator()(const openvdb::Coord& c) const { return isInside(accessor_.getValue(c - shift_)); }
    LeafWords leaf(const openvdb::Coord& origin) const {
        if (const auto* there = accessor_.probeConstLeaf(origin - shift_)) return signsOf(*there);
        LeafWords words;
        words.fill((*this)(origin) ? ~std::uint64_t{0} : 0);
        return words;
    }

  private:
    ConstAccessor<Tree> accessor_;
    openvdb::Coord shift_;
};

// makeInside() returns the signs of the source for one thread; source: a tree, in its own coordinates, whose
// root regions cover every inside region.
template <class Source, class MakeInside>
Shape::Ptr makeShape(const Mask& known, const Source& source, const openvdb::Coord& shift,
                     const MakeInside& makeInside) {
    auto shape = Shape::create(false);
    shape->setTree(std::make_shared<openvdb::BoolTree>(known, false, false, openvdb::TopologyCopy()));
    openvdb::tree::LeafManager<openvdb::BoolTree> leaves(shape->tree());
    leaves.foreach (
        [&makeInside](BoolLeaf& leaf, std::size_t) { setInside(leaf, makeInside().leaf(leaf.origin())); });
    fillTiles(shape->tree(), makeInside);
    fillRootTiles(
        shape->tree(), source, [&shift](const openvdb::Coord& c) { return c + shift; }, makeInside);
    return shape;
}

// Control points of +-K by sign everywhere, active on I.
BSplineField makeField(Shape::Ptr shape, double K, const openvdb::math::Transform& transform) {
    BSplineField field;
    field.K = K;
    field.shape = std::move(shape);
    field.shape->setTransform(transform.copy());
    const auto k = static_cast<float>(K);
    field.controlPoints = openvdb::FloatGrid::create(k);
    field.controlPoints->setTree(
        std::make_shared<openvdb::FloatTree>(field.shape->tree(), k, k, openvdb::TopologyCopy()));
    field.controlPoints->setTransform(transform.copy());
    field.controlPoints->setName("field");
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(field.controlPoints->tree());
    const openvdb::BoolTree& signs = field.shape->tree();
    leaves.foreach ([&signs, k](FloatLeaf& leaf, std::size_t) {
        fillBySign(insideWordsOf(*signs.probeConstLeaf(leaf.origin())), k, leaf.buffer().data());
    });
    fillInsideTiles(field.controlPoints->tree(), signs, -1, -k);
    return field;
}

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

// ---- repair

// While a lattice point of I has s F < floor: its control point c <- c + target s - F. A change by delta
// moves F there by (2/3)^3 delta. A pass looks at the leaves whose neighbourhood the last one changed, and
// changes them all at once: few after the first, so that what it costs is the first.
class Repair {
  public:
    // floor, target: fractions of K.
    Repair(BSplineField& field, double floor, double target)
        : field_(field),
          leaves_(field.controlPoints->tree()),
          floor_(floor * field.K),
          target_(target * field.K) {}

    void run(int mostPasses, FitReport& report, const Progress& progress) {
        std::vector<openvdb::Index32> active(leaves_.leafCount());
        std::iota(active.begin(), active.end(), 0);
        leaves_.foreach ([](FloatLeaf& leaf, std::size_t i) {
            leaf.setTransientData(static_cast<openvdb::Index32>(i));  // for neighboursOf()
        });
        report.repairFloor = floor_ / field_.K;
        report.repairAgreed = false;
        while (report.repairPasses < mostPasses) {
            progress.check();
            const Changes changes = wanted(active);
            std::int64_t count = 0;
            for (const auto& [leaf, values] : changes) count += static_cast<std::int64_t>(values.size());
            report.repairAgreed = count == 0;
            if (report.repairAgreed) return;
            apply(changes);
            report.repaired += count;
            ++report.repairPasses;
            active = neighboursOf(changes);
        }
    }

  private:
    struct Change {
        openvdb::Index offset;
        float value;
    };
    struct LeafChanges {
        openvdb::Index32 leaf;
        std::vector<Change> values;
    };
    using Changes = std::vector<LeafChanges>;  // by leaf, without empty ones

    // Where values in a leaf's order lie on the wrong side of the floor for the sign that the shape asks for.
    LeafWords tooSmall(const std::array<double, 512>& F, const LeafWords& inside) const {
        LeafWords words{};
        for (int x = 0; x < 8; ++x) {
            std::uint64_t below = 0, above = 0;
            for (int i = 0; i < 64; ++i) below |= std::uint64_t(F[64 * x + i] < floor_) << i;
            for (int i = 0; i < 64; ++i) above |= std::uint64_t(-F[64 * x + i] < floor_) << i;
            words[x] = (inside[x] & above) | (~inside[x] & below);
        }
        return words;
    }

    std::vector<Change> wantedIn(const FloatLeaf& leaf) const {
        ConstAccessor<openvdb::FloatTree> accessor(field_.controlPoints->constTree());
        PaddedLeaf<double, 1, 1> c;
        c.gather(accessor, leaf.origin());
        std::array<double, 512> F;
        filterThreeTaps(c, 4.0 / 6, 1.0 / 6, F);
        const LeafWords inside = insideWordsOf(*field_.shape->constTree().probeConstLeaf(leaf.origin()));
        const LeafWords known = wordsOf(leaf.getValueMask()), small = tooSmall(F, inside);
        std::vector<Change> changes;
        for (int x = 0; x < 8; ++x)
            for (std::uint64_t bits = known[x] & small[x]; bits; bits &= bits - 1) {
                const int i = std::countr_zero(bits), offset = 64 * x + i;
                const double s = inside[x] >> i & 1 ? -1 : 1;
                const auto at = static_cast<openvdb::Index>(offset);
                changes.push_back({at, static_cast<float>(leaf.getValue(at) + target_ * s - F[offset])});
            }
        return changes;
    }

    Changes wanted(const std::vector<openvdb::Index32>& active) const {
        Changes all(active.size());
        tbb::parallel_for(std::size_t(0), active.size(), [&](std::size_t i) {
            all[i] = {active[i], wantedIn(leaves_.leaf(active[i]))};
        });
        std::erase_if(all, [](const LeafChanges& leaf) { return leaf.values.empty(); });
        return all;
    }

    void apply(const Changes& changes) {
        tbb::parallel_for(std::size_t(0), changes.size(), [&](std::size_t i) {
            FloatLeaf& leaf = leaves_.leaf(changes[i].leaf);
            for (const auto [offset, value] : changes[i].values) leaf.setValueOnly(offset, value);
        });
    }

    // The leaves that changed and those beside them, in order.
    std::vector<openvdb::Index32> neighboursOf(const Changes& changes) const {
        ConstAccessor<openvdb::FloatTree> accessor(field_.controlPoints->constTree());
        std::vector<openvdb::Index32> near;
        for (const auto& change : changes) {
            const openvdb::Coord origin = leaves_.leaf(change.leaf).origin();
            for (int b = 0; b < 27; ++b)
                if (const auto* leaf = accessor.probeConstLeaf(
                        origin.offsetBy(8 * (b / 9 - 1), 8 * (b / 3 % 3 - 1), 8 * (b % 3 - 1))))
                    near.push_back(leaf->transientData());
        }
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        return near;
    }

    BSplineField& field_;
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves_;
    double floor_, target_;
};

// Compares the sign of F with the input's at every lattice point where a known control point has a say: I
// dilated by one. Beyond it F is ±K exactly.
void countDisagreement(const BSplineField& field, FitReport& report) {
    Mask reach(field.shape->tree(), false, openvdb::TopologyCopy());
    openvdb::tools::dilateActiveValues(reach, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    reach.voxelizeActiveTiles();
    std::atomic<std::int64_t> points{0}, disagreeing{0};
    openvdb::tree::LeafManager<Mask> leaves(reach);
    leaves.foreach ([&](MaskLeaf& leaf, std::size_t) {
        ConstAccessor<openvdb::FloatTree> accessor(field.controlPoints->constTree());
        const Signs signs(field.shape->constTree(), openvdb::Coord(0));
        PaddedLeaf<double, 1, 1> c;
        c.gather(accessor, leaf.origin());
        std::array<double, 512> F;
        filterThreeTaps(c, 4.0 / 6, 1.0 / 6, F);
        const LeafWords inside = signs.leaf(leaf.origin()), reached = wordsOf(leaf.getValueMask()),
                        negative = negativeWordsOf(F.data());
        std::int64_t here = 0, wrong = 0;
        for (int x = 0; x < 8; ++x) {
            here += std::popcount(reached[x]);
            wrong += std::popcount(reached[x] & (inside[x] ^ negative[x]));
        }
        points += here;
        disagreeing += wrong;
    });
    report.latticePoints = points;
    report.disagreeing = disagreeing;
}

// E§2 asks for the sign only; the margin keeps every node stabbed when the field is next filtered or stored.
constexpr double kBinaryFloor = 0.05, kBinaryTarget = 0.1;

// A distance fit is right to a hundredth of a voxel where it disagrees at all, so it is moved as little as
// will do: floor and target in voxels.
constexpr double kDistanceFloor = 1e-4, kDistanceTarget = 2e-4;

// result: what is known so far; report: where all of it goes, nullptr if nobody asks for it. Counting takes a
// quarter of a fit.
void finish(BSplineField& field, double floor, double target, int mostPasses, FitReport result,
            FitReport* report, const Progress& progress) {
    progress("fitting", 0.5);
    Repair(field, floor, target).run(mostPasses, result, progress);
    if (report) {
        countDisagreement(field, result);
        *report = result;
    }
    progress("fitting", 1);
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

}  // namespace

BSplineField fitBinary(const NodeCollection& nodes, const BinaryFitOptions& options, FitReport* report,
                       const Progress& progress) {
    progress("fitting", 0);
    const openvdb::BoolTree& signs = nodes.grid->constTree();
    const Mask kept(signs, false, openvdb::TopologyCopy());
    Mask known = knownAround(kept);
    const openvdb::Coord shift = moveOrigin(known);
    const auto makeInside = [&signs, &shift] { return Signs(signs, shift); };
    BSplineField field = makeField(makeShape(known, signs, shift, makeInside), options.K,
                                   *shiftedTransform(nodes.grid->transform(), shift));
    FitReport result;
    if (options.passes > 0) {
        openvdb::tree::LeafManager<openvdb::FloatTree> leaves(field.controlPoints->tree(), 1);
        for (; result.filterPasses < options.passes; ++result.filterPasses) {
            progress("fitting", 0.5 * result.filterPasses / options.passes);
            laplacianPass(leaves, field.controlPoints->constTree());
        }
    }
    finish(field, kBinaryFloor, kBinaryTarget, options.mostRepairPasses, result, report, progress);
    return field;
}

BSplineField fitDistance(const openvdb::FloatGrid& distance, const DistanceFitOptions& options,
                         FitReport* report, const Progress& progress) {
    assert(0 < options.band && options.band <= options.halfWidth);
    if (distance.background() < 0)
        throw InputError(distance.getName(), "everything far away is inside; a solid must be finite");
    progress("fitting", 0);
    const openvdb::FloatTree& d = distance.constTree();
    Mask known = knownAround(nodesNear(d, static_cast<float>(options.band)));
    const openvdb::Coord shift = moveOrigin(known);
    const auto makeInside = [&d, &shift] { return Signs(d, shift); };
    BSplineField field = makeField(makeShape(known, d, shift, makeInside), options.K,
                                   *shiftedTransform(distance.transform(), shift));

    // Quasi-interpolation: on each axis c = (8 v_i - v_{i-1} - v_{i+1})/6, exact for cubics.
    const double w = options.halfWidth, scale = options.K / w;
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(field.controlPoints->tree());
    leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
        ConstAccessor<openvdb::FloatTree> accessor(d);
        PaddedLeaf<double, 1, 1> v;
        v.gather(accessor, leaf.origin() - shift);
        for (double& x : v.values) x = scale * std::clamp(x, -w, w);
        std::array<double, 512> c;
        filterThreeTaps(v, 8.0 / 6, -1.0 / 6, c);
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
            leaf.setValueOnly(voxel.pos(), static_cast<float>(c[voxel.pos()]));
    });
    if (options.adjust) options.adjust(field, shift);
    finish(field, kDistanceFloor / w, kDistanceTarget / w, options.mostRepairPasses, {}, report, progress);
    return field;
}

}  // namespace isowave
