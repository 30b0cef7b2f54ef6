#include "wavelets/interval.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "wavelets/interval_matrices.h"

// Two paths that compute the same thing:
//   short  n <= kShort: one small dense matrix for each n, applied column by column. That is what a compiler
//          vectorises, and most intervals of a real field have 4 to 12 points
//   long   banded LU of T = interleaved [P|Q] without pivoting: |L| <= 13.8, |U| <= 1.8, pivots >= 0.07 for
//          every n (IntervalMatrices.TheBandedFactorsStayBounded)
// Rejected here: analysis by the two Gram systems E(7), E(8). Two banded solves instead of one.

namespace isowave::wavelets {
namespace {

constexpr int kShort = 16;

// ---- short: dense maps ----------------------------------------------------------------------------------

// Column-major (2n+3) x (2n+5).
struct DenseMap {
    int size = 0;
    std::vector<double> columns;

    // out = M (left; head; tail; right)
    void apply(double left, std::span<const double> head, std::span<const double> tail, double right,
               double* out) const {
        const double* column = columns.data();
        for (int i = 0; i < size; ++i) out[i] = column[i] * left;
        column += size;
        for (const auto part : {head, tail})
            for (const double x : part) {
                for (int i = 0; i < size; ++i) out[i] += column[i] * x;
                column += size;
            }
        for (int i = 0; i < size; ++i) out[i] += column[i] * right;
    }
};

DenseMap toDense(const Matrix& m) {
    DenseMap map{static_cast<int>(m.rows()), {}};
    map.columns.reserve(m.size());
    for (int j = 0; j < m.cols(); ++j)
        for (int i = 0; i < m.rows(); ++i) map.columns.push_back(static_cast<double>(m(i, j)));
    return map;
}

struct ShortMaps {
    std::array<DenseMap, kShort + 1> analysis, synthesis;

    ShortMaps() {
        for (int n = 1; n <= kShort; ++n) {
            analysis[n] = toDense(analysisMap(n));
            synthesis[n] = toDense(synthesisMap(n));
        }
    }
};

const ShortMaps& shortMaps() {
    static const ShortMaps maps;
    return maps;
}

// ---- long: banded factors -------------------------------------------------------------------------------

// Row i of T = L U: L(i, i-5..i-1), 1/U(i,i), U(i, i+1..i+5); and row i of T itself, T(i, i-5..i+5).
struct BandRow {
    std::array<double, kBandwidth> lower{};
    double inversePivot = 0;
    std::array<double, kBandwidth> upper{};
    std::array<double, 2 * kBandwidth + 1> t{};
};

std::vector<BandRow> factor(int ne) {
    Matrix t = interleavedMatrix(ne);
    const int size = static_cast<int>(t.rows());
    std::vector<BandRow> rows(size);
    for (int i = 0; i < size; ++i)
        for (int s = -kBandwidth; s <= kBandwidth; ++s)
            if (i + s >= 0 && i + s < size) rows[i].t[s + kBandwidth] = static_cast<double>(t(i, i + s));
    for (int k = 0; k < size; ++k)
        for (int i = k + 1; i < std::min(size, k + kBandwidth + 1); ++i) {
            const Real multiplier = t(i, k) / t(k, k);
            for (int j = k; j < std::min(size, k + kBandwidth + 1); ++j) t(i, j) -= multiplier * t(k, j);
            t(i, k) = multiplier;
        }
    for (int i = 0; i < size; ++i) {
        rows[i].inversePivot = static_cast<double>(1 / t(i, i));
        for (int s = 1; s <= kBandwidth; ++s) {
            if (i - s >= 0) rows[i].lower[kBandwidth - s] = static_cast<double>(t(i, i - s));
            if (i + s < size) rows[i].upper[s - 1] = static_cast<double>(t(i, i + s));
        }
    }
    return rows;
}

// The factors of every length from one reference. Row i of L and U depends on the leading i rows of T alone,
// so the head is common to all lengths; it becomes stationary with period 2 (differences fall 3.4x every two
// rows, below 1e-17 after kHead rows), and the last kTail rows, where the right end shows, are then common as
// well. Lengths that are too short for a stationary middle have factors of their own.
constexpr int kHead = 80, kTail = 24;
constexpr int kReference = 64;  // coarse intervals of the reference: 131 rows

class BandFactors {
  public:
    BandFactors() {
        for (int ne = kShort + kAccessory + 1; ne <= kReference; ++ne) own_.push_back(factor(ne));
        recoverLeft_ = recoverBlock({0, 1, 2, 4}, 0);
        const int last = 2 * kReference + 2;
        recoverRight_ = recoverBlock({last, last - 1, last - 2, last - 4}, last - 3);
    }

