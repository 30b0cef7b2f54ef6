#include "wavelets/direction.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "isowave/error.h"
#include "volume/tiles.h"
#include "wavelets/batch_queue.h"
#include "wavelets/column_lines.h"
#include "wavelets/interval/batch.h"
#include "wavelets/line_values.h"

// Both directions of the transform run the same passes on a handful of columns at a time:
//   plan       what is known, from the shape's masks -> intervals, and the coarse control points and details they have;
//              the leaves that will hold results. The values that are read next are asked for meanwhile.
//   gather     the values of leaves -> lines
//   transform  intervals of one length, eight at a time (batch_queue.h, interval/batch.h)
//   scatter    lines -> leaves; where nothing is known: ±K by sign, details 0
// Leaves are made by the thread that owns the column and hung into the trees at the end.

namespace isowave::wavelets {

static_assert(kSlack <= kLeafDim, "what a batch reads behind a line is there (LineValues::line)");

namespace {

// ---- leaves

// Leaves lie all over memory: they are asked for before they are needed. Inlined, or the compiler takes such
// functions for ones without effect and leaves out the calls (g++ 12).
template <class T>
ISOWAVE_INLINE void prefetch(const T* begin, std::size_t count) {
    constexpr std::size_t kCacheLine = 64;
    const char* at = reinterpret_cast<const char*>(begin);
    for (const char* end = at + count * sizeof(T); at < end; at += kCacheLine) __builtin_prefetch(at);
}

// Values are to be written.
std::unique_ptr<FloatLeaf> makeLeaf(const openvdb::Coord& origin, const LeafWords& known) {
    auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), origin);
    leaf->allocate();
    leaf->setValueMask(maskOf(known));
    return leaf;
}

std::unique_ptr<BoolLeaf> makeShapeLeaf(const openvdb::Coord& origin, const LeafWords& known,
                                        const LeafWords& inside) {
    auto leaf = std::make_unique<BoolLeaf>(origin, false, false);
    leaf->setValueMask(maskOf(known));
    setInside(*leaf, inside);
    return leaf;
}

// Throws InputError about `object` where a leaf (null: none) lacks a value that is needed.
void requireAll(const char* object, const char* what, const openvdb::Coord& origin, const LeafWords& needed,
                const FloatLeaf* leaf) {
    const LeafWords have = leaf ? wordsOf(leaf->getValueMask()) : LeafWords{};
    for (int x = 0; x < kLeafDim; ++x)
        if (const Word missing = needed[x] & ~have[x]) {
            const int bit = std::countr_zero(missing);
            const openvdb::Coord at = origin.offsetBy(x, bit >> 3, bit & 7);
            throw InputError(
                object, fmt::format("no {} at ({}, {}, {}) although the step's shape needs one; the parts "
                                    "of the {} do not belong together",
                                    what, at.x(), at.y(), at.z(), object));
        }
}

// What some columns become.
struct CoarseColumns {
    std::vector<std::unique_ptr<FloatLeaf>> controlPoints, details;
    std::vector<std::unique_ptr<BoolLeaf>> shape;
};
using FineColumns = std::vector<std::unique_ptr<FloatLeaf>>;

// Values to be gathered from leaf k of a column, or scattered to it.
struct Source {
    int k;
    const FloatLeaf* leaf;          // null: none
    const float* values = nullptr;  // once they have been asked for
};
struct Sink {
    int k;
    float* values;
    LeafWords known, inside;
};

// ---- tasks

struct ColumnAtWork {
    ColumnLines lines;
    LineValues fine, coarse, detail;
    std::vector<Source> fineSources, coarseSources, detailSources;
    std::vector<Sink> fineSinks, coarseSinks, detailSinks;
};

ISOWAVE_INLINE void askForValues(std::vector<Source>& sources) {
    for (Source& s : sources)
        if (s.leaf) {
            s.values = s.leaf->buffer().data();
            prefetch(s.values, FloatLeaf::SIZE);
        }
}

void gather(const std::vector<Source>& sources, int axis, LineValues& lines) {
    for (const Source& s : sources) lines.putLeaf(s.k, axis, s.values);
}
void scatter(const LineValues& lines, int axis, float K, const std::vector<Sink>& sinks) {
    for (const Sink& s : sinks) lines.takeLeaf(s.k, axis, s.known, s.inside, K, s.values);
}

// The scratch of one thread.
struct Scratch {
    BatchTransform transform;
    BatchQueue<AnalysisBatch> analyses;
    BatchQueue<SynthesisBatch> syntheses;
    std::vector<ColumnAtWork> columns;

    std::span<ColumnAtWork> take(std::size_t count) {
        if (columns.size() < count) columns.resize(count);
        return std::span(columns).first(count);
    }
};

