#include "wavelets/direction.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "base/error.h"
#include "volume/leaf_words.h"
#include "volume/tiles.h"
#include "wavelets/bounds.h"
#include "wavelets/columns.h"
#include "wavelets/interval.h"
#include "wavelets/interval_batch.h"
#include "wavelets/line_bits.h"

// Both directions of the transform run the same passes on a handful of columns at a time:
//   look       what is known and what is inside, from the shape's masks, as strings of bits along the lines
//   plan       runs -> odd-ended, joined intervals (interval.h); which coarse control points and details they have
//   leaves     the leaves that will hold results, filled with what is not known: ±K by sign, details 0
//   transform  all intervals of one length, eight at a time (interval_batch.h)
// Leaves are made by the thread that owns the column and hung into the tree by one thread at the end.
//
// Positions within a column are counted from the first fine leaf of an even index that lies at least one leaf before
// the column's first, so that coarse position = fine position / 2 and accessory points have a place.

namespace isowave::wavelets {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using ConstBoolAccessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>;
using ConstFloatAccessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree>;

bool isEmpty(const LeafWords& words) {
    return std::all_of(words.begin(), words.end(), [](Word w) { return w == 0; });
}

// Leaves that hold one value, read where a column has none.
struct UniformLeaves {
    std::array<float, FloatLeaf::SIZE> plus, minus;

    explicit UniformLeaves(float K) {
        plus.fill(K);
        minus.fill(-K);
    }
    const float* of(bool inside) const { return inside ? minus.data() : plus.data(); }
};

// What all columns of one direction share.
struct Setting {
    int axis;
    float K;
    LineStarts starts;
    UniformLeaves uniform;

    Setting(int axis_, float K_) : axis(axis_), K(K_), starts(lineStarts(axis_)), uniform(K_) {}
};

// ---- new leaves -----------------------------------------------------------------------------------------

std::unique_ptr<FloatLeaf> makeLeaf(const openvdb::Coord& origin, const LeafWords& known) {
    auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), origin);
    leaf->allocate();
    leaf->setValueMask(maskOf(known));
    return leaf;
}

// ±K by sign.
std::unique_ptr<FloatLeaf> makeFieldLeaf(const openvdb::Coord& origin, const LeafWords& known,
                                         const LeafWords& inside, float K) {
    auto leaf = makeLeaf(origin, known);
    fillBySign(inside, K, leaf->buffer().data());
    return leaf;
}

std::unique_ptr<FloatLeaf> makeDetailLeaf(const openvdb::Coord& origin, const LeafWords& stored) {
    auto leaf = makeLeaf(origin, stored);
    leaf->buffer().fill(0.0f);
    return leaf;
}

std::unique_ptr<BoolLeaf> makeShapeLeaf(const openvdb::Coord& origin, const LeafWords& known,
                                        const LeafWords& inside) {
    auto leaf = std::make_unique<BoolLeaf>(origin, false, false);
    leaf->setValueMask(maskOf(known));
    setInside(*leaf, inside);
    return leaf;
}

// What one column becomes.
struct CoarseColumn {
    std::vector<std::unique_ptr<FloatLeaf>> controlPoints, details;
    std::vector<std::unique_ptr<BoolLeaf>> shape;
};
using FineColumn = std::vector<std::unique_ptr<FloatLeaf>>;

// ---- look, plan -----------------------------------------------------------------------------------------

// One interval, waiting for its turn.
struct Piece {
    std::int32_t n, first;  // coarse intervals; position of the first fine control point
    std::uint16_t column;   // of the task
    std::uint8_t line;
};

[[noreturn]] void refuseShortRun(const Column& column, int axis, const Run& run) {
    throw InputError(
        "shape", fmt::format("a run of {} control points along {} at position {} near ({}, {}); a field's "
                             "known control points are a union of 4x4x4 blocks, so runs are 4 or longer",
                             run.last - run.first + 1, "xyz"[axis], run.first, column.u, column.v));
}