    // Calls f(i, row) for i = 0 .. 2ne+2 ascending, or descending.
    template <class F>
    void ascending(int ne, const F& f) const {
        const int size = 2 * ne + 3;
        for (int i = 0; i < size; ++i) f(i, row(ne, size, i));
    }
    template <class F>
    void descending(int ne, const F& f) const {
        const int size = 2 * ne + 3;
        for (int i = size - 1; i >= 0; --i) f(i, row(ne, size, i));
    }

    // Columns of T that hold rejected coefficients at the left: c0, c1, d0, d1; mirrored at the right.
    static constexpr std::array<int, 4> kRejectedColumns = {0, 1, 2, 4};

    // values: right-hand sides of the four accessory rows (outermost first); returns the coefficients in the
    // columns kRejectedColumns counted from the outer end.
    std::array<double, 4> recoverLeft(const std::array<double, 4>& values) const {
        return multiply(recoverLeft_, values);
    }
    std::array<double, 4> recoverRight(const std::array<double, 4>& values) const {
        return multiply(recoverRight_, {values[3], values[2], values[1], values[0]});
    }

  private:
    using Block = std::array<std::array<double, 4>, 4>;

    const BandRow& row(int ne, int size, int i) const {
        if (ne <= kReference) return own_[ne - (kShort + kAccessory + 1)][i];
        const auto& reference = own_.back();
        const int referenceSize = 2 * kReference + 3;
        if (i < kHead) return reference[i];
        if (i >= size - kTail) return reference[i - (size - referenceSize)];
        return reference[kHead + (i & 1)];  // kHead is even
    }

    // Inverse of T(firstRow .. firstRow+3, columns); rows ascending, columns as given.
    static Block recoverBlock(const std::array<int, 4>& columns, int firstRow) {
        const Matrix t = interleavedMatrix(kReference);
        Matrix m(4, 4);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) m(i, j) = t(firstRow + i, columns[j]);
        const Matrix inverse = m.fullPivLu().inverse();
        Block block;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) block[i][j] = static_cast<double>(inverse(i, j));
        return block;
    }

    static std::array<double, 4> multiply(const Block& m, const std::array<double, 4>& v) {
        std::array<double, 4> out{};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) out[i] += m[i][j] * v[j];
        return out;
    }

    std::vector<std::vector<BandRow>> own_;
    Block recoverLeft_, recoverRight_;
};

const BandFactors& bandFactors() {
    static const BandFactors factors;
    return factors;
}

// Solves L U y = x in place. y must have kBandwidth zeros of padding on either side.
void solveBanded(int ne, double* y) {
    const BandFactors& factors = bandFactors();
    factors.ascending(ne, [y](int i, const BandRow& row) {
        double sum = y[i];
        for (int s = 0; s < kBandwidth; ++s) sum -= row.lower[s] * y[i - kBandwidth + s];
        y[i] = sum;
    });
    factors.descending(ne, [y](int i, const BandRow& row) {
        double sum = y[i];
        for (int s = 0; s < kBandwidth; ++s) sum -= row.upper[s] * y[i + 1 + s];
        y[i] = sum * row.inversePivot;
    });
}

