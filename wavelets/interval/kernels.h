// Analysis and synthesis of several intervals of one length side by side, one lane each. Everything is
// templated on how many doubles go into one operation (Pack), and forced inline, so that one text serves a
// single interval (interval.cpp), two lanes an instruction and, inside functions compiled for them, four and
// eight (batch.cpp). Every lane sees the same operations in the same order whatever the Pack, and
// -ffp-contract=off keeps compilers from
// fusing them: results are the same to the bit on every machine.
//
// Rows are those of tables.h; `y` points at lane 0 of row 0, rows are `stride` doubles apart, kMargin rows
// lie before row 0 and kBandwidth behind the last.
#pragma once

#include <cmath>
#include <cstddef>

#include "base/vectors.h"
#include "wavelets/interval/tables.h"

namespace isowave::wavelets {

// One of the machine's vectors, or one double.
template <class Vector>
struct Alone {
    static constexpr int kWidth = sizeof(Vector) / sizeof(double);
    Vector a;
    ISOWAVE_INLINE static Alone load(const double* p) {
        Alone x;
        __builtin_memcpy(&x.a, p, sizeof(Vector));
        return x;
    }
    ISOWAVE_INLINE void store(double* p) const { __builtin_memcpy(p, &a, sizeof(Vector)); }
    ISOWAVE_INLINE void addProduct(double m, const Alone& x) { a += m * x.a; }
    ISOWAVE_INLINE void subtractProduct(double m, const Alone& x) { a -= m * x.a; }
    ISOWAVE_INLINE static Alone product(double m, const Alone& x) { return {m * x.a}; }
    ISOWAVE_INLINE static Alone sum(const Alone& x, const Alone& y) { return {x.a + y.a}; }
    ISOWAVE_INLINE static Alone difference(const Alone& x, const Alone& y) { return {x.a - y.a}; }
};

using One = Alone<double>;

// Two of the machine's vectors: two independent chains hide half the latency.
template <class Vector>
struct Two {
    static constexpr int kHalf = sizeof(Vector) / sizeof(double), kWidth = 2 * kHalf;
    Vector a, b;
    ISOWAVE_INLINE static Two load(const double* p) {
        Two x;
        __builtin_memcpy(&x.a, p, sizeof(Vector));
        __builtin_memcpy(&x.b, p + kHalf, sizeof(Vector));
        return x;
    }
    ISOWAVE_INLINE void store(double* p) const {
        __builtin_memcpy(p, &a, sizeof(Vector));
        __builtin_memcpy(p + kHalf, &b, sizeof(Vector));
    }
    ISOWAVE_INLINE void addProduct(double m, const Two& x) { a += m * x.a, b += m * x.b; }
    ISOWAVE_INLINE void subtractProduct(double m, const Two& x) { a -= m * x.a, b -= m * x.b; }
    ISOWAVE_INLINE static Two product(double m, const Two& x) { return {m * x.a, m * x.b}; }
    ISOWAVE_INLINE static Two sum(const Two& x, const Two& y) { return {x.a + y.a, x.b + y.b}; }
    ISOWAVE_INLINE static Two difference(const Two& x, const Two& y) { return {x.a - y.a, x.b - y.b}; }
};

// ---- short

// out may be y: everything is read into `folded`, 2n + 5 rows of Pack::kWidth, before anything is written.
template <class Pack>
ISOWAVE_INLINE void applyShort(const ShortMap& map, std::ptrdiff_t stride, const double* y, double* folded,
                               double* out) {
    constexpr int kWidth = Pack::kWidth;
    const int n = map.n;
    double *const u = folded, *const v = folded + (n + 3) * kWidth;
    for (int j = 0; j <= n + 1; ++j) {
        const Pack a = Pack::load(y + map.in[j] * stride), b = Pack::load(y + map.in[2 * n + 4 - j] * stride);
        Pack::sum(a, b).store(u + j * kWidth);
        Pack::difference(a, b).store(v + j * kWidth);
    }
    Pack::load(y + map.in[n + 2] * stride).store(u + (n + 2) * kWidth);

    const double* m = map.coefficients.data();
    for (std::size_t pair = 0; pair < map.outPairs.size(); pair += 2) {
        const Pack u0 = Pack::load(u), v0 = Pack::load(v);
        Pack e0 = Pack::product(m[0], u0), e1 = Pack::product(m[1], u0);
        Pack o0 = Pack::product(m[2], v0), o1 = Pack::product(m[3], v0);
        m += 4;
        for (int j = 1; j <= n + 1; ++j, m += 4) {
            const Pack uj = Pack::load(u + j * kWidth), vj = Pack::load(v + j * kWidth);
            e0.addProduct(m[0], uj);
            e1.addProduct(m[1], uj);
            o0.addProduct(m[2], vj);
            o1.addProduct(m[3], vj);
        }
        const Pack middle = Pack::load(u + (n + 2) * kWidth);
        e0.addProduct(m[0], middle);
        e1.addProduct(m[1], middle);
        m += 2;
        const auto &p0 = map.outPairs[pair], &p1 = map.outPairs[pair + 1];
        Pack::difference(e0, o0).store(out + p0[1] * stride);
        Pack::sum(e0, o0).store(out + p0[0] * stride);
        Pack::difference(e1, o1).store(out + p1[1] * stride);
        Pack::sum(e1, o1).store(out + p1[0] * stride);
    }
}

// ---- long

// T z = y in place. REQUIRES: the kBandwidth rows before row 0 and behind the last hold finite values: their
// coefficients are 0.
template <class Pack>
ISOWAVE_INLINE void solveBanded(const BandFactors& factors, int n, std::ptrdiff_t stride, double* y) {
    const int rows = rowsOf(n);
    double* at = y;
    for (int i = 0; i < rows; ++i, at += stride) {
        const BandRow& row = factors.row(n, i);
        Pack sum = Pack::product(row.scale, Pack::load(at));
        for (int s = 0; s < kBandwidth; ++s)
            sum.subtractProduct(row.lower[s], Pack::load(at + (s - kBandwidth) * stride));
        sum.store(at);
    }
    at = y + (rows - 1) * stride;
    for (int i = rows - 1; i >= 0; --i, at -= stride) {
        const BandRow& row = factors.row(n, i);
        Pack sum = Pack::load(at);
        for (int s = kBandwidth; s-- > 0;)
            sum.subtractProduct(row.upper[s], Pack::load(at + (s + 1) * stride));
        sum.store(at);
    }
}

// Row i of T y.
template <class Pack>
ISOWAVE_INLINE Pack bandProduct(const BandRow& row, std::ptrdiff_t stride, const double* at) {
    Pack sum = Pack::product(row.t[0], Pack::load(at - kBandwidth * stride));
    for (int s = 1; s <= 2 * kBandwidth; ++s)
        sum.addProduct(row.t[s], Pack::load(at + (s - kBandwidth) * stride));
    return sum;
}

// Fills in the rejected coefficients at one end. mirrored: 1 at the left, -1 at the right, where rows count
// backwards. While the rejected ones are 0, T y on the accessory rows is what the known ones contribute; the
// rest of the accessory values is theirs.
template <class Pack>
ISOWAVE_INLINE void recover(const BandFactors& factors, int n, std::ptrdiff_t stride, double* y,
                            int accessoryRow, bool right) {
    const int last = rowsOf(n) - 1;
    const auto rowAt = [=](int i) { return right ? last - i : i; };
    const Pack accessory = Pack::load(y + accessoryRow * stride);
    Pack rest[kAccessory];
    for (int i = 0; i < kAccessory; ++i)
        rest[i] = Pack::difference(
            accessory, bandProduct<Pack>(factors.row(n, rowAt(i)), stride, y + rowAt(i) * stride));
    for (int j = 0; j < kAccessory; ++j) {
        Pack sum = Pack::product(factors.recovery()[j][0], rest[0]);
        for (int i = 1; i < kAccessory; ++i) sum.addProduct(factors.recovery()[j][i], rest[i]);
        sum.store(y + rowAt(BandFactors::kRejectedRows[j]) * stride);
    }
}

// ---- either

// Rows 3 .. 2n+7 of y hold (left; f; right); then they hold c and d.
template <class Pack>
ISOWAVE_INLINE void analyseRows(int n, std::ptrdiff_t stride, double* y, double* folded) {
    if (n <= kShort) return applyShort<Pack>(shortAnalysis(n), stride, y, folded, y);
    const int last = rowsOf(n) - 1;
    const Pack left = Pack::load(y + 3 * stride), right = Pack::load(y + (last - 3) * stride);
    for (int i = 0; i < kAccessory - 1; ++i) {
        left.store(y + i * stride);
        right.store(y + (last - i) * stride);
    }
    solveBanded<Pack>(bandFactors(), n, stride, y);
}

// Rows 3 .. 2n+7 of y hold c and d, kLeftRow and kRightRow the accessory values; then row 4 + j of `out`
// holds f_j. out may not be y.
template <class Pack>
ISOWAVE_INLINE void synthesiseRows(int n, std::ptrdiff_t stride, double* y, double* folded, double* out) {
    if (n <= kShort) return applyShort<Pack>(shortSynthesis(n), stride, y, folded, out);
    const BandFactors& factors = bandFactors();
    const int last = rowsOf(n) - 1;
    const Pack zero = Pack::product(0.0, Pack::load(y + kLeftRow * stride));
    for (const int i : BandFactors::kRejectedRows) {
        zero.store(y + i * stride);
        zero.store(y + (last - i) * stride);
    }
    recover<Pack>(factors, n, stride, y, kLeftRow, false);
    recover<Pack>(factors, n, stride, y, kRightRow, true);
    for (int i = kFirstFineRow; i <= last - kAccessory; ++i)
        bandProduct<Pack>(factors.row(n, i), stride, y + i * stride).store(out + i * stride);
}

// Rows 3 .. 2n+7 of y hold bounds of c and d; then row 4 + j of `out` holds that of f_j. out may not be y.
template <class Pack>
ISOWAVE_INLINE void gainRows(int n, std::ptrdiff_t stride, double* y, double* folded, double* out) {
    if (n <= kShort) return applyShort<Pack>(shortGain(n), stride, y, folded, out);
    const BandFactors& factors = bandFactors();
    const int last = rowsOf(n) - 1, ends = kFirstFineRow + BandFactors::kGainRows;
    for (int i = kFirstFineRow; i < ends; ++i) {
        const auto& gain = factors.gainAtEnd()[i - kFirstFineRow];
        Pack left = Pack::product(0.0, Pack::load(y + kFirstCoarseRow * stride)), right = left;
        for (int row = kFirstCoarseRow; row < static_cast<int>(gain.size()); ++row) {
            left.addProduct(gain[row], Pack::load(y + row * stride));
            right.addProduct(gain[row], Pack::load(y + (last - row) * stride));
        }
        left.store(out + i * stride);
        right.store(out + (last - i) * stride);
    }
    for (int i = ends; i <= last - ends; ++i) {
        const BandRow& row = factors.row(n, i);
        Pack sum = Pack::product(0.0, Pack::load(y + i * stride));
        for (int s = 0; s <= 2 * kBandwidth; ++s)
            sum.addProduct(std::abs(row.t[s]), Pack::load(y + (i + s - kBandwidth) * stride));
        sum.store(out + i * stride);
    }
}

}  // namespace isowave::wavelets