// A column at work. Its memory is kept from one column to the next.
class ColumnLines {
  public:
    void look(const Column& column, const openvdb::BoolTree& shape, int axis) {
        column_ = &column;
        firstLeaf_ = (column.first - 1) & ~std::int64_t(1);
        leafCount_ = static_cast<int>(((column.end() + 2) & ~std::int64_t(1)) - firstLeaf_);
        known_.reset(leafCount_);
        inside_.reset(leafCount_);
        ConstBoolAccessor accessor(shape);
        for (int k = 0; k < leafCount_; ++k) {
            if (const BoolLeaf* leaf = fineLeaf(k)) {
                known_.putLeaf(k, linesOf(wordsOf(leaf->getValueMask()), axis));
                inside_.putLeaf(k, linesOf(insideWordsOf(*leaf), axis));
            } else {
                inside_.fillLeaf(k, accessor.getValue(column.origin(axis, firstLeaf_ + k)));
            }
        }
    }

    // Appends the column's intervals to `pieces`.
    void plan(int axis, std::uint16_t number, std::vector<Piece>& pieces) {
        coarseKnown_.reset(leafCount_ / 2);
        stored_.reset(leafCount_ / 2);
        for (int line = 0; line < kLinesPerLeaf; ++line) {
            runs_.clear();
            known_.forEachRun(line, [&](int first, int last) {
                if (last - first < 3)
                    refuseShortRun(*column_, axis,
                                   {firstLeaf_ * kLeafDim + first, firstLeaf_ * kLeafDim + last});
                runs_.push_back({first, last});
            });
            joinRuns(runs_, intervals_);
            for (const Interval& i : intervals_) {
                pieces.push_back({static_cast<std::int32_t>(i.coarseIntervals()),
                                  static_cast<std::int32_t>(i.first), number,
                                  static_cast<std::uint8_t>(line)});
                const int coarse = static_cast<int>(i.firstCoarse()),
                          n = static_cast<int>(i.coarseIntervals());
                coarseKnown_.set(line, coarse, coarse + n + 2);
                stored_.set(line, coarse + 1, coarse + n);
            }
        }
    }

    const Column& column() const { return *column_; }
    int fineLeafCount() const { return leafCount_; }
    int coarseLeafCount() const { return leafCount_ / 2; }
    const BoolLeaf* fineLeaf(int k) const {
        const std::int64_t i = firstLeaf_ + k - column_->first;
        return i < 0 || i >= static_cast<std::int64_t>(column_->leaves.size())
                   ? nullptr
                   : column_->leaves[static_cast<std::size_t>(i)];
    }
    openvdb::Coord fineOrigin(int axis, int k) const { return column_->origin(axis, firstLeaf_ + k); }
    openvdb::Coord coarseOrigin(int axis, int k) const { return column_->origin(axis, firstLeaf_ / 2 + k); }

    bool inside(int line, int position) const { return inside_.at(line, position); }
    bool insideLeaf(int k) const { return inside_.at(0, k * kLeafDim); }  // REQUIRES: no leaf there
    std::uint8_t knownByte(int line, int k) const {
        return static_cast<std::uint8_t>(known_.line(line)[k / kLeafDim] >> k % kLeafDim * kLeafDim);
    }
    LeafWords coarseKnown(int axis, int k) const { return wordsOfLines(coarseKnown_.leaf(k), axis); }
    LeafWords stored(int axis, int k) const { return wordsOfLines(stored_.leaf(k), axis); }
    // The signs of a coarse column are those of the even fine positions.
    LeafWords coarseInside(int axis, int k) const {
        const LeafLines low = inside_.leaf(2 * k), high = inside_.leaf(2 * k + 1);
        LeafLines lines;
        for (int l = 0; l < kLinesPerLeaf; ++l)
            lines[l] = static_cast<std::uint8_t>(evenBits(low[l] | Word(high[l]) << 8));
        return wordsOfLines(lines, axis);
    }

