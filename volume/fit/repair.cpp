#include "volume/fit/repair.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>
#include <vector>

#include "volume/fit/known.h"
#include "volume/leaf_words.h"
#include "volume/padded_leaf.h"

namespace isowave::fitting {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using Mask = openvdb::MaskTree;
using MaskLeaf = Mask::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

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
        report.repairFloor = floor_ / field_.K;
        report.repairAgreed = false;
        passes(mostPasses, progress, [&](const Changes& changes) {
            const std::int64_t count = countIn(changes, nullptr);
            report.repairAgreed = count == 0;
            report.repaired += count;
            report.repairPasses += count > 0;
        });
    }

    std::vector<std::int64_t> runPart(int mostPasses, const openvdb::CoordBBox& box,
                                      const Progress& progress) {
        std::vector<std::int64_t> repaired;
        passes(mostPasses, progress,
               [&](const Changes& changes) { repaired.push_back(countIn(changes, &box)); });
        return repaired;
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

    // Calls tell(changes) in each pass, before they are made, in the last one there are none.
    template <class Tell>
    void passes(int most, const Progress& progress, const Tell& tell) {
        std::vector<openvdb::Index32> active(leaves_.leafCount());
        std::iota(active.begin(), active.end(), 0);
        leaves_.foreach ([](FloatLeaf& leaf, std::size_t i) {
            leaf.setTransientData(static_cast<openvdb::Index32>(i));  // for neighboursOf()
        });
        for (int pass = 0; pass < most; ++pass) {
            progress.check();
            const Changes changes = wanted(active);
            tell(changes);
            if (changes.empty()) return;
            apply(changes);
            active = neighboursOf(changes);
        }
    }

    // box: of whole leaves; null: everywhere.
    std::int64_t countIn(const Changes& changes, const openvdb::CoordBBox* box) const {
        std::int64_t count = 0;
        for (const auto& [leaf, values] : changes)
            if (!box || box->isInside(leaves_.leaf(leaf).origin()))
                count += static_cast<std::int64_t>(values.size());
        return count;
    }

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
// dilated by one. Beyond it F is ±K exactly. box: of whole leaves; null: everywhere.
struct Disagreement {
    std::int64_t points = 0, disagreeing = 0;
};
Disagreement disagreementOf(const BSplineField& field, const openvdb::CoordBBox* box) {
    Mask reach(field.shape->tree(), false, openvdb::TopologyCopy());
    openvdb::tools::dilateActiveValues(reach, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    reach.voxelizeActiveTiles();
    std::atomic<std::int64_t> points{0}, disagreeing{0};
    openvdb::tree::LeafManager<Mask> leaves(reach);
    leaves.foreach ([&](MaskLeaf& leaf, std::size_t) {
        if (box && !box->isInside(leaf.origin())) return;
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
    return {points, disagreeing};
}

}  // namespace

void finish(BSplineField& field, double floor, double target, int mostPasses, FitReport result,
            FitReport* report, const Progress& progress) {
    progress("fitting", 0.5);
    Repair(field, floor, target).run(mostPasses, result, progress);
    if (report) {
        const Disagreement found = disagreementOf(field, nullptr);
        result.latticePoints = found.points;
        result.disagreeing = found.disagreeing;
        *report = result;
    }
    progress("fitting", 1);
}

PartRepair finishPart(BSplineField& part, double floor, double target, int mostPasses,
                      const openvdb::CoordBBox& box, const Progress& progress) {
    PartRepair repair;
    repair.repaired = Repair(part, floor, target).runPart(mostPasses, box, progress);
    const Disagreement found = disagreementOf(part, &box);
    repair.latticePoints = found.points;
    repair.disagreeing = found.disagreeing;
    return repair;
}

}  // namespace isowave::fitting
