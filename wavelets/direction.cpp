#include "wavelets/direction.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <span>

#include "base/error.h"
#include "volume/tiles.h"
#include "wavelets/columns.h"
#include "wavelets/interval.h"

// Both directions of the transform run the same passes on each column of leaves:
//   runs       the known positions of a line, from the shape's masks
//   intervals  runs -> odd-ended, joined intervals (interval.h)
//   transform  each interval, with the accessory values of the regions around it
//   finish     what is not known: ±K by sign, in leaves and in tiles
// Leaves are made by the thread that owns the column and hung into the tree by one thread at the end.

namespace isowave::wavelets {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using ShapeColumns = LeafColumns<openvdb::BoolTree>;
using FieldColumns = LeafColumns<openvdb::FloatTree>;

// Scratch of one thread.
struct Lines {
    IntervalTransform transform;
    std::vector<Run> runs;
    std::vector<Interval> intervals;
    std::vector<double> fine, coarse, detail;

    void resizeFor(const Interval& interval) {
        fine.resize(static_cast<std::size_t>(interval.fineSize()));
        coarse.resize(static_cast<std::size_t>(interval.coarseSize()));
        detail.resize(static_cast<std::size_t>(interval.detailSize()));
    }
};

// A fine column with what lies around it: the sign of every position from two leaves before its first leaf to
// two leaves behind its last one, in leaves and in the tiles between them.
class SignedColumn {
  public:
    SignedColumn(const ShapeColumns::Column& column, const openvdb::BoolTree& shape, int axis)
        : column_(&column), firstTile_(column.first - 2) {
        openvdb::tree::ValueAccessor<const openvdb::BoolTree> accessor(shape);
        for (std::int64_t k = firstTile_; k < column.end() + 2; ++k)
            tileInside_.push_back(column.at(k) == nullptr && accessor.getValue(column.origin(axis, k)));
    }

    const ShapeColumns::Column& column() const { return *column_; }

    bool inside(std::int64_t position, int start, int stride) const {
        const std::int64_t k = position >> kLeafLog2;
        if (const BoolLeaf* leaf = column_->at(k))
            return leaf->getValue(static_cast<openvdb::Index>(start + (position & 7) * stride));
        return tileInside_[static_cast<std::size_t>(k - firstTile_)];
    }
    bool known(std::int64_t position, int start, int stride) const {
        const BoolLeaf* leaf = column_->at(position >> kLeafLog2);
        return leaf && leaf->isValueOn(static_cast<openvdb::Index>(start + (position & 7) * stride));
    }

  private:
    const ShapeColumns::Column* column_;
    std::int64_t firstTile_;
    std::vector<bool> tileInside_;
};

[[noreturn]] void refuseShortRun(const ShapeColumns::Column& column, int axis, const Run& run) {
    throw InputError(
        "shape", fmt::format("a run of {} control points along {} at position {} near ({}, {}); a field's "
                             "known control points are a union of 4x4x4 blocks, so runs are 4 or longer",
                             run.last - run.first + 1, "xyz"[axis], run.first, column.u, column.v));
}

void collectRuns(const ShapeColumns::Column& column, int axis, int start, int stride,
                 std::vector<Run>& runs) {
    runs.clear();
    bool open = false;
    for (std::size_t k = 0; k < column.leaves.size(); ++k) {
        const BoolLeaf* leaf = column.leaves[k];
        const std::int64_t base = (column.first + static_cast<std::int64_t>(k)) * kLeafDim;
        for (int i = 0; i < kLeafDim; ++i) {
            const bool known = leaf && leaf->isValueOn(static_cast<openvdb::Index>(start + i * stride));
            if (known && !open) runs.push_back({base + i, base + i});
            if (known) runs.back().last = base + i;
            open = known;
        }
    }
    for (const Run& run : runs)
        if (run.last - run.first + 1 < 4) refuseShortRun(column, axis, run);
}

// Leaves along one column, made when first written to.
template <class Leaf>
class NewColumn {
  public:
    using Value = typename Leaf::ValueType;

