// One column of leaves while it is transformed: the intervals of its lines, and which of its lattice points
// are known.
//
// Positions within a column are counted from the first fine leaf of an even index that lies at least one leaf
// before the column's first, so that coarse position = fine position / 2 and accessory points have a place.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/leaf_words.h"
#include "volume/vdb.h"
#include "wavelets/columns.h"
#include "wavelets/interval/runs.h"
#include "wavelets/line_plan.h"

namespace isowave::wavelets {

using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using FloatLeaf = openvdb::FloatTree::LeafNodeType;
// Accessors that are not registered with their trees: registering costs more than the few lookups, and the
// trees do not change while an accessor lives.
using ShapeAccessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree, false>;
using FloatAccessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

// Its memory is kept from one column to the next.
class ColumnLines {
  public:
    // Finds the column's leaves without reading them, so that they can be prefetched meanwhile.
    // REQUIRES: `column` outlives the calls below.
    void findLeaves(const Column& column, int axis);
    // Throws InputError where a run is shorter than four points.
    void plan(const ShapeAccessor& shape);

    // Calls f(line, Interval) for each.
    template <class F>
    void forEachInterval(const F& f) const {
        plan_.forEachInterval([&](const LineRun& i) { f(i.line, Interval{i.first, i.last}); });
    }

    int fineLeafCount() const { return static_cast<int>(fineLeaves_.size()); }
    int coarseLeafCount() const { return fineLeafCount() / 2; }
    openvdb::Coord fineOrigin(int k) const { return column_->origin(axis_, firstLeaf_ + k); }
    openvdb::Coord coarseOrigin(int k) const { return column_->origin(axis_, firstLeaf_ / 2 + k); }

    const BoolLeaf* fineLeaf(int k) const { return fineLeaves_[k]; }  // null: none
    // REQUIRES: there is one.
    LeafWords fineKnown(int k) const { return wordsOf(fineLeaves_[k]->getValueMask()); }
    LeafWords fineInside(int k) const;
    bool inside(int line, std::int64_t position) const;

    // By leaf of the coarse column; bits in a leaf's order.
    bool knowsAny(int k) const { return !isEmpty(plan_.coarseKnown(k)); }
    LeafWords coarseKnown(int k) const { return wordsOfLines(plan_.coarseKnown(k), axis_); }
    LeafWords stored(int k) const { return wordsOfLines(plan_.stored(k), axis_); }
    // The signs of a coarse column are those of the even fine positions.
    LeafWords coarseInside(int k) const {
        return evenPositions(fineInside(2 * k), fineInside(2 * k + 1), axis_);
    }

  private:
    const Column* column_ = nullptr;
    int axis_ = 0;
    std::int64_t firstLeaf_ = 0;
    std::vector<const BoolLeaf*> fineLeaves_;  // an even number
    std::vector<bool> insideWithoutLeaf_;
    std::vector<LeafLines> known_;
    LinePlan plan_;
};

}  // namespace isowave::wavelets
