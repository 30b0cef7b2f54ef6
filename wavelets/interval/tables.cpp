#include "wavelets/interval/tables.h"

#include <algorithm>

namespace isowave::wavelets {
namespace {

// ---- short

// Where analysisMap() and synthesisMap() file (c; d), in the order of rows.
std::vector<int> coefficientRows(int n) {
    std::vector<int> rows;
    for (int row = kFirstCoarseRow; row <= 2 * n + 7; ++row)
        if (row != kFirstDetailRow - 2 && row != 2 * n + 6) rows.push_back(row);
    return rows;
}
int mapIndex(int n, int coefficientRow) {
    return coefficientRow & 1 ? (coefficientRow - kFirstCoarseRow) / 2
                              : n + 3 + (coefficientRow - kFirstDetailRow) / 2;
}
std::vector<int> fineRows(int n) {
    std::vector<int> rows;
    for (int j = 0; j < 2 * n + 3; ++j) rows.push_back(kFirstFineRow + j);
    return rows;
}

// m: out x in, both in the order of map.out and map.in.
void fold(const Matrix& m, ShortMap& map) {
    const int n = map.n, last = 2 * n + 4, pairs = (n + 3) / 2 * 2;  // n + 2 with the middle, made even
    const auto even = [&](int i, int j) -> double {
        if (i > n + 1) return 0;
        return static_cast<double>(j == n + 2 ? m(i, j) : (m(i, j) + m(i, last - j)) / 2);
    };
    const auto odd = [&](int i, int j) -> double {
        return i > n ? 0 : static_cast<double>((m(i, j) - m(i, last - j)) / 2);
    };
    for (int i = 0; i < pairs; ++i)
        if (i <= n + 1)
            map.outPairs.push_back({map.out[i], map.out[2 * n + 2 - i]});
        else
            map.outPairs.push_back({kUnwantedRow, kUnwantedRow});
    for (int i = 0; i < pairs; i += 2) {
        for (int j = 0; j <= n + 1; ++j)
            map.coefficients.insert(map.coefficients.end(),
                                    {even(i, j), even(i + 1, j), odd(i, j), odd(i + 1, j)});
        map.coefficients.insert(map.coefficients.end(), {even(i, n + 2), even(i + 1, n + 2)});
    }
}

ShortMap makeAnalysis(int n) {
    ShortMap map;
    map.n = n;
    for (int row = kFirstFineRow - 1; row <= 2 * n + 7; ++row) map.in.push_back(row);
    map.out = coefficientRows(n);
    const Matrix whole = analysisMap(n);
    Matrix m(whole.rows(), whole.cols());
    for (int i = 0; i < m.rows(); ++i) m.row(i) = whole.row(mapIndex(n, map.out[i]));
    fold(m, map);
    return map;
}

// whole: a (2n+3) x (2n+5) map as synthesisMap() gives it.
ShortMap foldSynthesis(const Matrix& whole, int n) {
    ShortMap map;
    map.n = n;
    map.in = coefficientRows(n);
    map.in.insert(map.in.begin(), kLeftRow);
    map.in.push_back(kRightRow);
    map.out = fineRows(n);
    Matrix m = whole;
    for (int j = 1; j <= 2 * n + 3; ++j) m.col(j) = whole.col(1 + mapIndex(n, map.in[j]));
    fold(m, map);
    return map;
}

ShortMap makeSynthesis(int n) { return foldSynthesis(synthesisMap(n), n); }

Matrix gainMap(int n) {
    Matrix gain = synthesisMap(n).cwiseAbs();
    gain.col(0).setZero();
    gain.col(2 * n + 4).setZero();
    return gain;
}

ShortMap makeGain(int n) { return foldSynthesis(gainMap(n), n); }

using Maps = std::array<ShortMap, kShort + 1>;

Maps makeMaps(ShortMap make(int)) {
    Maps maps;
    for (int n = 1; n <= kShort; ++n) maps[n] = make(n);
    return maps;
}

// ---- long

// T of ne coarse intervals from that of more: both ends and, with period 2, the middle are the same.
// REQUIRES: ne > kShort + kAccessory.
Matrix shortened(const Matrix& longer, int ne) {
    const int size = 2 * ne + 3, cut = static_cast<int>(longer.rows()) - size;
    Matrix t = Matrix::Zero(size, size);
    for (int i = 0; i < size; ++i)
        for (int j = std::max(0, i - kBandwidth); j <= std::min(size - 1, i + kBandwidth); ++j)
            t(i, j) = i + j < size ? longer(i, j) : longer(i + cut, j + cut);
    return t;
}

std::vector<BandRow> factor(Matrix t) {
    const int size = static_cast<int>(t.rows());
    std::vector<BandRow> rows(size);
    for (int i = 0; i < size; ++i)
        for (int s = -kBandwidth; s <= kBandwidth; ++s)
            if (i + s >= 0 && i + s < size) rows[i].t[s + kBandwidth] = static_cast<double>(t(i, i + s));
    // t becomes: below the diagonal L with a unit diagonal, on and above it U with pivots.
    for (int k = 0; k < size; ++k)
        for (int i = k + 1; i < std::min(size, k + kBandwidth + 1); ++i) {
            const Real multiplier = t(i, k) / t(k, k);
            for (int j = k; j < std::min(size, k + kBandwidth + 1); ++j) t(i, j) -= multiplier * t(k, j);
            t(i, k) = multiplier;
        }
    // With pivots p and y_i = (x_i - sum l p_s y_s) / p_i the upper factor has a unit diagonal: one
    // multiplication less on the way from one unknown to the next.
    for (int i = 0; i < size; ++i) {
        const Real pivot = t(i, i);
        rows[i].scale = static_cast<double>(1 / pivot);
        for (int s = 1; s <= kBandwidth; ++s) {
            if (i - s >= 0)
                rows[i].lower[kBandwidth - s] = static_cast<double>(t(i, i - s) * t(i - s, i - s) / pivot);
            if (i + s < size) rows[i].upper[s - 1] = static_cast<double>(t(i, i + s) / pivot);
        }
    }
    return rows;
}

}  // namespace

const ShortMap& shortAnalysis(int n) {
    static const Maps maps = makeMaps(makeAnalysis);
    return maps[n];
}

const ShortMap& shortSynthesis(int n) {
    static const Maps maps = makeMaps(makeSynthesis);
    return maps[n];
}

const ShortMap& shortGain(int n) {
    static const Maps maps = makeMaps(makeGain);
    return maps[n];
}

BandFactors::BandFactors() {
    const Matrix t = interleavedMatrix(kReference);
    for (int ne = kFirstOwn; ne <= kReference; ++ne) own_.push_back(factor(shortened(t, ne)));
    Matrix rejected(kAccessory, kAccessory);
    for (int i = 0; i < kAccessory; ++i)
        for (int j = 0; j < kAccessory; ++j) rejected(i, j) = t(i, kRejectedRows[j]);
    const Matrix inverse = rejected.fullPivLu().inverse();
    for (int i = 0; i < kAccessory; ++i)
        for (int j = 0; j < kAccessory; ++j) recovery_[i][j] = static_cast<double>(inverse(i, j));
    constexpr int kLong = kShort + 1;  // the ends of all longer ones are the same
    const Matrix gain = gainMap(kLong);
    for (int i = 0; i < kGainRows; ++i)
        for (const int row : coefficientRows(kLong))
            if (row < static_cast<int>(gainAtEnd_[i].size()))
                gainAtEnd_[i][row] = static_cast<double>(gain(i, 1 + mapIndex(kLong, row)));
}

const BandFactors& bandFactors() {
    static const BandFactors factors;
    return factors;
}

}  // namespace isowave::wavelets
