// The matrices behind interval.h, dense and in long double: built once, read by tables.cpp and
// by the tests. Nothing here runs on a hot path.
//
// Notation: a cut-off domain of m unit intervals carries m + 3 uniform cubic B-splines, all knots simple.
//   P  (2n+3) x (n+3)   two-scale relation, columns (1,4,6,4,1)/8 cut off at the ends; row i of P is fine
//                       position i - 1, column j coarse position j - 1: column j is centred on row 2j - 1
//   I  (m+3) x (m+3)    inner products of the B-splines on the domain; inner rows are
//                       (1,120,1191,2416,1191,120,1)/5040
//   Q  (2n+3) x n       minimal-support basis of the L2-orthogonal complement: PᵀIQ = 0
//   T  (2n+3) x (2n+3)  the columns of [P|Q] interleaved, c0 c1 d0 c2 d1 .. d(n-1) c(n+1) c(n+2): five
//                       diagonals on either side of the main one
//
// Support of Q's columns: fine rows 0..7, 1..9, 2..11 for k = 0, 1, 2; 2k-3..2k+7 inside, where the column is
// the Chui-Wang wavelet 1,-124,1677,-7904,18482,-24264,.. up to scale; mirrored at the right. Each column is
// scaled so that its largest entry is 1. For n = 5 the middle column is the symmetric vector on rows 2..10.
// (A symmetric vector on rows 1..11 is not unique: that null space has dimension 2, columns 1 and 3 add up to
// one.)
#pragma once

#include <Eigen/Dense>

namespace isowave::wavelets {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

Matrix gramMatrix(int m);
Matrix twoScaleMatrix(int n);
Matrix waveletMatrix(int n);      // REQUIRES: n >= 5
Matrix interleavedMatrix(int n);  // T; REQUIRES: n >= 5

// Column of T that holds coarse control point j (0..n+2) and detail k (0..n-1).
constexpr int coarseColumn(int n, int j) { return j == 0 ? 0 : j == n + 2 ? 2 * n + 2 : 2 * j - 1; }
constexpr int detailColumn(int k) { return 2 * k + 2; }

inline constexpr int kBandwidth = 5;  // of T, on either side

// One interval with n coarse intervals as two linear maps of its known values and the two accessory values:
//   analysisMap   (2n+3) x (2n+5):  (c; d) = M (left; f; right)
//   synthesisMap  (2n+3) x (2n+5):  f = M (left; c; d; right)
// They contain extension, analysis and rejection; recovery and synthesis.
Matrix analysisMap(int n);   // REQUIRES: n >= 1
Matrix synthesisMap(int n);  // REQUIRES: n >= 1

}  // namespace isowave::wavelets
