#include "wavelets/interval/matrices.h"

#include <array>
#include <cassert>

#include "wavelets/interval/runs.h"

namespace isowave::wavelets {
namespace {

// Inner products of the four B-splines that live on one unit interval, x 5040. The pieces in local t are
// (1-t)^3/6, (3t^3-6t^2+4)/6, (-3t^3+3t^2+3t+1)/6, t^3/6; the integrals are exact in these integers.
constexpr std::array<std::array<int, 4>, 4> kSegment5040 = {
    {{20, 129, 60, 1}, {129, 1188, 933, 60}, {60, 933, 1188, 129}, {1, 60, 129, 20}}};

constexpr std::array<int, 11> kChuiWang = {1, -124, 1677, -7904, 18482, -24264, 18482, -7904, 1677, -124, 1};

struct Rows {
    int first, last;
};

Rows supportOf(int k, int n) {
    const auto left = [](int j) { return Rows{j, j == 0 ? 7 : j == 1 ? 9 : 11}; };
    const int rows = 2 * n + 3, mirrored = n - 1 - k;
    if (n == 5 && k == 2) return {2, 10};
    if (k <= 2) return left(k);
    if (mirrored <= 2) return {rows - 1 - left(mirrored).last, rows - 1 - left(mirrored).first};
    return {2 * k - 3, 2 * k + 7};
}

// The vector on rows [first, last] that is orthogonal to all of PᵀI; its null space there has dimension 1.
Matrix nullVector(const Matrix& constraints, Rows rows) {
    const int width = rows.last - rows.first + 1;
    Eigen::FullPivLU<Matrix> lu(constraints.middleCols(rows.first, width));
    lu.setThreshold(1e-12L);
    assert(lu.dimensionOfKernel() == 1);
    return lu.kernel();
}

Matrix scaledToLargestOne(Matrix column) {
    Eigen::Index row = 0, ignored = 0;
    column.cwiseAbs().maxCoeff(&row, &ignored);
    const Real largest = column(row, 0);
    return column / largest;
}

}  // namespace

Matrix gramMatrix(int m) {
    Matrix gram = Matrix::Zero(m + 3, m + 3);
    for (int cell = 0; cell < m; ++cell)
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) gram(cell + i, cell + j) += Real(kSegment5040[i][j]) / 5040;
    return gram;
}

Matrix twoScaleMatrix(int n) {
    constexpr std::array<int, 5> kMask8 = {1, 4, 6, 4, 1};
    Matrix p = Matrix::Zero(2 * n + 3, n + 3);
    for (int j = 0; j < n + 3; ++j)
        for (int s = -2; s <= 2; ++s)
            if (const int i = 2 * j - 1 + s; 0 <= i && i < 2 * n + 3) p(i, j) = Real(kMask8[s + 2]) / 8;
    return p;
}

Matrix waveletMatrix(int n) {
    assert(n >= 5);
    const Matrix constraints = twoScaleMatrix(n).transpose() * gramMatrix(2 * n);
    Matrix q = Matrix::Zero(2 * n + 3, n);
    for (int k = 0; k < n; ++k) {
        const Rows rows = supportOf(k, n);
        const bool interior = k > 2 && n - 1 - k > 2;
        for (int i = rows.first; interior && i <= rows.last; ++i)
            q(i, k) = Real(kChuiWang[i - rows.first]) / kChuiWang[5];
        if (!interior)
            q.block(rows.first, k, rows.last - rows.first + 1, 1) =
                scaledToLargestOne(nullVector(constraints, rows));
    }
    return q;
}

Matrix interleavedMatrix(int n) {
    const Matrix p = twoScaleMatrix(n), q = waveletMatrix(n);
    Matrix t(2 * n + 3, 2 * n + 3);
    for (int j = 0; j < n + 3; ++j) t.col(coarseColumn(n, j)) = p.col(j);
    for (int k = 0; k < n; ++k) t.col(detailColumn(k)) = q.col(k);
    return t;
}

namespace {

// The extended interval has n + 4 coarse intervals. Of its coefficients, two coarse control points and two
// details at either end are rejected; the others are filed as c (n+3) and d (n).
struct Extended {
    int n;   // of the interval itself
    int ne;  // n + 4
    Matrix t;
    std::array<int, 8> rejectedColumns;
    std::array<int, 8> accessoryRows;

    explicit Extended(int n_) : n(n_), ne(n_ + kAccessory), t(interleavedMatrix(ne)) {
        rejectedColumns = {coarseColumn(ne, 0),      coarseColumn(ne, 1),     detailColumn(0),
                           detailColumn(1),          detailColumn(ne - 2),    detailColumn(ne - 1),
                           coarseColumn(ne, ne + 1), coarseColumn(ne, ne + 2)};
        for (int i = 0; i < kAccessory; ++i) {
            accessoryRows[i] = i;
            accessoryRows[kAccessory + i] = 2 * ne - 1 + i;
        }
    }
    int keptColumn(int index) const {  // of (c; d)
        return index < n + 3 ? coarseColumn(ne, index + kRejected)
                             : detailColumn(index - (n + 3) + kRejected);
    }
};

}  // namespace

Matrix analysisMap(int n) {
    const Extended e(n);
    const Matrix inverse = e.t.fullPivLu().inverse();
    const int size = 2 * n + 3;
    Matrix map(size, size + 2);
    for (int row = 0; row < size; ++row) {
        const auto line = inverse.row(e.keptColumn(row));
        map(row, 0) = line.head(kAccessory).sum();
        map.row(row).segment(1, size) = line.segment(kAccessory, size);
        map(row, size + 1) = line.tail(kAccessory).sum();
    }
    return map;
}

Matrix synthesisMap(int n) {
    // Known coefficients y, rejected ones z, accessory values a:  T_known y + T_rejected z = (a_l; f; a_r).
    // The accessory rows give z = R^-1 (a - A_known y), E(17); the other rows then give f.
    const Extended e(n);
    const int size = 2 * n + 3;
    Matrix known(e.t.rows(), size), rejected(e.t.rows(), 8);
    for (int j = 0; j < size; ++j) known.col(j) = e.t.col(e.keptColumn(j));
    for (int j = 0; j < 8; ++j) rejected.col(j) = e.t.col(e.rejectedColumns[j]);
    Matrix knownOutside(8, size), rejectedOutside(8, 8);
    for (int i = 0; i < 8; ++i) {
        knownOutside.row(i) = known.row(e.accessoryRows[i]);
        rejectedOutside.row(i) = rejected.row(e.accessoryRows[i]);
    }
    const Matrix recover = rejectedOutside.fullPivLu().inverse();
    const Matrix inner = rejected.middleRows(kAccessory, size) * recover;  // of a
    Matrix map(size, size + 2);
    map.col(0) = inner.leftCols(kAccessory).rowwise().sum();
    map.middleCols(1, size) = known.middleRows(kAccessory, size) - inner * knownOutside;
    map.col(size + 1) = inner.rightCols(kAccessory).rowwise().sum();
    return map;
}

}  // namespace isowave::wavelets