    void set(const ShapeColumns::Column& like, int axis, std::int64_t position, int start, int stride,
             Value value) {
        const std::int64_t k = position >> kLeafLog2;
        if (leaves_.empty()) first_ = k;
        for (; k < first_; --first_) leaves_.insert(leaves_.begin(), nullptr);
        while (k >= first_ + static_cast<std::int64_t>(leaves_.size())) leaves_.push_back(nullptr);
        auto& leaf = leaves_[static_cast<std::size_t>(k - first_)];
        if (!leaf) leaf = std::make_unique<Leaf>(like.origin(axis, k), Value(0), false);
        leaf->setValueOn(static_cast<openvdb::Index>(start + (position & 7) * stride), value);
    }

    // Calls f(k, leaf) for every leaf that was made.
    template <class F>
    void each(const F& f) {
        for (std::size_t i = 0; i < leaves_.size(); ++i)
            if (leaves_[i]) f(first_ + static_cast<std::int64_t>(i), *leaves_[i]);
    }
    template <class Tree>
    void hangInto(Tree& tree) {
        for (auto& leaf : leaves_)
            if (leaf) tree.addLeaf(leaf.release());
        leaves_.clear();
    }

  private:
    std::int64_t first_ = 0;
    std::vector<std::unique_ptr<Leaf>> leaves_;
};

// What one fine column becomes.
struct CoarseColumn {
    NewColumn<FloatLeaf> controlPoints, details;
    std::vector<std::unique_ptr<BoolLeaf>> shape;
};

// ---- analysis of one column -----------------------------------------------------------------------------

// One line: its intervals analysed, their coarse control points and details filed.
void analyseLine(const SignedColumn& fine, const FieldColumns::Column& values, int axis, int start,
                 int stride, float K, Lines& lines, CoarseColumn& out) {
    collectRuns(fine.column(), axis, start, stride, lines.runs);
    joinRuns(lines.runs, lines.intervals);
    const auto accessory = [&](std::int64_t position) {
        return fine.inside(position, start, stride) ? -double(K) : double(K);
    };
    for (const Interval& interval : lines.intervals) {
        lines.resizeFor(interval);
        for (std::int64_t p = interval.first; p <= interval.last; ++p) {
            const FloatLeaf* leaf = values.at(p >> kLeafLog2);
            const auto offset = static_cast<openvdb::Index>(start + (p & 7) * stride);
            const bool known = leaf && leaf->isValueOn(offset);
            lines.fine[static_cast<std::size_t>(p - interval.first)] =
                known ? leaf->getValue(offset) : accessory(p);
        }
        lines.transform.analyse(lines.fine, accessory(interval.first - 1), accessory(interval.last + 1),
                                lines.coarse, lines.detail);
        for (std::size_t j = 0; j < lines.coarse.size(); ++j)
            out.controlPoints.set(fine.column(), axis, interval.firstCoarse() + static_cast<std::int64_t>(j),
                                  start, stride, static_cast<float>(lines.coarse[j]));
        for (std::size_t k = 0; k < lines.detail.size(); ++k)
            out.details.set(fine.column(), axis, interval.firstDetail() + static_cast<std::int64_t>(k), start,
                            stride, static_cast<float>(lines.detail[k]));
    }
}

// The signs of a coarse column are those of the even fine positions; unknown control points become ±K.
void finishCoarseColumn(const SignedColumn& fine, const LineLayout& layout, float K, CoarseColumn& out) {
    out.controlPoints.each([&](std::int64_t k, FloatLeaf& leaf) {
        auto shape = std::make_unique<BoolLeaf>(leaf.origin(), false, false);
        for (const int start : layout.start)
            for (int i = 0; i < kLeafDim; ++i) {
                const auto offset = static_cast<openvdb::Index>(start + i * layout.stride);
                const bool inside = fine.inside(2 * (k * kLeafDim + i), start, layout.stride);
                shape->setValueOnly(offset, inside);
                if (!leaf.isValueOn(offset)) leaf.setValueOnly(offset, inside ? -K : K);
            }
        shape->setValueMask(leaf.getValueMask());
        out.shape.push_back(std::move(shape));
    });
}

CoarseColumn analyseColumn(const ShapeColumns::Column& column, const FieldColumns::Column& values,
                           const openvdb::BoolTree& shape, int axis, const LineLayout& layout, float K,
                           Lines& lines) {
    const SignedColumn fine(column, shape, axis);
    CoarseColumn out;
    for (const int start : layout.start) analyseLine(fine, values, axis, start, layout.stride, K, lines, out);
    finishCoarseColumn(fine, layout, K, out);
    return out;
}

// ---- synthesis of one column ----------------------------------------------------------------------------

double valueOrRefuse(const FieldColumns::Column* column, std::int64_t position, int start, int stride,
                     const char* what) {
    const FloatLeaf* leaf = column ? column->at(position >> kLeafLog2) : nullptr;
    const auto offset = static_cast<openvdb::Index>(start + (position & 7) * stride);
    if (!leaf || !leaf->isValueOn(offset))
        throw InputError("pyramid",
                         fmt::format("no {} at position {} although the step's shape needs one; the parts "
                                     "of the pyramid do not belong together",
                                     what, position));
    return leaf->getValue(offset);
}

std::vector<std::unique_ptr<FloatLeaf>> synthesiseColumn(const ShapeColumns::Column& column,
                                                         const FieldColumns::Column* coarse,
                                                         const FieldColumns::Column* details,
                                                         const openvdb::BoolTree& shape, int axis,
                                                         const LineLayout& layout, float K, Lines& lines) {
    const SignedColumn fine(column, shape, axis);
    std::vector<std::unique_ptr<FloatLeaf>> out(column.leaves.size());
    for (std::size_t k = 0; k < out.size(); ++k) {
        const BoolLeaf* leaf = column.leaves[k];
        if (!leaf) continue;
        out[k] = std::make_unique<FloatLeaf>(leaf->origin(), K, false);
        for (auto inside = leaf->cbeginValueAll(); inside; ++inside)
            if (*inside) out[k]->setValueOnly(inside.pos(), -K);
        out[k]->setValueMask(leaf->getValueMask());
    }
    const auto accessory = [&](std::int64_t position, int start) {
        return fine.inside(position, start, layout.stride) ? -double(K) : double(K);
    };
    for (const int start : layout.start) {
        collectRuns(column, axis, start, layout.stride, lines.runs);
        joinRuns(lines.runs, lines.intervals);
        for (const Interval& interval : lines.intervals) {
            lines.resizeFor(interval);
            for (std::size_t j = 0; j < lines.coarse.size(); ++j)
                lines.coarse[j] = valueOrRefuse(coarse, interval.firstCoarse() + static_cast<std::int64_t>(j),
                                                start, layout.stride, "control point");
            for (std::size_t k = 0; k < lines.detail.size(); ++k)
                lines.detail[k] =
                    valueOrRefuse(details, interval.firstDetail() + static_cast<std::int64_t>(k), start,
                                  layout.stride, "detail");
            lines.transform.synthesise(lines.coarse, lines.detail, accessory(interval.first - 1, start),
                                       accessory(interval.last + 1, start), lines.fine);
            for (std::int64_t p = interval.first; p <= interval.last; ++p)
                if (fine.known(p, start, layout.stride))
                    out[static_cast<std::size_t>((p >> kLeafLog2) - column.first)]->setValueOnly(
                        static_cast<openvdb::Index>(start + (p & 7) * layout.stride),
                        static_cast<float>(lines.fine[static_cast<std::size_t>(p - interval.first)]));
        }
    }
    return out;
}

// ---- columns in parallel --------------------------------------------------------------------------------

template <class Work>
void forEachColumn(std::size_t count, const Progress& progress, const Work& work) {
    tbb::enumerable_thread_specific<Lines> scratch;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4), [&](const auto& range) {
        progress.check();
        Lines& lines = scratch.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i) work(i, lines);
    });
}

