#include "curves2d/spans.h"

#include <algorithm>

namespace isowave::curves2d {
namespace {

// Appends a span that starts no earlier than the last one did.
void append(Spans& out, Span span) {
    if (!out.empty() && span.first <= out.back().last + 1)
        out.back().last = std::max(out.back().last, span.last);
    else
        out.push_back(span);
}

}  // namespace

void normalise(Spans& spans) {
    std::sort(spans.begin(), spans.end(), [](Span a, Span b) { return a.first < b.first; });
    Spans out;
    for (const Span& span : spans) append(out, span);
    spans = std::move(out);
}

Spans unite(const Spans& a, const Spans& b) {
    Spans out;
    out.reserve(a.size() + b.size());
    auto i = a.begin(), j = b.begin();
    while (i != a.end() || j != b.end())
        append(out, j == b.end() || (i != a.end() && i->first <= j->first) ? *i++ : *j++);
    return out;
}

Spans intersection(const Spans& a, const Spans& b) {
    Spans out;
    for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
        const Span both{std::max(i->first, j->first), std::min(i->last, j->last)};
        if (both.first <= both.last) out.push_back(both);
        i->last < j->last ? ++i : ++j;
    }
    return out;
}

Spans difference(const Spans& a, const Spans& b) {
    Spans out;
    auto j = b.begin();
    for (Span span : a) {
        while (j != b.end() && j->last < span.first) ++j;
        for (auto k = j; k != b.end() && k->first <= span.last; ++k) {
            if (k->first > span.first) out.push_back({span.first, k->first - 1});
            span.first = k->last + 1;
        }
        if (span.first <= span.last) out.push_back(span);
    }
    return out;
}

Spans dilated(const Spans& spans, std::int32_t left, std::int32_t right) {
    Spans out;
    out.reserve(spans.size());
    for (const Span& span : spans) append(out, {span.first - left, span.last + right});
    return out;
}

bool contains(const Spans& spans, std::int32_t position) {
    const auto behind = std::upper_bound(spans.begin(), spans.end(), position,
                                         [](std::int32_t p, const Span& span) { return p < span.first; });
    return behind != spans.begin() && std::prev(behind)->last >= position;
}

bool Region::empty() const {
    return std::all_of(rows.begin(), rows.end(), [](const Spans& row) { return row.empty(); });
}

std::int64_t Region::pointCount() const {
    std::int64_t count = 0;
    for (const Spans& row : rows)
        for (const Span& span : row) count += span.last - span.first + 1;
    return count;
}

Region withRows(std::int32_t first, std::int32_t last) {
    Region region;
    region.firstRow = first;
    region.rows.resize(static_cast<std::size_t>(std::max(0, last - first + 1)));
    return region;
}

Region unite(const Region& a, const Region& b) {
    if (a.rows.empty()) return b;
    if (b.rows.empty()) return a;
    Region out = withRows(std::min(a.firstRow, b.firstRow), std::max(a.endRow(), b.endRow()) - 1);
    for (std::int32_t y = out.firstRow; y < out.endRow(); ++y)
        out.rows[static_cast<std::size_t>(y - out.firstRow)] = unite(a.row(y), b.row(y));
    return out;
}

Region dilated(const Region& region, std::int32_t before, std::int32_t after) {
    if (region.rows.empty()) return region;
    Region out = withRows(region.firstRow - before, region.endRow() - 1 + after);
    for (std::int32_t y = out.firstRow; y < out.endRow(); ++y) {
        Spans spans;
        for (std::int32_t from = y - after; from <= y + before; ++from)
            spans.insert(spans.end(), region.row(from).begin(), region.row(from).end());
        normalise(spans);
        out.rows[static_cast<std::size_t>(y - out.firstRow)] = dilated(spans, before, after);
    }
    return out;
}

}  // namespace isowave::curves2d
