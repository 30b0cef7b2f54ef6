#include "wavelets/column_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "isowave/error.h"

namespace isowave::wavelets {

void ColumnLines::findLeaves(const Column& column, int axis) {
    column_ = &column;
    axis_ = axis;
    firstLeaf_ = (column.first - 1) & ~std::int64_t(1);
    const std::int64_t end = (column.end() + 2) & ~std::int64_t(1);
    fineLeaves_.assign(static_cast<std::size_t>(end - firstLeaf_), nullptr);
    std::copy(column.leaves.begin(), column.leaves.end(), fineLeaves_.begin() + (column.first - firstLeaf_));
}

void ColumnLines::plan(const ShapeAccessor& shape) {
    insideWithoutLeaf_.assign(fineLeaves_.size(), false);
    known_.assign(fineLeaves_.size(), LeafLines{});
    for (int k = 0; k < fineLeafCount(); ++k)
        if (const BoolLeaf* leaf = fineLeaves_[k])
            known_[k] = linesOf(wordsOf(leaf->getValueMask()), axis_);
        else
            insideWithoutLeaf_[k] = shape.getValue(fineOrigin(k));
    plan_.make(known_);
    if (plan_.hasShortRun()) {
        const LineRun run = plan_.shortRun();
        throw InputError(
            "shape",
            fmt::format("a run of {} control points along {} at position {} near ({}, {}); a field's "
                        "known control points are a union of 4x4x4 blocks, so runs are 4 or longer",
                        run.last - run.first + 1, "xyz"[axis_], firstLeaf_ * kLeafDim + run.first, column_->u,
                        column_->v));
    }
}

LeafWords ColumnLines::fineInside(int k) const {
    if (fineLeaves_[k]) return insideWordsOf(*fineLeaves_[k]);
    LeafWords words;
    words.fill(insideWithoutLeaf_[k] ? ~Word{0} : 0);
    return words;
}

bool ColumnLines::inside(int line, std::int64_t position) const {
    const auto k = static_cast<std::size_t>(position >> kLeafLog2);
    if (!fineLeaves_[k]) return insideWithoutLeaf_[k];
    const int at = offsetOf(axis_, line, static_cast<int>(position & (kLeafDim - 1)));
    return fineLeaves_[k]->buffer().data()[at >> 6] >> (at & 63) & 1;
}

}  // namespace isowave::wavelets
