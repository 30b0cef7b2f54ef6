#include "curves2d/hold/ascent.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

#include "curves2d/hold/mixed.h"

namespace isowave::curves2d {
namespace {

constexpr std::int32_t kSquare = 16;  // nodes; wider than the 3 that weights reach beyond a node
constexpr int kInnerSweeps = 12;
constexpr std::int32_t kPad = 3;  // so that four neighbours, one of them known, lie in one piece
constexpr std::int32_t kOutside = 0, kInside = 4;  // four control points each that stand for unknown ones

std::int32_t floorDivided(std::int32_t a, std::int32_t b) { return a / b - (a % b < 0); }

Spans padded(const std::vector<KnownRun>& runs) {
    Spans spans;
    for (const KnownRun& run : runs) spans.push_back({run.first - kPad, run.last + kPad});
    normalise(spans);
    return spans;
}

}  // namespace

Ascent::Ascent(const RowField<float>& field) : field_(&field) {
    assert(field.axis == 0);
    values_.assign(4, field.K);
    values_.insert(values_.end(), 4, -field.K);
    known_.assign(8, 0);
    for (const std::int32_t y : field.rowNumbers()) {
        const Row<float>& row = *field.find(y);
        RowReader<float> reader(&row, field.K);
        std::vector<Piece>& pieces = pieces_[y];
        for (const Span& span : padded(row.runs)) {
            const std::size_t start = values_.size();
            pieces.push_back({span.first, span.last, static_cast<std::int32_t>(start)});
            values_.resize(start + static_cast<std::size_t>(span.last - span.first + 1));
            reader.read(span.first, std::span(values_).subspan(start));
            known_.resize(values_.size(), 0);
        }
        for (const KnownRun& run : row.runs) {
            const auto first = known_.begin() + baseOf(run.first, y);
            std::fill(first, first + (run.last - run.first + 1), char(1));
        }
    }
}

// Index of control points x .. x+3 of row y.
std::int32_t Ascent::baseOf(std::int32_t x, std::int32_t y) const {
    const auto row = pieces_.find(y);
    if (row == pieces_.end()) return kOutside;
    const auto piece = std::lower_bound(row->second.begin(), row->second.end(), x,
                                        [](const Piece& p, std::int32_t at) { return p.last < at; });
    if (piece != row->second.end() && piece->first <= x && x + 3 <= piece->last)
        return piece->start + (x - piece->first);
    return field_->at(x, y) < 0 ? kInside : kOutside;  // all four are unknown and of one sign
}

void Ascent::add(const Constraint& row) {
    const auto x = static_cast<std::int32_t>(std::floor(row.at.x)),
               y = static_cast<std::int32_t>(std::floor(row.at.y));
    Held held{{}, {x, y}, row.at.x - x, row.at.y - y, row.side, row.offset, row.softness, 0, true};
    int count = 0;
    for (std::int32_t k = 0; k < 4; ++k) {
        held.base[static_cast<std::size_t>(k)] = baseOf(x - 1, y - 1 + k);
        const auto first = known_.begin() + held.base[static_cast<std::size_t>(k)];
        count += static_cast<int>(std::count(first, first + 4, char(1)));
    }
    held.allKnown = count == 16;
    if (count > 0) rows_.push_back(held);
}

// Rows in the order in which they are visited: by square, then shuffled.
void Ascent::cutIntoSquares() {
    struct Key {
        std::int32_t y, x;
        std::uint64_t hash;
        std::uint32_t row;
    };
    std::vector<Key> keys;
    keys.reserve(rows_.size());
    for (std::uint32_t i = 0; i < rows_.size(); ++i)
        keys.push_back(
            {floorDivided(rows_[i].node[1], kSquare), floorDivided(rows_[i].node[0], kSquare), mixed(i), i});
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return std::tie(a.y, a.x, a.hash) < std::tie(b.y, b.x, b.hash);
    });
    std::vector<Held> ordered;
    ordered.reserve(rows_.size());
    squares_.clear();
    for (auto& colour : colours_) colour.clear();
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        if (i == 0 || keys[i].y != keys[i - 1].y || keys[i].x != keys[i - 1].x) {
            colours_[static_cast<std::size_t>(2 * (keys[i].y & 1) + (keys[i].x & 1))].push_back(
                static_cast<std::uint32_t>(squares_.size()));
            squares_.push_back({i, i, {}});
        }
        ++squares_.back().end;
        ordered.push_back(rows_[keys[i].row]);
    }
    rows_ = std::move(ordered);
}

