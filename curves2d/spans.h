// Sets of integers as sorted lists of spans: the known positions of a row, the inside positions of a row.
// Every operation is linear in the number of spans.
#pragma once

#include <cstdint>
#include <vector>

namespace isowave::curves2d {

// Positions first .. last, both included.
struct Span {
    std::int32_t first, last;
    friend bool operator==(const Span&, const Span&) = default;
};

// Ascending, with at least one position between neighbours.
using Spans = std::vector<Span>;

// Sorts by `first` and joins spans that overlap or touch.
void normalise(Spans& spans);

// The union of two normal lists.
Spans unite(const Spans& a, const Spans& b);

// What lies in both; what lies in a and not in b.
Spans intersection(const Spans& a, const Spans& b);
Spans difference(const Spans& a, const Spans& b);

// Every span grown by `left` to the left and `right` to the right; joined where they then overlap or touch.
Spans dilated(const Spans& spans, std::int32_t left, std::int32_t right);

bool contains(const Spans& spans, std::int32_t position);

// Walks a normal list from left to right: answers for ascending positions in constant time on average.
class SpanCursor {
  public:
    explicit SpanCursor(const Spans& spans) : spans_(&spans) {}
    // REQUIRES: no smaller than the position asked for before.
    bool contains(std::int32_t position) {
        while (at_ < spans_->size() && (*spans_)[at_].last < position) ++at_;
        return at_ < spans_->size() && (*spans_)[at_].first <= position;
    }

  private:
    const Spans* spans_;
    std::size_t at_ = 0;
};

// A set of lattice points of the plane, row by row: a bitmap as run lengths. Rows outside are empty.
struct Region {
    std::int32_t firstRow = 0;
    std::vector<Spans> rows;

    std::int32_t endRow() const { return firstRow + static_cast<std::int32_t>(rows.size()); }
    const Spans& row(std::int32_t y) const {
        static const Spans none;
        return y < firstRow || y >= endRow() ? none : rows[static_cast<std::size_t>(y - firstRow)];
    }
    bool contains(std::int32_t x, std::int32_t y) const { return curves2d::contains(row(y), x); }
    bool empty() const;
    std::int64_t pointCount() const;
};

// A region with room for rows first .. last.
Region withRows(std::int32_t first, std::int32_t last);
Region unite(const Region& a, const Region& b);
// Grown by before/after on both axes.
Region dilated(const Region& region, std::int32_t before, std::int32_t after);

}  // namespace isowave::curves2d
