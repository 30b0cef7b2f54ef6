#include "wavelets/interval/batch.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "wavelets/interval/blocks.h"
#include "wavelets/interval/kernels.h"

// What `objdump -d` shows (g++ 12 -O3, eight lanes an instruction). applyShort's inner loop: 4 vmulpd that
// take their second operand from memory, 4 vaddpd, 4 vbroadcastsd, two instructions of loop; all four sums in
// registers. solveBanded's: unrolled, the last five rows kept in registers, a row of eight lanes in 6 vmulpd
// (most broadcast their factor from memory) and 5 vsubpd. No vfmadd, no call but the one for the tables. Four
// and two lanes an instruction: the same twice and four times.

namespace isowave::wavelets {
namespace {

typedef double Double2 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));

static_assert(kLanes == kBlock, "a batch's lanes are a block's lines");

// Lanes that are not used read what the first does.
struct AllLanes {
    const float* lines[kLanes];
    AllLanes(const float* const (&used)[kLanes], int lanes) {
        for (int lane = 0; lane < kLanes; ++lane) lines[lane] = used[lane < lanes ? lane : 0];
    }
};

}  // namespace

double* BatchTransform::row0() { return scratch_.data() + kMargin * kLanes; }

void BatchTransform::start(int n) {
    const std::size_t fine = std::size_t(2 * n + 5) * kLanes;
    const std::size_t padded = std::size_t(kMargin + rowsOf(n) + kBandwidth) * kLanes;
    outAt_ = padded;
    foldedAt_ = 2 * padded;
    if (scratch_.size() < 2 * padded + fine) scratch_.resize(2 * padded + fine);
    // Elimination multiplies what is there with 0, and longer intervals may have left an infinity.
    if (n > kShort) std::fill_n(row0() + rowsOf(n) * kLanes, kBandwidth * kLanes, 0.0);
}

template <class Pack, bool kWide>
ISOWAVE_INLINE void BatchTransform::analyseBy(const AnalysisBatch& batch) {
    const int n = batch.n, lanes = batch.lanes;
    assert(n >= 1 && 1 <= lanes && lanes <= kLanes);
    start(n);
    double* const y = row0();
    loadLanes<kWide>(AllLanes(batch.fine, lanes).lines, 2 * n + 5, y + kFirstCoarseRow * kLanes, kLanes);
    for (int lane = 0; lane < lanes; lane += Pack::kWidth)
        analyseRows<Pack>(n, kLanes, y + lane, scratch_.data() + foldedAt_);
    storeLanes<kWide>(y + kFirstCoarseRow * kLanes, 2 * kLanes, n + 3, batch.coarse, lanes);
    storeLanes<kWide>(y + kFirstDetailRow * kLanes, 2 * kLanes, n, batch.detail, lanes);
}

template <class Pack, bool kWide>
ISOWAVE_INLINE void BatchTransform::synthesiseBy(const SynthesisBatch& batch) {
    const int n = batch.n, lanes = batch.lanes;
    assert(n >= 1 && 1 <= lanes && lanes <= kLanes);
    start(n);
    double *const y = row0(), *const out = y + outAt_;
    loadLanes<kWide>(AllLanes(batch.coarse, lanes).lines, n + 3, y + kFirstCoarseRow * kLanes, 2 * kLanes);
    loadLanes<kWide>(AllLanes(batch.detail, lanes).lines, n, y + kFirstDetailRow * kLanes, 2 * kLanes);
    for (int lane = 0; lane < kLanes; ++lane) {
        y[kLeftRow * kLanes + lane] = batch.left[lane < lanes ? lane : 0];
        y[kRightRow * kLanes + lane] = batch.right[lane < lanes ? lane : 0];
    }
    for (int lane = 0; lane < lanes; lane += Pack::kWidth)
        synthesiseRows<Pack>(n, kLanes, y + lane, scratch_.data() + foldedAt_, out + lane);
    storeLanes<kWide>(out + kFirstFineRow * kLanes, kLanes, 2 * n + 3, batch.fine, lanes);
}

ISOWAVE_FOUR void BatchTransform::analyseByFour(const AnalysisBatch& batch) {
    analyseBy<Two<Double4>, true>(batch);
}
ISOWAVE_EIGHT void BatchTransform::analyseByEight(const AnalysisBatch& batch) {
    analyseBy<Alone<Double8>, true>(batch);
}
ISOWAVE_FOUR void BatchTransform::synthesiseByFour(const SynthesisBatch& batch) {
    synthesiseBy<Two<Double4>, true>(batch);
}
ISOWAVE_EIGHT void BatchTransform::synthesiseByEight(const SynthesisBatch& batch) {
    synthesiseBy<Alone<Double8>, true>(batch);
}

void BatchTransform::analyse(const AnalysisBatch& batch) {
    switch (vectors_) {
        case Vectors::two:
            return analyseBy<Two<Double2>, false>(batch);
        case Vectors::four:
            return analyseByFour(batch);
        case Vectors::eight:
            return analyseByEight(batch);
    }
}

void BatchTransform::synthesise(const SynthesisBatch& batch) {
    switch (vectors_) {
        case Vectors::two:
            return synthesiseBy<Two<Double2>, false>(batch);
        case Vectors::four:
            return synthesiseByFour(batch);
        case Vectors::eight:
            return synthesiseByEight(batch);
    }
}

// Not on a hot path: two doubles an operation will do.
void BatchTransform::gain(const SynthesisBatch& batch) {
    using Pack = Two<Double2>;
    const int n = batch.n, lanes = batch.lanes, count = (2 * n + 5) * kLanes;
    assert(n >= 1 && 1 <= lanes && lanes <= kLanes);
    start(n);
    double *const y = row0(), *const out = y + outAt_, *const rows = y + kFirstCoarseRow * kLanes;
    std::fill_n(rows, count, 0.0);
    std::fill_n(y + kLeftRow * kLanes, 2 * kLanes,
                0.0);  // the map has 0 for the accessory values: they must be finite
    loadLanes<false>(AllLanes(batch.coarse, lanes).lines, n + 3, rows, 2 * kLanes);
    loadLanes<false>(AllLanes(batch.detail, lanes).lines, n, y + kFirstDetailRow * kLanes, 2 * kLanes);
    for (int i = 0; i < count; ++i) rows[i] = std::abs(rows[i]);
    for (int lane = 0; lane < lanes; lane += Pack::kWidth)
        gainRows<Pack>(n, kLanes, y + lane, scratch_.data() + foldedAt_, out + lane);
    storeLanes<false>(out + kFirstFineRow * kLanes, kLanes, 2 * n + 3, batch.fine, lanes);
}

}  // namespace isowave::wavelets