double bandProduct(const BandRow& row, const double* y) {
    double sum = 0;
    for (int s = 0; s <= 2 * kBandwidth; ++s) sum += row.t[s] * y[s - kBandwidth];
    return sum;
}

}  // namespace

void joinRuns(std::span<const Run> runs, std::vector<Interval>& out) {
    out.clear();
    for (const Run& run : runs) {
        // x & 1 is the parity of negative x too (two's complement, as C++20 requires).
        const std::int64_t first = (run.first & 1) ? run.first : run.first - 1;
        const std::int64_t last = (run.last & 1) ? run.last : run.last + 1;
        if (!out.empty() && first - out.back().last <= kJoin)
            out.back().last = last;
        else
            out.push_back({first, last});
    }
}

IntervalTransform::IntervalTransform() {
    shortMaps();
    bandFactors();
}

void IntervalTransform::analyse(std::span<const double> fine, double left, double right,
                                std::span<double> coarse, std::span<double> detail) {
    const int n = static_cast<int>(detail.size());
    assert(n >= 1 && fine.size() == detail.size() * 2 + 3 && coarse.size() == detail.size() + 3);
    if (n <= kShort) {
        std::array<double, 2 * kShort + 3> out;
        shortMaps().analysis[n].apply(left, fine, {}, right, out.data());
        std::copy_n(out.begin(), n + 3, coarse.begin());
        std::copy_n(out.begin() + n + 3, n, detail.begin());
        return;
    }
    const int ne = n + kAccessory, size = 2 * ne + 3;
    scratch_.assign(size + 2 * kBandwidth, 0.0);
    double* y = scratch_.data() + kBandwidth;
    std::fill_n(y, kAccessory, left);
    std::copy(fine.begin(), fine.end(), y + kAccessory);
    std::fill_n(y + size - kAccessory, kAccessory, right);
    solveBanded(ne, y);
    for (int j = 0; j < n + 3; ++j) coarse[j] = y[coarseColumn(ne, j + kRejected)];
    for (int k = 0; k < n; ++k) detail[k] = y[detailColumn(k + kRejected)];
}

void IntervalTransform::synthesise(std::span<const double> coarse, std::span<const double> detail,
                                   double left, double right, std::span<double> fine) {
    const int n = static_cast<int>(detail.size());
    assert(n >= 1 && fine.size() == detail.size() * 2 + 3 && coarse.size() == detail.size() + 3);
    if (n <= kShort) {
        shortMaps().synthesis[n].apply(left, coarse, detail, right, fine.data());
        return;
    }
    const int ne = n + kAccessory, size = 2 * ne + 3;
    scratch_.assign(size + 2 * kBandwidth, 0.0);
    double* y = scratch_.data() + kBandwidth;
    for (int j = 0; j < n + 3; ++j) y[coarseColumn(ne, j + kRejected)] = coarse[j];
    for (int k = 0; k < n; ++k) y[detailColumn(k + kRejected)] = detail[k];

    // Recovery: the rejected coefficients are still 0 in y, so T y on the accessory rows is what the known
    // ones contribute there; the rest of the accessory values is theirs.
    const BandFactors& factors = bandFactors();
    std::array<double, kAccessory> restLeft{}, restRight{};  // outermost first
    factors.ascending(ne, [&](int i, const BandRow& row) {
        if (i < kAccessory) restLeft[i] = left - bandProduct(row, y + i);
        if (i >= size - kAccessory) restRight[size - 1 - i] = right - bandProduct(row, y + i);
    });
    const auto atLeft = factors.recoverLeft(restLeft), atRight = factors.recoverRight(restRight);
    for (int j = 0; j < 4; ++j) {
        y[BandFactors::kRejectedColumns[j]] = atLeft[j];
        y[size - 1 - BandFactors::kRejectedColumns[j]] = atRight[j];
    }
    factors.ascending(ne, [&](int i, const BandRow& row) {
        if (i >= kAccessory && i < size - kAccessory) fine[i - kAccessory] = bandProduct(row, y + i);
    });
}

}  // namespace isowave::wavelets
