#include "curves2d/direction.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "isowave/error.h"
#include "wavelets/interval/interval.h"

// Both ways run the same passes on a row:
//   runs       what is known, from the field or from the step
//   intervals  runs -> odd-ended, joined intervals (interval.h)
//   fill       the accessory positions of an interval: ±K by the sign of the gap that they lie in
//   transform  each interval
// Every thread writes into rows of its own, so the result does not depend on the number of threads.

namespace isowave::curves2d {
namespace {

using wavelets::Interval;
using wavelets::IntervalTransform;
using wavelets::Run;

// The scratch memory of one thread.
struct RowScratch {
    IntervalTransform transform;
    std::vector<Run> runs;
    std::vector<Interval> intervals;
    std::vector<double> fine, coarse, detail;

    void intervalsOf(const std::vector<KnownRun>& known, std::int32_t row) {
        runs.clear();
        for (const KnownRun& run : known) {
            if (run.last - run.first < 3)
                throw InputError("field", fmt::format("a run of {} control points at position {} of row {}; "
                                                      "known control points are a union of 4x4 blocks, so "
                                                      "runs are 4 or longer",
                                                      run.last - run.first + 1, run.first, row));
            runs.push_back({run.first, run.last});
        }
        wavelets::joinRuns(runs, intervals);
    }
    void resizeFor(const Interval& interval) {
        fine.resize(static_cast<std::size_t>(interval.fineSize()));
        coarse.resize(static_cast<std::size_t>(interval.coarseSize()));
        detail.resize(static_cast<std::size_t>(interval.detailSize()));
    }
};

template <class Work>
void forEachRow(std::size_t count, const Progress& progress, const Work& work) {
    tbb::enumerable_thread_specific<RowScratch> scratch;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
        progress.check();
        RowScratch& lines = scratch.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i) work(i, lines);
    });
}

// Reads the fine values of an interval from its runs; the positions between them are accessory. `run` and
// `value` move on to what follows the interval; `inside` is the sign of the gap at either end.
template <class Real>
struct FineWalk {
    const std::vector<KnownRun>& runs;
    double K;
    std::size_t run = 0, value = 0;
    bool inside = false;

    double accessory() const { return inside ? -K : K; }

    void fill(const Interval& interval, const std::vector<Real>& values, std::vector<double>& fine) {
        auto write = fine.begin();
        std::int64_t p = interval.first;
        for (; run < runs.size() && runs[run].first <= interval.last; ++run) {
            for (; p < runs[run].first; ++p) *write++ = accessory();
            for (; p <= runs[run].last; ++p) *write++ = static_cast<double>(values[value++]);
            inside = runs[run].insideAfter;
        }
        for (; p <= interval.last; ++p) *write++ = accessory();
    }
    // The inverse: known positions to `values`, accessory ones dropped.
    void takeKnown(const Interval& interval, const std::vector<double>& fine, std::vector<Real>& values) {
        for (; run < runs.size() && runs[run].first <= interval.last; ++run) {
            for (std::int64_t p = runs[run].first; p <= runs[run].last; ++p)
                values.push_back(static_cast<Real>(fine[static_cast<std::size_t>(p - interval.first)]));
            inside = runs[run].insideAfter;
        }
    }
    // The sign behind the last run that the interval will take in.
    double accessoryBehind(const Interval& interval) const {
        bool behind = inside;
        for (std::size_t r = run; r < runs.size() && runs[r].first <= interval.last; ++r)
            behind = runs[r].insideAfter;
        return behind ? -K : K;
    }
};

template <class Real>
void analyseRow(const Row<Real>& fine, std::int32_t number, double K, RowScratch& lines, Row<Real>& coarse,
                StepRow<Real>& step) {
    lines.intervalsOf(fine.runs, number);
    std::size_t coarseSize = 0, detailSize = 0;
    for (const Interval& interval : lines.intervals) {
        coarseSize += static_cast<std::size_t>(interval.coarseSize());
        detailSize += static_cast<std::size_t>(interval.detailSize());
    }
    coarse.runs.reserve(lines.intervals.size());
    coarse.values.reserve(coarseSize);
    step.details.reserve(detailSize);
    FineWalk<Real> walk{fine.runs, K};
    for (const Interval& interval : lines.intervals) {
        lines.resizeFor(interval);
        const double left = walk.accessory();
        walk.fill(interval, fine.values, lines.fine);
        lines.transform.analyse(lines.fine, left, walk.accessory(), lines.coarse, lines.detail);
        coarse.runs.push_back({static_cast<std::int32_t>(interval.firstCoarse()),
                               static_cast<std::int32_t>(interval.lastCoarse()), walk.inside});
        for (const double c : lines.coarse) coarse.values.push_back(static_cast<Real>(c));
        for (const double d : lines.detail) step.details.push_back(static_cast<Real>(d));
    }
    step.row = number;
    step.runs = fine.runs;
}

