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

}  // namespace isowave::curves2d