    // Values by leaf, in the order of the leaves' own buffers. Where nothing is to be read or written: null.
    std::vector<const float*> fineValues, coarseValues, detailValues;
    std::vector<float*> fineResults, coarseResults, detailResults;

  private:
    const Column* column_ = nullptr;
    std::int64_t firstLeaf_ = 0;
    int leafCount_ = 0;  // even
    LineBits known_, inside_, coarseKnown_, stored_;
    std::vector<Run> runs_;
    std::vector<Interval> intervals_;
};

// ---- between lines and batches --------------------------------------------------------------------------

// A line of a column: positions -> values of its leaves.
template <class Value>
struct LineOf {
    Value* const* leaves;
    int start;
};

// Rows of one lane, starting at row `from`, kStep rows apart.
template <int kStep>
struct LaneRows {
    static constexpr int kApart = kStep * IntervalBatch::kLanes;
    float* at;
    LaneRows(IntervalBatch& batch, int lane, int from)
        : at(batch.rows() + from * IntervalBatch::kLanes + lane) {}
};

// Calls f(value, row) for positions first .. first + count - 1: of most leaves all eight, by offsets that the compiler
// knows.
template <int kStride, int kStep, class Value, class F>
[[gnu::always_inline]] inline void alongLine(LineOf<Value> line, int first, int count, LaneRows<kStep> rows,
                                             const F& f) {
    constexpr int kApart = LaneRows<kStep>::kApart;
    float* row = rows.at;
    while (count > 0) {
        const int within = first & (kLeafDim - 1), here = std::min(kLeafDim - within, count);
        Value* value = line.leaves[first >> kLeafLog2] + line.start + within * kStride;
        if (here == kLeafDim) {
            for (int i = 0; i < kLeafDim; ++i) f(value[i * kStride], row[i * kApart]);
        } else {
            for (int i = 0; i < here; ++i) f(value[i * kStride], row[i * kApart]);
        }
        row += here * kApart;
        first += here;
        count -= here;
    }
}

template <int kStride, int kStep>
void gather(LineOf<const float> line, int first, int count, LaneRows<kStep> to) {
    alongLine<kStride>(line, first, count, to, [](const float& value, float& row) { row = value; });
}

template <int kStride, int kStep>
void scatter(LaneRows<kStep> from, LineOf<float> line, int first, int count) {
    alongLine<kStride>(line, first, count, from, [](float& value, const float& row) { value = row; });
}

// Only where a control point is known: all but a point at an end and those between joined runs.
template <int kStride>
void scatterKnown(LaneRows<1> from, const ColumnLines& column, int lineNumber, LineOf<float> line, int first,
                  int count) {
    for (int i = 0; i < count;) {
        const int position = first + i, within = position & (kLeafDim - 1);
        const int here = std::min(kLeafDim - within, count - i), k = position >> kLeafLog2;
        const unsigned wanted = ((1u << here) - 1) << within;
        const unsigned known = column.knownByte(lineNumber, k) & wanted;
        if (known == wanted) {
            scatter<kStride>(from, line, position, here);
        } else {
            for (unsigned bits = known; bits != 0; bits &= bits - 1) {
                const int bit = std::countr_zero(bits);
                line.leaves[k][line.start + bit * kStride] = from.at[(bit - within) * LaneRows<1>::kApart];
            }
        }
        from.at += here * LaneRows<1>::kApart;
        i += here;
    }
}

// A task's columns and intervals, with the scratch of one thread.
class Task {
  public:
    std::vector<Piece> pieces;

    // The lines of `count` columns.
    std::vector<ColumnLines>& columns(std::size_t count) {
        if (columns_.size() < count) columns_.resize(count);
        return columns_;
    }