[[noreturn]] void refuseParts(std::int32_t row, const char* what) {
    throw InputError("pyramid", fmt::format("row {}: {}; the parts do not belong together", row, what));
}

template <class Real>
Row<Real> synthesiseRow(const Row<Real>* coarse, const StepRow<Real>& step, double K, RowScratch& lines) {
    if (!coarse) refuseParts(step.row, "the step knows it, the coarser field does not");
    lines.intervalsOf(step.runs, step.row);
    if (coarse->runs.size() != lines.intervals.size())
        refuseParts(step.row, "the coarser field has other runs than the step");
    Row<Real> fine;
    fine.runs = step.runs;
    std::size_t size = 0;
    for (const KnownRun& run : step.runs) size += static_cast<std::size_t>(run.last - run.first + 1);
    fine.values.reserve(size);
    FineWalk<Real> walk{step.runs, K};
    auto c = coarse->values.begin();
    auto d = step.details.begin();
    for (std::size_t i = 0; i < lines.intervals.size(); ++i) {
        const Interval& interval = lines.intervals[i];
        if (coarse->runs[i].first != interval.firstCoarse() || coarse->runs[i].last != interval.lastCoarse())
            refuseParts(step.row, "the coarser field has other runs than the step");
        if (step.details.end() - d < interval.detailSize()) refuseParts(step.row, "details are missing");
        lines.resizeFor(interval);
        for (double& x : lines.coarse) x = static_cast<double>(*c++);
        for (double& x : lines.detail) x = static_cast<double>(*d++);
        lines.transform.synthesise(lines.coarse, lines.detail, walk.accessory(),
                                   walk.accessoryBehind(interval), lines.fine);
        walk.takeKnown(interval, lines.fine, fine.values);
    }
    return fine;
}

void scaleSpacing(Frame& frame, int axis, double factor) {
    (axis == 0 ? frame.spacing.x : frame.spacing.y) *= factor;
}

// An empty field of the same kind.
template <class Real>
RowField<Real> emptyLike(const RowField<Real>& field) {
    RowField<Real> out;
    out.axis = field.axis;
    out.K = field.K;
    out.frame = field.frame;
    return out;
}

}  // namespace

template <class Real>
DirectionResult<Real> analyseDirection(const RowField<Real>& fine, const Progress& progress) {
    const std::vector<std::int32_t> numbers = fine.rowNumbers();
    DirectionResult<Real> result;
    result.step.axis = fine.axis;
    result.step.rows.resize(numbers.size());
    std::vector<Row<Real>> made(numbers.size());
    forEachRow(numbers.size(), progress, [&](std::size_t i, RowScratch& lines) {
        analyseRow(*fine.find(numbers[i]), numbers[i], fine.K, lines, made[i], result.step.rows[i]);
    });
    result.coarse = emptyLike(fine);
    scaleSpacing(result.coarse.frame, fine.axis, 2);
    result.coarse.rows.reserve(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) result.coarse.rows[numbers[i]] = std::move(made[i]);
    return result;
}

template <class Real>
RowField<Real> synthesiseDirection(const RowField<Real>& coarse, const Step<Real>& step,
                                   const Progress& progress) {
    if (coarse.axis != step.axis)
        throw InputError("pyramid", "a step and the coarser field halve different directions");
    std::vector<Row<Real>> made(step.rows.size());
    forEachRow(made.size(), progress, [&](std::size_t i, RowScratch& lines) {
        made[i] = synthesiseRow(coarse.find(step.rows[i].row), step.rows[i], coarse.K, lines);
    });
    RowField<Real> fine = emptyLike(coarse);
    scaleSpacing(fine.frame, step.axis, 0.5);
    fine.rows.reserve(made.size());
    for (std::size_t i = 0; i < made.size(); ++i) fine.rows[step.rows[i].row] = std::move(made[i]);
    return fine;
}

#define ISOWAVE_INSTANTIATE(Real)                                                            \
    template DirectionResult<Real> analyseDirection(const RowField<Real>&, const Progress&); \
    template RowField<Real> synthesiseDirection(const RowField<Real>&, const Step<Real>&, const Progress&);
ISOWAVE_INSTANTIATE(float)
ISOWAVE_INSTANTIATE(double)
#undef ISOWAVE_INSTANTIATE

}  // namespace isowave::curves2d