ISOWAVE_INLINE void findLeaves(const Column& found, int axis, ColumnAtWork& column) {
    column.lines.findLeaves(found, axis);
    for (const BoolLeaf* leaf : found.leaves)
        if (leaf) prefetch(leaf, 1);
}

// ---- analysis of some columns

// What is not known is ±K in the field's own leaves too: they are read as they are, accessory points and all.
void findFine(const FloatAccessor& controlPoints, ColumnAtWork& column) {
    const ColumnLines& lines = column.lines;
    column.fineSources.clear();
    for (int k = 0; k < lines.fineLeafCount(); ++k) {
        const FloatLeaf* leaf =
            lines.fineLeaf(k) ? controlPoints.probeConstLeaf(lines.fineOrigin(k)) : nullptr;
        column.fineSources.push_back({k, leaf, nullptr});
        if (leaf) prefetch(leaf, 1);
    }
}

void gatherFine(int axis, float K, ColumnAtWork& column) {
    const ColumnLines& lines = column.lines;
    column.fine.reset(lines.fineLeafCount());
    for (const Source& s : column.fineSources)
        if (s.leaf) {
            column.fine.putLeaf(s.k, axis, s.values);
        } else if (!lines.fineLeaf(s.k)) {
            column.fine.fillLeaf(s.k, lines.inside(0, s.k * kLeafDim) ? -K : K);
        } else {
            requireAll("field", "control point", lines.fineOrigin(s.k), lines.fineKnown(s.k), nullptr);
            std::array<float, FloatLeaf::SIZE> values;
            fillBySign(lines.fineInside(s.k), K, values.data());
            column.fine.putLeaf(s.k, axis, values.data());
        }
}

void makeCoarseLeaves(ColumnAtWork& column, CoarseColumns& out) {
    const ColumnLines& lines = column.lines;
    column.coarseSinks.clear();
    column.detailSinks.clear();
    for (int k = 0; k < lines.coarseLeafCount(); ++k) {
        if (!lines.knowsAny(k)) continue;
        const LeafWords known = lines.coarseKnown(k), inside = lines.coarseInside(k),
                        stored = lines.stored(k);
        const openvdb::Coord origin = lines.coarseOrigin(k);
        out.controlPoints.push_back(makeLeaf(origin, known));
        out.shape.push_back(makeShapeLeaf(origin, known, inside));
        column.coarseSinks.push_back({k, out.controlPoints.back()->buffer().data(), known, inside});
        if (isEmpty(stored)) continue;
        out.details.push_back(makeLeaf(origin, stored));
        column.detailSinks.push_back({k, out.details.back()->buffer().data(), stored, {}});
    }
}

void analyseColumns(const BSplineField& fine, int axis, float K, const Columns& columns, Columns::Range range,
                    Scratch& scratch, CoarseColumns& result) {
    const ShapeAccessor shape(fine.shape->tree());
    const FloatAccessor controlPoints(fine.controlPoints->tree());
    const auto atWork = scratch.take(range.end - range.begin);
    for (std::size_t i = 0; i < atWork.size(); ++i) {
        findLeaves(columns[range.begin + i], axis, atWork[i]);
        findFine(controlPoints, atWork[i]);
    }
    for (ColumnAtWork& column : atWork) {
        column.lines.plan(shape);
        askForValues(column.fineSources);
        makeCoarseLeaves(column, result);
    }
    for (ColumnAtWork& column : atWork) gatherFine(axis, K, column);
    const auto run = [&](const AnalysisBatch& batch) { scratch.transform.analyse(batch); };
    for (ColumnAtWork& column : atWork) {
        column.coarse.reset(column.lines.coarseLeafCount());
        column.detail.reset(column.lines.coarseLeafCount());
        column.lines.forEachInterval([&](int line, const Interval& i) {
            scratch.analyses.add(
                static_cast<int>(i.coarseIntervals()),
                [&](AnalysisBatch& batch, int lane) {
                    batch.fine[lane] = column.fine.line(line) + i.first - 1;
                    batch.coarse[lane] = column.coarse.line(line) + i.firstCoarse();
                    batch.detail[lane] = column.detail.line(line) + i.firstDetail();
                },
                run);
        });
    }
    scratch.analyses.flush(run);
    for (const ColumnAtWork& column : atWork) {
        scatter(column.coarse, axis, K, column.coarseSinks);
        scatter(column.detail, axis, 0, column.detailSinks);
    }
}

// ---- synthesis of some columns