openvdb::math::Transform::Ptr scaledAlong(const openvdb::math::Transform& transform, int axis,
                                          double factor) {
    openvdb::Vec3d scale(1.0);
    scale[axis] = factor;
    auto result = transform.copy();
    result->preScale(scale);
    return result;
}

}  // namespace

DirectionResult analyseDirection(const BSplineField& fine, int axis, const Progress& progress) {
    const auto K = static_cast<float>(fine.K);
    const LineLayout layout(axis);
    const openvdb::BoolTree& fineShape = fine.shape->tree();
    const ShapeColumns columns(fineShape, axis);
    const FieldColumns values(fine.controlPoints->tree(), axis);

    std::vector<CoarseColumn> made(columns.columns().size());
    const FieldColumns::Column none;
    forEachColumn(made.size(), progress, [&](std::size_t i, Lines& lines) {
        const auto& column = columns.columns()[i];
        const auto* known = values.find(column.u, column.v);
        made[i] = analyseColumn(column, known ? *known : none, fineShape, axis, layout, K, lines);
    });

    DirectionResult result;
    result.coarse.K = fine.K;
    result.coarse.controlPoints = openvdb::FloatGrid::create(K);
    result.coarse.shape = Shape::create(false);
    result.details = DetailGrid::create(0.0f);
    for (auto& column : made) {
        column.controlPoints.hangInto(result.coarse.controlPoints->tree());
        column.details.hangInto(result.details->tree());
        for (auto& leaf : column.shape) result.coarse.shape->tree().addLeaf(leaf.release());
    }

    const auto insideHere = [&fineShape, axis] {
        return [accessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>(fineShape),
                axis](openvdb::Coord c) {
            c[axis] *= 2;
            return accessor.getValue(c);
        };
    };
    const auto valueHere = [&insideHere, K] {
        return [inside = insideHere(), K](const openvdb::Coord& c) { return inside(c) ? -K : K; };
    };
    const auto halved = [axis](openvdb::Coord c) {
        c[axis] >>= 1;
        return c;
    };
    fillTiles(result.coarse.shape->tree(), insideHere);
    fillTiles(result.coarse.controlPoints->tree(), valueHere);
    fillRootTiles(result.coarse.shape->tree(), fineShape, halved, insideHere);
    fillRootTiles(result.coarse.controlPoints->tree(), fineShape, halved, valueHere);

    const auto transform = scaledAlong(fine.transform(), axis, 2.0);
    result.coarse.controlPoints->setTransform(transform);
    result.coarse.shape->setTransform(transform->copy());
    result.details->setTransform(transform->copy());
    return result;
}