    // Calls load(piece, batch, lane), run(batch), store(piece, batch, lane), batch by batch of intervals of one length.
    template <class Load, class RunBatch, class Store>
    void forEachBatch(const Load& load, const RunBatch& run, const Store& store) {
        sortByLength();
        for (std::size_t i = 0; i < sorted_.size();) {
            const int n = sorted_[i].n;
            int lanes = 0;
            while (lanes < IntervalBatch::kLanes && i + lanes < sorted_.size() && sorted_[i + lanes].n == n)
                ++lanes;
            batch_.start(n, lanes);
            for (int lane = 0; lane < lanes; ++lane) load(sorted_[i + lane], batch_, lane);
            run(batch_);
            for (int lane = 0; lane < lanes; ++lane) store(sorted_[i + lane], batch_, lane);
            i += lanes;
        }
    }

  private:
    // By counting: n is small.
    void sortByLength() {
        int longest = 0;
        for (const Piece& piece : pieces) longest = std::max(longest, piece.n);
        placeOf_.assign(std::size_t(longest) + 2, 0);
        for (const Piece& piece : pieces) ++placeOf_[piece.n + 1];
        for (std::size_t n = 1; n < placeOf_.size(); ++n) placeOf_[n] += placeOf_[n - 1];
        sorted_.resize(pieces.size());
        for (const Piece& piece : pieces) sorted_[placeOf_[piece.n]++] = piece;
    }

    std::vector<ColumnLines> columns_;
    std::vector<Piece> sorted_;
    std::vector<std::size_t> placeOf_;
    IntervalBatch batch_;
};

// ---- ahead of need --------------------------------------------------------------------------------------

// A task's leaves lie all over memory, and the lines of a leaf are read a value here and a value there, which no hardware
// foresees: they are asked for while the columns before them are planned.
template <class T>
void prefetch(const T* begin, std::size_t count) {
    constexpr std::size_t kCacheLine = 64;
    const char* at = reinterpret_cast<const char*>(begin);
    for (const char* end = at + count * sizeof(T); at < end; at += kCacheLine) __builtin_prefetch(at);
}

// The leaf's values, on their way into the cache.
const float* prefetchedValues(const FloatLeaf& leaf) {
    const float* values = leaf.buffer().data();
    prefetch(values, FloatLeaf::SIZE);
    return values;
}

void prefetchShape(const Columns& columns, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
        for (const BoolLeaf* leaf : columns[i].leaves)
            if (leaf) prefetch(leaf, 1);
}

// ---- analysis of some columns ---------------------------------------------------------------------------

// What is not known is ±K in the field's own leaves too: they are read as they are, accessory points and all.
void readFine(const openvdb::FloatTree& controlPoints, const Setting& setting, ColumnLines& column) {
    ConstFloatAccessor accessor(controlPoints);
    column.fineValues.clear();
    for (int k = 0; k < column.fineLeafCount(); ++k) {
        const FloatLeaf* leaf =
            column.fineLeaf(k) ? accessor.probeConstLeaf(column.fineOrigin(setting.axis, k)) : nullptr;
        column.fineValues.push_back(leaf ? prefetchedValues(*leaf)
                                         : setting.uniform.of(column.insideLeaf(k)));
    }
}

void makeCoarseLeaves(const Setting& setting, ColumnLines& column, CoarseColumn& out) {
    column.coarseResults.assign(column.coarseLeafCount(), nullptr);
    column.detailResults.assign(column.coarseLeafCount(), nullptr);
    for (int k = 0; k < column.coarseLeafCount(); ++k) {
        const LeafWords known = column.coarseKnown(setting.axis, k);
        if (isEmpty(known)) continue;
        const LeafWords inside = column.coarseInside(setting.axis, k);
        const openvdb::Coord origin = column.coarseOrigin(setting.axis, k);
        out.controlPoints.push_back(makeFieldLeaf(origin, known, inside, setting.K));
        out.shape.push_back(makeShapeLeaf(origin, known, inside));
        column.coarseResults[k] = out.controlPoints.back()->buffer().data();
        const LeafWords stored = column.stored(setting.axis, k);  // a part of what is known
        if (isEmpty(stored)) continue;
        out.details.push_back(makeDetailLeaf(origin, stored));
        column.detailResults[k] = out.details.back()->buffer().data();
    }
}