// The leaves of a tree under a column's coarse leaves. Throws InputError where one lacks a value that the
// step needs.
void findCoarse(const FloatAccessor& tree, const ColumnLines& lines,
                LeafWords (ColumnLines::*needed)(int) const, const char* what, std::vector<Source>& sources) {
    sources.clear();
    for (int k = 0; k < lines.coarseLeafCount(); ++k) {
        if (!lines.knowsAny(k)) continue;
        const LeafWords need = (lines.*needed)(k);
        if (isEmpty(need)) continue;
        const openvdb::Coord origin = lines.coarseOrigin(k);
        const FloatLeaf* leaf = tree.probeConstLeaf(origin);
        if (leaf) sources.push_back({k, leaf, nullptr});
        requireAll("pyramid", what, origin, need, leaf);
    }
}

void makeFineLeaves(ColumnAtWork& column, FineColumns& out) {
    column.fineSinks.clear();
    for (int k = 0; k < column.lines.fineLeafCount(); ++k)
        if (const BoolLeaf* leaf = column.lines.fineLeaf(k)) {
            const LeafWords known = wordsOf(leaf->getValueMask());
            out.push_back(makeLeaf(leaf->origin(), known));
            column.fineSinks.push_back({k, out.back()->buffer().data(), known, insideWordsOf(*leaf)});
        }
}

// From coefficients to fine control points: synthesise() or gain().
using ToFine = void (BatchTransform::*)(const SynthesisBatch&);

void synthesiseColumns(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                       int axis, float K, ToFine toFine, const Columns& columns, Columns::Range range,
                       Scratch& scratch, FineColumns& result) {
    const ShapeAccessor shape(fineShape.tree());
    const FloatAccessor controlPoints(coarse.controlPoints->tree()), detailTree(details.tree());
    const auto atWork = scratch.take(range.end - range.begin);
    for (std::size_t i = 0; i < atWork.size(); ++i) findLeaves(columns[range.begin + i], axis, atWork[i]);
    for (ColumnAtWork& column : atWork) {
        column.lines.plan(shape);
        findCoarse(controlPoints, column.lines, &ColumnLines::coarseKnown, "control point",
                   column.coarseSources);
        findCoarse(detailTree, column.lines, &ColumnLines::stored, "detail", column.detailSources);
        askForValues(column.coarseSources);
        askForValues(column.detailSources);
        makeFineLeaves(column, result);
    }
    for (ColumnAtWork& column : atWork) {
        column.coarse.reset(column.lines.coarseLeafCount());
        column.detail.reset(column.lines.coarseLeafCount());
        gather(column.coarseSources, axis, column.coarse);
        gather(column.detailSources, axis, column.detail);
    }
    const auto run = [&](const SynthesisBatch& batch) { (scratch.transform.*toFine)(batch); };
    for (ColumnAtWork& column : atWork) {
        const ColumnLines& lines = column.lines;
        column.fine.reset(lines.fineLeafCount());
        lines.forEachInterval([&](int line, const Interval& i) {
            scratch.syntheses.add(
                static_cast<int>(i.coarseIntervals()),
                [&](SynthesisBatch& batch, int lane) {
                    batch.coarse[lane] = column.coarse.line(line) + i.firstCoarse();
                    batch.detail[lane] = column.detail.line(line) + i.firstDetail();
                    batch.left[lane] = lines.inside(line, i.first - 1) ? -K : K;
                    batch.right[lane] = lines.inside(line, i.last + 1) ? -K : K;
                    batch.fine[lane] = column.fine.line(line) + i.first;
                },
                run);
        });
    }
    scratch.syntheses.flush(run);
    for (const ColumnAtWork& column : atWork) scatter(column.fine, axis, K, column.fineSinks);
}

// ---- columns in parallel

