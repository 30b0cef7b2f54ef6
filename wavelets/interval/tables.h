// The numbers that kernels.h multiplies with: built once from matrices.h, in double.
//
// Rows. An interval with n coarse intervals is extended to ne = n + 4 of them, 2ne + 3 rows, row i being fine
// position i of the extended interval, or column i of T = interleaved [P|Q] (matrices.h). In these rows
//   f_j           is row j + 4               (0 <= j <= 2n+2)
//   accessory     are rows 0..3 and 2n+7..2n+10, of one value each
//   c_j           is row 2j + 3              (0 <= j <= n+2)
//   d_k           is row 2k + 6              (0 <= k < n)
//   rejected      are rows 0, 1, 2, 4 and their mirror images
// so that rows 3 .. 2n+7 hold (left; f; right) before analysis and c and d, interleaved, after it.
#pragma once

#include <array>
#include <vector>

#include "wavelets/interval/matrices.h"
#include "wavelets/interval/runs.h"

namespace isowave::wavelets {

// Up to this n an interval is one dense map, above it banded elimination. A point costs n + 2 multiplications
// as a map of half the size, 11 (2n+11)/(2n+3) banded; but elimination waits for its own results.
inline constexpr int kShort = 12;

constexpr int rowsOf(int n) { return 2 * (n + kAccessory) + 3; }
inline constexpr int kFirstFineRow = kAccessory, kFirstCoarseRow = 3, kFirstDetailRow = 6;

// One direction of a short interval. The map is its own mirror image, so that sums and differences of
// mirrored inputs do not mix: with u = x + mirrored x and v = x - mirrored x,
//   out = E u + O v,   mirrored out = E u - O v.
// Half the multiplications, and a mirrored interval gives mirrored results to the bit.
struct ShortMap {
    int n = 0;
    // Inputs in pairs: rows[0] with rows[2n+4] and so on, the middle one alone. A pair (left, right) comes
    // first; it is rows kLeftRow and kRightRow in synthesis.
    std::vector<int> in;   // 2n + 5 rows
    std::vector<int> out;  // 2n + 3 rows, mirrored likewise
    // Two output pairs at a time: E0 E1 O0 O1 for each of the n + 2 input pairs, E0 E1 for the middle input.
    // The middle output is a pair with itself with O = 0; an odd one out has a pair of zeros beside it.
    std::vector<double> coefficients;
    std::vector<std::array<int, 2>> outPairs;  // rows; an even number of pairs
};

// Rows beside the interval's: the accessory values, when rows 0..3 are taken by coefficients, and a place for
// results that nobody wants.
inline constexpr int kMargin = kBandwidth + 3;  // rows before row 0: three extra ones, then zeros
inline constexpr int kLeftRow = -kMargin, kRightRow = -kMargin + 1, kUnwantedRow = -kMargin + 2;

const ShortMap& shortAnalysis(int n);   // REQUIRES: 1 <= n <= kShort
const ShortMap& shortSynthesis(int n);  // REQUIRES: 1 <= n <= kShort
// Synthesis with the absolute values of its map, 0 for the accessory ones: by how much f moves at most when c
// and d do.
const ShortMap& shortGain(int n);  // REQUIRES: 1 <= n <= kShort

// Row i of T = L U with unit U, solved for the unknown: L y = x is y_i = scale x_i - sum lower y; U z = y is
// z_i = y_i - sum upper z. And row i of T itself.
struct BandRow {
    double scale = 0;
    std::array<double, kBandwidth> lower{};  // of y_{i-5} .. y_{i-1}
    std::array<double, kBandwidth> upper{};  // of z_{i+1} .. z_{i+5}
    std::array<double, 2 * kBandwidth + 1> t{};
};

// The factors of every n > kShort.
class BandFactors {
  public:
    BandFactors();

    // Row i, 0 <= i < rowsOf(n).
    const BandRow& row(int n, int i) const {
        const int ne = n + kAccessory;
        if (ne <= kReference) return own_[ne - kFirstOwn][i];
        if (i < kHead) return own_.back()[i];
        const int fromEnd = rowsOf(n) - i;
        if (fromEnd <= kTail) return own_.back()[2 * kReference + 3 - fromEnd];
        return own_.back()[kHead + (i & 1)];  // kHead is even
    }

    // Recovery, E(17), for a long interval: rejected coefficients, in the order of kRejectedRows counted from
    // their own end, from what is left of the four accessory values, outermost first. The same at both ends.
    using Block = std::array<std::array<double, kAccessory>, kAccessory>;
    const Block& recovery() const { return recovery_; }
    static constexpr std::array<int, 2 * kRejected> kRejectedRows = {0, 1, 2, 4};

    // Absolute values of synthesis where recovery has a say: gainAtEnd()[i][r] of row r for f_i. The first
    // kGainRows of f, from rows 3 .. 14; the same at the right, mirrored. The rest of f is what T alone makes
    // it.
    static constexpr int kGainRows = 6;  // the last rejected wavelet ends at row 9
    using EndGain = std::array<std::array<double, kFirstFineRow + kGainRows + kBandwidth>, kGainRows>;
    const EndGain& gainAtEnd() const { return gainAtEnd_; }

  private:
    // Row i of L and U depends on the leading i rows of T alone, so the head is common to all lengths; it
    // becomes stationary with period 2 (differences fall 3.4x every two rows, below 1e-17 after kHead rows),
    // and the last kTail rows, where the right end shows, are then common as well. Lengths that are too short
    // for a stationary middle have factors of their own.
    static constexpr int kHead = 80, kTail = 24;
    static constexpr int kReference = 64;  // coarse intervals of the reference: 131 rows
    static constexpr int kFirstOwn = kShort + kAccessory + 1;

    std::vector<std::vector<BandRow>> own_;
    Block recovery_;
    EndGain gainAtEnd_{};
};

const BandFactors& bandFactors();

}  // namespace isowave::wavelets