// Rows of interval_batch.h.
constexpr int kFirstDetail = 3, kEveryOther = 2;

template <int kStride>
void analyseColumns(const BSplineField& fine, const Setting& setting, const Columns& columns,
                    std::size_t begin, std::size_t end, Task& task, std::vector<CoarseColumn>& made) {
    auto& lines = task.columns(end - begin);
    task.pieces.clear();
    prefetchShape(columns, begin, end);
    for (std::size_t i = begin; i < end; ++i) {
        ColumnLines& column = lines[i - begin];
        column.look(columns[i], fine.shape->tree(), setting.axis);
        column.plan(setting.axis, static_cast<std::uint16_t>(i - begin), task.pieces);
        readFine(fine.controlPoints->tree(), setting, column);
        makeCoarseLeaves(setting, column, made[i]);
    }
    const LineStarts& starts = setting.starts;
    task.forEachBatch(
        [&](const Piece& piece, IntervalBatch& batch, int lane) {
            gather<kStride, 1>({lines[piece.column].fineValues.data(), starts[piece.line]}, piece.first - 1,
                               2 * piece.n + 5, {batch, lane, 0});
        },
        [](IntervalBatch& batch) { batch.analyse(); },
        [&](const Piece& piece, IntervalBatch& batch, int lane) {
            const ColumnLines& column = lines[piece.column];
            const int coarse = (piece.first - 1) / 2, start = starts[piece.line];
            scatter<kStride, kEveryOther>({batch, lane, 0}, {column.coarseResults.data(), start}, coarse,
                                          piece.n + 3);
            scatter<kStride, kEveryOther>({batch, lane, kFirstDetail}, {column.detailResults.data(), start},
                                          coarse + 1, piece.n);
        });
}

// ---- synthesis of some columns --------------------------------------------------------------------------

// The leaves of `tree` under a column's coarse leaves. Throws InputError where one lacks a value that the step needs.
void readCoarse(const openvdb::FloatTree& tree, int axis, const ColumnLines& column,
                LeafWords (ColumnLines::*needed)(int, int) const, const char* what,
                std::vector<const float*>& values) {
    ConstFloatAccessor accessor(tree);
    values.clear();
    for (int k = 0; k < column.coarseLeafCount(); ++k) {
        const LeafWords need = (column.*needed)(axis, k);
        const openvdb::Coord origin = column.coarseOrigin(axis, k);
        const FloatLeaf* leaf = isEmpty(need) ? nullptr : accessor.probeConstLeaf(origin);
        values.push_back(leaf ? prefetchedValues(*leaf) : nullptr);
        const LeafWords have = leaf ? wordsOf(leaf->getValueMask()) : LeafWords{};
        for (int x = 0; x < kLeafDim; ++x)
            if (const Word missing = need[x] & ~have[x]) {
                const int bit = std::countr_zero(missing);
                const openvdb::Coord at = origin.offsetBy(x, bit >> 3, bit & 7);
                throw InputError(
                    "pyramid",
                    fmt::format("no {} at ({}, {}, {}) although the step's shape needs one; the parts "
                                "of the pyramid do not belong together",
                                what, at.x(), at.y(), at.z()));
            }
    }
}

void makeFineLeaves(const Setting& setting, ColumnLines& column, FineColumn& out) {
    column.fineResults.assign(column.fineLeafCount(), nullptr);
    for (int k = 0; k < column.fineLeafCount(); ++k)
        if (const BoolLeaf* leaf = column.fineLeaf(k)) {
            out.push_back(makeFieldLeaf(leaf->origin(), wordsOf(leaf->getValueMask()), insideWordsOf(*leaf),
                                        setting.K));
            column.fineResults[k] = out.back()->buffer().data();
        }
}

// From coefficients to fine control points: a batch's synthesise() or gain().
using ToFine = void (IntervalBatch::*)();

