#include "wavelets/interval_batch.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "wavelets/interval_kernels.h"

// What `objdump -d` shows (g++ 12 -O3, four lanes an instruction). applyShort's inner loop: 8 vmulpd that take their
// second operand from memory, 8 vaddpd, 4 vbroadcastsd, two instructions of loop; all eight sums in registers. solveBanded's:
// unrolled three times, the last five rows kept in registers, a row of eight lanes in 12 vmulpd, 10 vsubpd and 6
// vbroadcastsd. No vfmadd, no call but the one for the tables. Two lanes an instruction: the same with mulpd, addpd.

namespace isowave::wavelets {
namespace {

typedef double Double2 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));

bool hasFour() {
#if defined(__x86_64__) && defined(__GNUC__)
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

}  // namespace

IntervalBatch::IntervalBatch() : four_(hasFour()), ends_(2 * kLanes) {}

double* IntervalBatch::row0() { return scratch_.data() + kMargin * kLanes; }

void IntervalBatch::start(int n, int lanes) {
    assert(n >= 1 && 1 <= lanes && lanes <= kLanes);
    n_ = n;
    const std::size_t fine = std::size_t(2 * n + 5) * kLanes;
    const std::size_t padded = std::size_t(kMargin + rowsOf(n) + kBandwidth) * kLanes;
    outAt_ = padded;
    foldedAt_ = 2 * padded;
    if (rows_.size() < fine) rows_.resize(fine);
    if (scratch_.size() < 2 * padded + fine) scratch_.resize(2 * padded + fine);
    std::fill_n(row0() + rowsOf(n) * kLanes, kBandwidth * kLanes, 0.0);  // longer ones left values there
    if (lanes < kLanes) std::fill_n(rows_.begin(), fine, 0.0f);
}

template <class Pack>
[[gnu::always_inline]] inline void IntervalBatch::analyseBy() {
    constexpr std::ptrdiff_t kStride = kLanes;
    const int count = (2 * n_ + 5) * kLanes;
    double* const y = row0();
    double* const rows = y + kFirstCoarseRow * kStride;
    for (int i = 0; i < count; ++i) rows[i] = rows_[i];
    for (int lane = 0; lane < kLanes; lane += Pack::kLanes)
        analyseRows<Pack>(n_, kStride, y + lane, scratch_.data() + foldedAt_);
    for (int i = 0; i < count; ++i) rows_[i] = static_cast<float>(rows[i]);
}

// rows() and ends, in double; returns row 0.
[[gnu::always_inline]] inline double* IntervalBatch::loadCoefficients() {
    const int count = (2 * n_ + 5) * kLanes;
    double* const y = row0();
    double* const rows = y + kFirstCoarseRow * kLanes;
    for (int i = 0; i < count; ++i) rows[i] = rows_[i];
    for (int i = 0; i < kLanes; ++i) {
        y[kLeftRow * kLanes + i] = ends_[i];
        y[kRightRow * kLanes + i] = ends_[kLanes + i];
    }
    return y;
}

[[gnu::always_inline]] inline void IntervalBatch::storeFine(const double* out) {
    const int count = (2 * n_ + 3) * kLanes;
    const double* const fine = out + kFirstFineRow * kLanes;
    for (int i = 0; i < count; ++i) rows_[kLanes + i] = static_cast<float>(fine[i]);
}

template <class Pack>
[[gnu::always_inline]] inline void IntervalBatch::synthesiseBy() {
    double *const y = loadCoefficients(), *const out = y + outAt_;
    for (int lane = 0; lane < kLanes; lane += Pack::kLanes)
        synthesiseRows<Pack>(n_, kLanes, y + lane, scratch_.data() + foldedAt_, out + lane);
    storeFine(out);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) void IntervalBatch::analyseByFour() { analyseBy<Two<Double4>>(); }
__attribute__((target("avx2"))) void IntervalBatch::synthesiseByFour() { synthesiseBy<Two<Double4>>(); }
#else
void IntervalBatch::analyseByFour() { analyseBy<Two<Double2>>(); }
void IntervalBatch::synthesiseByFour() { synthesiseBy<Two<Double2>>(); }
#endif

void IntervalBatch::analyse() {
    if (four_) return analyseByFour();
    analyseBy<Two<Double2>>();
}

void IntervalBatch::synthesise() {
    if (four_) return synthesiseByFour();
    synthesiseBy<Two<Double2>>();
}

// Not on a hot path: two doubles an operation will do.
void IntervalBatch::gain() {
    using Pack = Two<Double2>;
    double *const y = loadCoefficients(), *const out = y + outAt_;  // the map has 0 for the accessory values
    double* const rows = y + kFirstCoarseRow * kLanes;
    for (int i = 0; i < (2 * n_ + 5) * kLanes; ++i) rows[i] = std::abs(rows[i]);
    for (int lane = 0; lane < kLanes; lane += Pack::kLanes)
        gainRows<Pack>(n_, kLanes, y + lane, scratch_.data() + foldedAt_, out + lane);
    storeFine(out);
}

}  // namespace isowave::wavelets
