#include "curves2d/row_field.h"

#include <algorithm>

namespace isowave::curves2d {
namespace {

// The first run that ends at `position` or behind it.
std::size_t runAtOrBehind(const std::vector<KnownRun>& runs, std::int32_t position) {
    return static_cast<std::size_t>(
        std::lower_bound(runs.begin(), runs.end(), position,
                         [](const KnownRun& run, std::int32_t p) { return run.last < p; }) -
        runs.begin());
}

}  // namespace

template <class Real>
std::vector<std::int32_t> RowField<Real>::rowNumbers() const {
    std::vector<std::int32_t> numbers;
    numbers.reserve(rows.size());
    for (const auto& [number, row] : rows) numbers.push_back(number);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

template <class Real>
std::int64_t RowField<Real>::controlPointCount() const {
    std::int64_t count = 0;
    for (const auto& [number, row] : rows) count += static_cast<std::int64_t>(row.values.size());
    return count;
}

template <class Real>
Bounds RowField<Real>::bounds() const {
    Bounds box;
    bool first = true;
    for (const auto& [number, row] : rows) {
        if (row.runs.empty()) continue;
        const std::int32_t low[2] = {row.runs.front().first, number},
                           high[2] = {row.runs.back().last, number};
        for (int a = 0; a < 2; ++a) {
            const int to = a == 0 ? axis : 1 - axis;
            box.first[to] = first ? low[a] : std::min(box.first[to], low[a]);
            box.last[to] = first ? high[a] : std::max(box.last[to], high[a]);
        }
        first = false;
    }
    return box;
}

template <class Real>
double RowField<Real>::at(std::int32_t x, std::int32_t y) const {
    double value;
    RowReader<Real>(find(axis == 0 ? y : x), K).read(axis == 0 ? x : y, std::span(&value, 1));
    return value;
}

template <class Real>
bool RowField<Real>::isKnown(std::int32_t x, std::int32_t y) const {
    const Row<Real>* row = find(axis == 0 ? y : x);
    if (!row) return false;
    const std::int32_t position = axis == 0 ? x : y;
    const std::size_t r = runAtOrBehind(row->runs, position);
    return r < row->runs.size() && row->runs[r].first <= position;
}

template <class Real>
void RowReader<Real>::read(std::int32_t first, std::span<double> out) {
    if (!row_) {
        std::fill(out.begin(), out.end(), K_);
        return;
    }
    const std::vector<KnownRun>& runs = row_->runs;
    const auto end = first + static_cast<std::int32_t>(out.size());
    for (; run_ < runs.size() && runs[run_].last < first; ++run_)
        value_ += static_cast<std::size_t>(runs[run_].last - runs[run_].first + 1);
    bool inside = run_ > 0 && runs[run_ - 1].insideAfter;
    std::int32_t p = first;
    auto write = out.begin();
    std::size_t v = value_;
    for (std::size_t r = run_; r < runs.size() && p < end; ++r) {
        const auto [runFirst, runLast, insideAfter] = runs[r];
        for (; p < std::min(runFirst, end); ++p) *write++ = inside ? -K_ : K_;
        const auto runEnd = v + static_cast<std::size_t>(runLast - runFirst + 1);
        v += static_cast<std::size_t>(p - std::min(p, runFirst));
        for (; p <= runLast && p < end; ++p) *write++ = static_cast<double>(row_->values[v++]);
        v = runEnd;
        inside = insideAfter;
    }
    for (; p < end; ++p) *write++ = inside ? -K_ : K_;
}

// Rows are visited in ascending order, so every column's points arrive in ascending order: a point either
// lengthens its column's last run or opens a new one. What is left is the sign behind a run that ends between
// row y-1 and row y: that of (x, y), which is unknown: + unless (x, y) lies in an inside gap of row y.
template <class Real>
RowField<Real> transposed(const RowField<Real>& field) {
    RowField<Real> out;
    out.axis = 1 - field.axis;
    out.K = field.K;
    out.frame = field.frame;
    const Row<Real>* before = nullptr;
    std::int32_t beforeNumber = 0;
    for (const std::int32_t y : field.rowNumbers()) {
        const Row<Real>& row = *field.find(y);
        std::size_t v = 0;
        for (const KnownRun& run : row.runs)
            for (std::int32_t x = run.first; x <= run.last; ++x) {
                Row<Real>& column = out.rows[x];
                if (!column.runs.empty() && column.runs.back().last == y - 1)
                    column.runs.back().last = y;
                else
                    column.runs.push_back({y, y, false});
                column.values.push_back(row.values[v++]);
            }
        if (before && beforeNumber == y - 1) {
            std::size_t b = 0;
            for (std::size_t r = 0; r + 1 < row.runs.size(); ++r) {
                if (!row.runs[r].insideAfter) continue;
                const std::int32_t gapFirst = row.runs[r].last + 1, gapLast = row.runs[r + 1].first - 1;
                while (b < before->runs.size() && before->runs[b].last < gapFirst) ++b;
                for (std::size_t i = b; i < before->runs.size() && before->runs[i].first <= gapLast; ++i)
                    for (std::int32_t x = std::max(gapFirst, before->runs[i].first);
                         x <= std::min(gapLast, before->runs[i].last); ++x)
                        out.rows[x].runs.back().insideAfter = true;
            }
        }
        before = &row;
        beforeNumber = y;
    }
    for (auto column = out.rows.begin(); column != out.rows.end(); ++column) {
        column.value().runs.shrink_to_fit();
        column.value().values.shrink_to_fit();
    }
    return out;
}

namespace {

// Runs of coarse control points first .. last -> the fine ones 2 first - 2 .. 2 last + 2 that they have a weight in.
std::vector<KnownRun> runsOnHalfSpacing(const std::vector<KnownRun>& coarse) {
    std::vector<KnownRun> fine;
    for (const auto& [first, last, insideAfter] : coarse) {
        if (!fine.empty() && 2 * first - 2 <= fine.back().last + 1) {
            fine.back().last = 2 * last + 2;
            fine.back().insideAfter = insideAfter;
        } else {
            fine.push_back({2 * first - 2, 2 * last + 2, insideAfter});
        }
    }
    return fine;
}

template <class Real>
RowField<Real> halvedAlongRows(const RowField<Real>& field) {
    RowField<Real> out;
    out.axis = field.axis;
    out.K = field.K;
    out.frame = field.frame;
    (field.axis == 0 ? out.frame.spacing.x : out.frame.spacing.y) /= 2;
    std::vector<double> c;
    for (const auto& [number, row] : field.rows) {
        Row<Real> fine;
        fine.runs = runsOnHalfSpacing(row.runs);
        RowReader<Real> reader(&row, field.K);
        for (const KnownRun& run : fine.runs) {  // both ends are even
            const std::int32_t first = run.first / 2, last = run.last / 2;
            c.resize(static_cast<std::size_t>(last - first + 3));
            reader.read(first - 1, c);
            for (std::size_t i = 1; i + 1 < c.size(); ++i) {
                fine.values.push_back(static_cast<Real>((c[i - 1] + 6 * c[i] + c[i + 1]) / 8));
                if (i + 2 < c.size()) fine.values.push_back(static_cast<Real>((c[i] + c[i + 1]) / 2));
            }
        }
        out.rows[number] = std::move(fine);
    }
    return out;
}

}  // namespace

template <class Real>
RowField<Real> onHalfSpacing(const RowField<Real>& field) {
    const RowField<Real> half = transposed(halvedAlongRows(field));
    RowField<Real> out = halvedAlongRows(half);
    return out.axis == 0 ? out : transposed(out);
}

template <class Real>
std::int64_t definedNodeCount(const RowField<Real>& field) {
    std::int64_t count = 0;
    for (const auto& [number, row] : field.rows) {
        const std::vector<KnownRun>* runs[4];
        bool all = true;
        for (int k = 0; k < 4 && all; ++k) {
            const Row<Real>* other = field.find(number + k);
            all = other != nullptr;
            if (all) runs[k] = &other->runs;
        }
        if (!all) continue;
        // Common spans of the four rows, by advancing whichever run ends first.
        std::size_t at[4] = {};
        while (at[0] < runs[0]->size() && at[1] < runs[1]->size() && at[2] < runs[2]->size() &&
               at[3] < runs[3]->size()) {
            std::int32_t first = INT32_MIN, last = INT32_MAX;
            int earliest = 0;
            for (int k = 0; k < 4; ++k) {
                const KnownRun& run = (*runs[k])[at[k]];
                first = std::max(first, run.first);
                if (run.last < last) {
                    last = run.last;
                    earliest = k;
                }
            }
            count += std::max(0, last - first + 1 - 3);
            ++at[earliest];
        }
    }
    return count;
}

template <class Real>
Sample sample(const RowField<Real>& field, Point lattice) {
    const double u = field.axis == 0 ? lattice.x : lattice.y, v = field.axis == 0 ? lattice.y : lattice.x;
    const auto i = static_cast<std::int32_t>(std::floor(u)), j = static_cast<std::int32_t>(std::floor(v));
    const auto wu = splineWeights(u - i), du = splineSlopes(u - i), wv = splineWeights(v - j),
               dv = splineSlopes(v - j);
    double value = 0, along = 0, across = 0;
    for (int k = 0; k < 4; ++k) {
        std::array<double, 4> c;
        RowReader<Real>(field.find(j - 1 + k), field.K).read(i - 1, c);
        const double f = wu[0] * c[0] + wu[1] * c[1] + wu[2] * c[2] + wu[3] * c[3];
        value += wv[k] * f;
        across += dv[k] * f;
        along += wv[k] * (du[0] * c[0] + du[1] * c[1] + du[2] * c[2] + du[3] * c[3]);
    }
    return {value, field.axis == 0 ? Point{along, across} : Point{across, along}};
}

#define ISOWAVE_INSTANTIATE(Real)                                  \
    template struct RowField<Real>;                                \
    template class RowReader<Real>;                                \
    template RowField<Real> transposed(const RowField<Real>&);     \
    template RowField<Real> onHalfSpacing(const RowField<Real>&);  \
    template std::int64_t definedNodeCount(const RowField<Real>&); \
    template Sample sample(const RowField<Real>&, Point);
ISOWAVE_INSTANTIATE(float)
ISOWAVE_INSTANTIATE(double)
#undef ISOWAVE_INSTANTIATE

}  // namespace isowave::curves2d