template <int kStride>
void synthesiseColumns(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                       const Setting& setting, ToFine toFine, const Columns& columns, std::size_t begin,
                       std::size_t end, Task& task, std::vector<FineColumn>& made) {
    auto& lines = task.columns(end - begin);
    task.pieces.clear();
    prefetchShape(columns, begin, end);
    for (std::size_t i = begin; i < end; ++i) {
        ColumnLines& column = lines[i - begin];
        column.look(columns[i], fineShape.tree(), setting.axis);
        column.plan(setting.axis, static_cast<std::uint16_t>(i - begin), task.pieces);
        readCoarse(coarse.controlPoints->tree(), setting.axis, column, &ColumnLines::coarseKnown,
                   "control point", column.coarseValues);
        readCoarse(details.tree(), setting.axis, column, &ColumnLines::stored, "detail", column.detailValues);
        makeFineLeaves(setting, column, made[i]);
    }
    const LineStarts& starts = setting.starts;
    task.forEachBatch(
        [&](const Piece& piece, IntervalBatch& batch, int lane) {
            const ColumnLines& column = lines[piece.column];
            const int coarseFirst = (piece.first - 1) / 2, start = starts[piece.line];
            gather<kStride, kEveryOther>({column.coarseValues.data(), start}, coarseFirst, piece.n + 3,
                                         {batch, lane, 0});
            gather<kStride, kEveryOther>({column.detailValues.data(), start}, coarseFirst + 1, piece.n,
                                         {batch, lane, kFirstDetail});
            const int after = piece.first + 2 * piece.n + 3;
            batch.left()[lane] = column.inside(piece.line, piece.first - 1) ? -setting.K : setting.K;
            batch.right()[lane] = column.inside(piece.line, after) ? -setting.K : setting.K;
        },
        [toFine](IntervalBatch& batch) { (batch.*toFine)(); },
        [&](const Piece& piece, IntervalBatch& batch, int lane) {
            const ColumnLines& column = lines[piece.column];
            scatterKnown<kStride>({batch, lane, 1}, column, piece.line,
                                  {column.fineResults.data(), starts[piece.line]}, piece.first,
                                  2 * piece.n + 3);
        });
}

// ---- columns in parallel --------------------------------------------------------------------------------

// Calls work(begin, end, task) for ranges of columns: several at a time, so that batches fill up, but enough tasks for
// the threads to share. Results do not depend on where the ranges end.
template <class Work>
void forEachTask(std::size_t columnCount, const Progress& progress, const Work& work) {
    constexpr std::size_t kMostColumns = 16, kTasks = 32;
    const std::size_t grain = std::clamp<std::size_t>(columnCount / kTasks, 1, kMostColumns);
    tbb::enumerable_thread_specific<Task> scratch;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, columnCount, grain),
        [&](const auto& range) {
            progress.check();
            work(range.begin(), range.end(), scratch.local());
        },
        tbb::simple_partitioner());
}

// pick(stride as a constant): one function an axis.
template <class Pick>
auto byAxis(int axis, const Pick& pick) {
    return axis == 0   ? pick(std::integral_constant<int, kLeafStride[0]>())
           : axis == 1 ? pick(std::integral_constant<int, kLeafStride[1]>())
                       : pick(std::integral_constant<int, kLeafStride[2]>());
}

// Leaves come sorted by column: neighbours share the nodes above, which the accessor remembers.
template <class Tree, class Made, class LeavesOf>
void hang(Tree& tree, std::vector<Made>& made, const LeavesOf& leavesOf) {
    openvdb::tree::ValueAccessor<Tree> accessor(tree);
    for (Made& column : made)
        for (auto& leaf : leavesOf(column)) accessor.addLeaf(leaf.release());
}

openvdb::math::Transform::Ptr scaledAlong(const openvdb::math::Transform& transform, int axis,
                                          double factor) {
    openvdb::Vec3d scale(1.0);
    scale[axis] = factor;
    auto result = transform.copy();
    result->preScale(scale);
    return result;
}

