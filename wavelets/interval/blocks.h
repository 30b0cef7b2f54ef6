// Blocks of 8 x 8 values, transposed in registers: between lines, which hold their values one behind the
// other, and lanes or leaves, where neighbours belong to different lines. Moving 64 values takes 8 loads, 24
// shuffles and 8 stores.
//
// __builtin_shufflevector: g++ 12 or clang. kWide: the function that this is inlined into is compiled for
// vectors of eight floats. Without, plain loops.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/vectors.h"

namespace isowave::wavelets {

inline constexpr int kBlock = 8;

typedef float Float8 __attribute__((vector_size(32)));
typedef std::int32_t Ints8 __attribute__((vector_size(32)));
typedef double Double8 __attribute__((vector_size(64)));

ISOWAVE_INLINE void load(const float* from, Float8& to) { __builtin_memcpy(&to, from, sizeof to); }
ISOWAVE_INLINE void store(const Float8& from, float* to) { __builtin_memcpy(to, &from, sizeof from); }

// Row i, element j -> row j, element i: pairs of rows, then pairs of pairs, then the halves.
ISOWAVE_INLINE void transpose(Float8 (&r)[kBlock]) {
    Float8 a[kBlock], b[kBlock];
    for (int i = 0; i < kBlock; i += 2) {
        a[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        a[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < kBlock; i += 4)
        for (int j = 0; j < 2; ++j) {
            b[i + 2 * j] = __builtin_shufflevector(a[i + j], a[i + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            b[i + 2 * j + 1] = __builtin_shufflevector(a[i + j], a[i + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int i = 0; i < kBlock / 2; ++i) {
        r[i] = __builtin_shufflevector(b[i], b[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        r[i + 4] = __builtin_shufflevector(b[i], b[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

// lines -> rows: rows[i apart + lane] = lines[lane][i], i < count. Up to 7 values behind a line's last are
// read.
template <bool kWide>
ISOWAVE_INLINE void loadLanes(const float* const (&lines)[kBlock], int count, double* rows,
                              std::ptrdiff_t apart) {
    if constexpr (kWide) {
        for (int i = 0; i < count; i += kBlock, rows += kBlock * apart) {
            const int here = count - i;
            Float8 r[kBlock];
            for (int lane = 0; lane < kBlock; ++lane) load(lines[lane] + i, r[lane]);
            transpose(r);
            for (int j = 0; j < kBlock; ++j)
                if (j < here) {
                    const Double8 wide = __builtin_convertvector(r[j], Double8);
                    __builtin_memcpy(rows + j * apart, &wide, sizeof wide);
                }
        }
    } else {
        for (int lane = 0; lane < kBlock; ++lane)
            for (int i = 0; i < count; ++i) rows[i * apart + lane] = lines[lane][i];
    }
}

// rows -> lines: lines[lane][i] = rows[i apart + lane] rounded, i < count, lane < lanes. Up to 7 values
// behind a line's last are read and written as they are.
template <bool kWide>
ISOWAVE_INLINE void storeLanes(const double* rows, std::ptrdiff_t apart, int count, float* const* lines,
                               int lanes) {
    if constexpr (kWide) {
        for (int i = 0; i < count; i += kBlock, rows += kBlock * apart) {
            const int here = count - i;
            Float8 r[kBlock];
            for (int j = 0; j < kBlock; ++j) {
                Double8 wide{};
                if (j < here) __builtin_memcpy(&wide, rows + j * apart, sizeof wide);
                r[j] = __builtin_convertvector(wide, Float8);
            }
            transpose(r);
            if (here >= kBlock) {
                for (int lane = 0; lane < kBlock; ++lane)
                    if (lane < lanes) store(r[lane], lines[lane] + i);
            } else {
                const Ints8 index = {0, 1, 2, 3, 4, 5, 6, 7};
                const Ints8 ours = index < here;
                for (int lane = 0; lane < kBlock; ++lane)
                    if (lane < lanes) {
                        Float8 before;
                        load(lines[lane] + i, before);
                        store(ours ? r[lane] : before, lines[lane] + i);
                    }
            }
        }
    } else {
        for (int lane = 0; lane < lanes; ++lane)
            for (int i = 0; i < count; ++i) lines[lane][i] = static_cast<float>(rows[i * apart + lane]);
    }
}

}  // namespace isowave::wavelets
