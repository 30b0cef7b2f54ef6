#include "wavelets/interval/interval.h"

#include <algorithm>
#include <cassert>

#include "wavelets/interval/kernels.h"

// Two paths that compute the same thing (kernels.h):
//   short  n <= kShort: one small dense matrix for each n, folded by its mirror symmetry
//   long   banded LU of T = interleaved [P|Q] without pivoting: |L| <= 13.8, |U| <= 1.8, pivots >= 0.07 for
//          every n (IntervalMatrices.TheBandedFactorsStayBounded)
// Rejected here: analysis by the two Gram systems E(7), E(8). Two banded solves instead of one.

namespace isowave::wavelets {

IntervalTransform::IntervalTransform() {
    shortAnalysis(1);
    shortSynthesis(1);
    bandFactors();
}

double* IntervalTransform::row0(int n) {
    const std::size_t padded = std::size_t(kMargin + rowsOf(n) + kBandwidth);
    scratch_.assign(2 * padded + 2 * n + 5, 0.0);
    return scratch_.data() + kMargin;
}

void IntervalTransform::analyse(std::span<const double> fine, double left, double right,
                                std::span<double> coarse, std::span<double> detail) {
    const int n = static_cast<int>(detail.size());
    assert(n >= 1 && fine.size() == detail.size() * 2 + 3 && coarse.size() == detail.size() + 3);
    double* const y = row0(n);
    y[kFirstFineRow - 1] = left;
    std::copy(fine.begin(), fine.end(), y + kFirstFineRow);
    y[kFirstFineRow + 2 * n + 3] = right;
    analyseRows<One>(n, 1, y, folded(n));
    for (int j = 0; j < n + 3; ++j) coarse[j] = y[kFirstCoarseRow + 2 * j];
    for (int k = 0; k < n; ++k) detail[k] = y[kFirstDetailRow + 2 * k];
}

void IntervalTransform::synthesise(std::span<const double> coarse, std::span<const double> detail,
                                   double left, double right, std::span<double> fine) {
    const int n = static_cast<int>(detail.size());
    assert(n >= 1 && fine.size() == detail.size() * 2 + 3 && coarse.size() == detail.size() + 3);
    double* const y = row0(n);
    double* const out = y + kMargin + rowsOf(n) + kBandwidth;
    y[kLeftRow] = left;
    y[kRightRow] = right;
    for (int j = 0; j < n + 3; ++j) y[kFirstCoarseRow + 2 * j] = coarse[j];
    for (int k = 0; k < n; ++k) y[kFirstDetailRow + 2 * k] = detail[k];
    synthesiseRows<One>(n, 1, y, folded(n), out);
    std::copy_n(out + kFirstFineRow, 2 * n + 3, fine.begin());
}

}  // namespace isowave::wavelets