BSplineField fineField(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                       int axis, ToFine toFine, const Progress& progress) {
    const auto K = static_cast<float>(coarse.K);
    const Setting setting(axis, K);
    const Columns columns(fineShape.tree(), axis);
    std::vector<FineColumn> made(columns.size());
    const auto synthesiseSome = byAxis(axis, [](auto stride) { return &synthesiseColumns<stride()>; });
    forEachTask(columns.size(), progress, [&](std::size_t begin, std::size_t end, Task& task) {
        synthesiseSome(coarse, details, fineShape, setting, toFine, columns, begin, end, task, made);
    });

    BSplineField fine;
    fine.K = coarse.K;
    fine.shape = openvdb::ConstPtrCast<Shape>(fineShape.copy());  // shares the tree
    fine.controlPoints = openvdb::FloatGrid::create(K);
    auto& tree = fine.controlPoints->tree();
    hang(
        tree, made, [](FineColumn & column) -> auto& { return column; });
    const auto valueHere = [&fineShape, K] {
        return [accessor = fineShape.getConstUnsafeAccessor(), K](const openvdb::Coord& c) {
            return accessor.getValue(c) ? -K : K;
        };
    };
    fillTiles(tree, valueHere);
    fillRootTiles(
        tree, fineShape.tree(), [](const openvdb::Coord& c) { return c; }, valueHere);

    const auto transform = scaledAlong(coarse.transform(), axis, 0.5);
    fine.controlPoints->setTransform(transform);
    fine.shape->setTransform(transform->copy());
    return fine;
}

}  // namespace

DirectionResult analyseDirection(const BSplineField& fine, int axis, const Progress& progress) {
    const auto K = static_cast<float>(fine.K);
    const Setting setting(axis, K);
    const openvdb::BoolTree& fineShape = fine.shape->tree();
    const Columns columns(fineShape, axis);
    std::vector<CoarseColumn> made(columns.size());
    const auto analyseSome = byAxis(axis, [](auto stride) { return &analyseColumns<stride()>; });
    forEachTask(columns.size(), progress, [&](std::size_t begin, std::size_t end, Task& task) {
        analyseSome(fine, setting, columns, begin, end, task, made);
    });

    DirectionResult result;
    result.coarse.K = fine.K;
    result.coarse.controlPoints = openvdb::FloatGrid::create(K);
    result.coarse.shape = Shape::create(false);
    result.details = DetailGrid::create(0.0f);
    const auto insideHere = [&fineShape, axis] {
        return [accessor = ConstBoolAccessor(fineShape), axis](openvdb::Coord c) {
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
    tbb::parallel_invoke(
        [&] {
            auto& tree = result.coarse.controlPoints->tree();
            hang(
                tree, made, [](CoarseColumn & c) -> auto& { return c.controlPoints; });
            fillTiles(tree, valueHere);
            fillRootTiles(tree, fineShape, halved, valueHere);
        },
        [&] {
            auto& tree = result.coarse.shape->tree();
            hang(
                tree, made, [](CoarseColumn & c) -> auto& { return c.shape; });
            fillTiles(tree, insideHere);
            fillRootTiles(tree, fineShape, halved, insideHere);
        },
        [&] {
            hang(
                result.details->tree(), made, [](CoarseColumn & c) -> auto& { return c.details; });
        });

    const auto transform = scaledAlong(fine.transform(), axis, 2.0);
    result.coarse.controlPoints->setTransform(transform);
    result.coarse.shape->setTransform(transform->copy());
    result.details->setTransform(transform->copy());
    return result;
}

BSplineField synthesiseDirection(const BSplineField& coarse, const DetailGrid& details,
                                 const Shape& fineShape, int axis, const Progress& progress) {
    return fineField(coarse, details, fineShape, axis, &IntervalBatch::synthesise, progress);
}

BSplineField boundDirection(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                            int axis, const Progress& progress) {
    return fineField(coarse, details, fineShape, axis, &IntervalBatch::gain, progress);
}

}  // namespace isowave::wavelets