// What the columns of one direction become, by task: some columns of one block.
template <class Result>
class Tasks {
  public:
    // Calls work(columns, scratch, result).
    template <class Work>
    Tasks(const Columns& columns, const Progress& progress, const Work& work) {
        constexpr std::size_t kMostColumns = 4, kTasks = 64;
        const std::size_t grain = std::clamp<std::size_t>(columns.size() / kTasks, 1, kMostColumns);
        std::vector<Columns::Range> ranges;
        for (const Columns::Range& block : columns.blocks()) {
            blocks_.push_back({ranges.size(), ranges.size()});
            for (std::size_t begin = block.begin; begin < block.end; begin += grain)
                ranges.push_back({begin, std::min(begin + grain, block.end)});
            blocks_.back().end = ranges.size();
        }
        results_.resize(ranges.size());
        tbb::enumerable_thread_specific<Scratch> scratch;
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, ranges.size()),
            [&](const auto& some) {
                for (std::size_t i = some.begin(); i < some.end(); ++i) {
                    progress.check();
                    work(ranges[i], scratch.local(), results_[i]);
                }
            },
            tbb::simple_partitioner());
    }

    // Hangs all leaves of one kind into a tree that has none; leavesOf(result). No two blocks share an
    // internal node: these are filled side by side.
    template <class Tree, class LeavesOf>
    void hang(Tree& tree, const LeavesOf& leavesOf) {
        using Upper = typename Tree::RootNodeType::ChildNodeType;
        using Lower = typename Upper::ChildNodeType;
        std::vector<std::map<openvdb::Coord, std::unique_ptr<Lower>>> nodes(blocks_.size());
        const auto background = tree.background();
        tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t block) {
            Lower* node = nullptr;
            constexpr std::size_t kAhead = 2;  // tasks
            for (std::size_t i = blocks_[block].begin; i < blocks_[block].end; ++i) {
                if (i + kAhead < blocks_[block].end)
                    for (const auto& leaf : leavesOf(results_[i + kAhead])) prefetch(leaf.get(), 1);
                for (auto& leaf : leavesOf(results_[i])) {
                    const openvdb::Coord origin = leaf->origin() & ~(static_cast<int>(Lower::DIM) - 1);
                    if (!node || node->origin() != origin) {
                        auto& place = nodes[block][origin];
                        if (!place) place = std::make_unique<Lower>(origin, background);
                        node = place.get();
                    }
                    node->addLeaf(leaf.release());
                }
            }
        });
        for (auto& some : nodes)
            for (auto& [lower, node] : some) {
                const openvdb::Coord origin = lower & ~(static_cast<int>(Upper::DIM) - 1);
                Upper* upper = tree.template probeNode<Upper>(origin);
                if (!upper) tree.root().addChild(upper = new Upper(origin, background));
                upper->addChild(node.release());
            }
    }

  private:
    std::vector<Columns::Range> blocks_;  // tasks of each
    std::vector<Result> results_;
};

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
    const Columns columns(fineShape.tree(), axis);
    Tasks<FineColumns> tasks(
        columns, progress, [&](Columns::Range range, Scratch& scratch, FineColumns& result) {
            synthesiseColumns(coarse, details, fineShape, axis, K, toFine, columns, range, scratch, result);
        });

    BSplineField fine;
    fine.K = coarse.K;
    fine.shape = openvdb::ConstPtrCast<Shape>(fineShape.copy());  // shares the tree
    fine.controlPoints = openvdb::FloatGrid::create(K);
    auto& tree = fine.controlPoints->tree();
    tasks.hang(
        tree, [](FineColumns & leaves) -> auto& { return leaves; });
    fillInsideTiles(tree, fineShape.tree(), -1, -K);

    const auto transform = scaledAlong(coarse.transform(), axis, 0.5);
    fine.controlPoints->setTransform(transform);
    fine.shape->setTransform(transform->copy());
    return fine;
}

}  // namespace

DirectionResult analyseDirection(const BSplineField& fine, int axis, const Progress& progress) {
    const auto K = static_cast<float>(fine.K);
    const openvdb::BoolTree& fineShape = fine.shape->tree();
    const Columns columns(fineShape, axis);
    Tasks<CoarseColumns> tasks(columns, progress,
                               [&](Columns::Range range, Scratch& scratch, CoarseColumns& result) {
                                   analyseColumns(fine, axis, K, columns, range, scratch, result);
                               });

    DirectionResult result;
    result.coarse.K = fine.K;
    result.coarse.controlPoints = openvdb::FloatGrid::create(K);
    result.coarse.shape = Shape::create(false);
    result.details = DetailGrid::create(0.0f);
    tbb::parallel_invoke(
        [&] {
            auto& tree = result.coarse.controlPoints->tree();
            tasks.hang(
                tree, [](CoarseColumns & leaves) -> auto& { return leaves.controlPoints; });
            fillInsideTiles(tree, fineShape, axis, -K);
        },
        [&] {
            auto& tree = result.coarse.shape->tree();
            tasks.hang(
                tree, [](CoarseColumns & leaves) -> auto& { return leaves.shape; });
            fillInsideTiles(tree, fineShape, axis, true);
        },
        [&] {
            tasks.hang(
                result.details->tree(), [](CoarseColumns & leaves) -> auto& { return leaves.details; });
        });

    const auto transform = scaledAlong(fine.transform(), axis, 2.0);
    result.coarse.controlPoints->setTransform(transform);
    result.coarse.shape->setTransform(transform->copy());
    result.details->setTransform(transform->copy());
    return result;
}

BSplineField synthesiseDirection(const BSplineField& coarse, const DetailGrid& details,
                                 const Shape& fineShape, int axis, const Progress& progress) {
    return fineField(coarse, details, fineShape, axis, &BatchTransform::synthesise, progress);
}

BSplineField boundDirection(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                            int axis, const Progress& progress) {
    return fineField(coarse, details, fineShape, axis, &BatchTransform::gain, progress);
}

}  // namespace isowave::wavelets