BSplineField synthesiseDirection(const BSplineField& coarse, const DetailGrid& details,
                                 const Shape& fineShape, int axis, const Progress& progress) {
    const auto K = static_cast<float>(coarse.K);
    const LineLayout layout(axis);
    const ShapeColumns columns(fineShape.tree(), axis);
    const FieldColumns coarseColumns(coarse.controlPoints->tree(), axis), detailColumns(details.tree(), axis);

    std::vector<std::vector<std::unique_ptr<FloatLeaf>>> made(columns.columns().size());
    forEachColumn(made.size(), progress, [&](std::size_t i, Lines& lines) {
        const auto& column = columns.columns()[i];
        made[i] = synthesiseColumn(column, coarseColumns.find(column.u, column.v),
                                   detailColumns.find(column.u, column.v), fineShape.tree(), axis, layout, K,
                                   lines);
    });

    BSplineField fine;
    fine.K = coarse.K;
    fine.shape = openvdb::ConstPtrCast<Shape>(fineShape.copy());  // shares the tree
    fine.controlPoints = openvdb::FloatGrid::create(K);
    for (auto& column : made)
        for (auto& leaf : column)
            if (leaf) fine.controlPoints->tree().addLeaf(leaf.release());

    const auto valueHere = [&fineShape, K] {
        return [accessor = fineShape.getConstUnsafeAccessor(), K](const openvdb::Coord& c) {
            return accessor.getValue(c) ? -K : K;
        };
    };
    fillTiles(fine.controlPoints->tree(), valueHere);
    fillRootTiles(
        fine.controlPoints->tree(), fineShape.tree(), [](const openvdb::Coord& c) { return c; }, valueHere);

    const auto transform = scaledAlong(coarse.transform(), axis, 0.5);
    fine.controlPoints->setTransform(transform);
    fine.shape->setTransform(transform->copy());
    return fine;
}

}  // namespace isowave::wavelets