// Returns by how much the row's value changed.
double Ascent::visit(Held& row, bool& active, double tolerance) {
    const auto u = splineWeights(row.tx), v = splineWeights(row.ty);
    double F = 0, ww = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const double* c = values_.data() + row.base[k];
        F += v[k] * (u[0] * c[0] + u[1] * c[1] + u[2] * c[2] + u[3] * c[3]);
        const char* known = known_.data() + row.base[k];
        for (std::size_t z = 0; z < 4; ++z)
            if (row.allKnown || known[z]) ww += (v[k] * u[z]) * (v[k] * u[z]);
    }
    const double violation = row.side * F + row.offset;
    const double lambda =
        std::max(0.0, row.lambda + (violation - row.softness * row.lambda) / (ww + row.softness));
    const double step = lambda - row.lambda;
    row.lambda = lambda;
    active = lambda > 0 || violation > -tolerance;
    if (step == 0) return 0;
    for (std::size_t k = 0; k < 4; ++k) {
        double* c = values_.data() + row.base[k];
        const char* known = known_.data() + row.base[k];
        for (std::size_t z = 0; z < 4; ++z)
            if (row.allKnown || known[z]) c[z] -= row.side * step * v[k] * u[z];
    }
    return std::abs(step) * ww;
}

// The squares of a colour at the same time. The largest change of a value.
double Ascent::sweep(const std::vector<std::uint32_t>& squares, bool active, bool backwards,
                     double tolerance) {
    std::vector<double> most(squares.size(), 0);
    tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t s) {
        Square& square = squares_[squares[s]];
        bool isActive = false;
        if (!active) {
            square.active.clear();
            for (std::uint32_t i = square.begin; i < square.end; ++i) {
                most[s] = std::max(most[s], visit(rows_[i], isActive, tolerance));
                if (isActive) square.active.push_back(i);
            }
            return;
        }
        const std::size_t count = square.active.size();
        for (std::size_t k = 0; k < count; ++k)
            most[s] = std::max(
                most[s], visit(rows_[square.active[backwards ? count - 1 - k : k]], isActive, tolerance));
    });
    return most.empty() ? 0 : *std::max_element(most.begin(), most.end());
}

int Ascent::run(double tolerance, int mostRounds, const Progress& progress) {
    cutIntoSquares();
    for (int round = 1; round <= mostRounds; ++round) {
        progress.check();
        double all = 0;
        for (const auto& colour : colours_) all = std::max(all, sweep(colour, false, false, tolerance));
        if (all <= tolerance) return round;
        for (int inner = 0; inner < kInnerSweeps; ++inner) {
            double most = 0;
            for (const auto& colour : colours_)
                most = std::max(most, sweep(colour, true, inner % 2 == 0, tolerance));
            if (most <= tolerance / 2) break;
        }
    }
    return mostRounds;
}

std::int64_t Ascent::write(RowField<float>& field) const {
    std::int64_t changed = 0;
    for (auto at = field.rows.begin(); at != field.rows.end(); ++at) {
        Row<float>& row = at.value();
        std::size_t v = 0;
        for (const KnownRun& run : row.runs) {
            const double* values = values_.data() + baseOf(run.first, at->first);
            for (std::int32_t x = run.first; x <= run.last; ++x, ++v) {
                const auto value = static_cast<float>(*values++);
                changed += value != row.values[v];
                row.values[v] = value;
            }
        }
    }
    return changed;
}

}  // namespace isowave::curves2d
