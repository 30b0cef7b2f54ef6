#include "subdivision/exact_solve.h"

#include <cassert>
#include <utility>

namespace isowave::subdivision {

namespace {

using IntegerMatrix = std::vector<std::vector<Integer>>;

// Each row times the common denominator of its entries: the row space, and every solution, stay the same.
IntegerMatrix cleared(const Matrix& matrix) {
    IntegerMatrix result;
    for (const auto& row : matrix) {
        Integer common = 1;
        for (const auto& value : row) common = lcm(common, denominator(value));
        auto& out = result.emplace_back();
        for (const auto& value : row) out.push_back(numerator(value) * (common / denominator(value)));
    }
    return result;
}

// Reduced row echelon form times one integer `pivot`: row k holds `pivot` in column columns[k], and the other
// rows hold 0 there. origin[k] is the row of the input that row k came from.
struct Echelon {
    IntegerMatrix rows;
    std::vector<std::size_t> columns, origin;
    Integer pivot = 1;
};

// Bareiss' fraction-free elimination, both above and below the pivot:
//   row_i <- (p row_i - row_i[c] row_k) / (the pivot before p),  an exact division,
// so entries stay minors of the matrix (their size is bounded by Hadamard) and no gcd is ever taken.
Echelon eliminate(const Matrix& matrix) {
    Echelon e;
    e.rows = cleared(matrix);
    for (std::size_t k = 0; k < e.rows.size(); ++k) e.origin.push_back(k);
    const std::size_t width = matrix.empty() ? 0 : matrix[0].size();
    std::size_t done =
        0;  // invariant: rows [0, done) have their pivots, rows [done, end) are 0 left of column c
    for (std::size_t c = 0; c < width && done < e.rows.size(); ++c) {
        std::size_t chosen = done;
        while (chosen < e.rows.size() && e.rows[chosen][c] == 0) ++chosen;
        if (chosen == e.rows.size()) continue;
        std::swap(e.rows[done], e.rows[chosen]);
        std::swap(e.origin[done], e.origin[chosen]);
        const Integer p = e.rows[done][c];
        for (std::size_t i = 0; i < e.rows.size(); ++i) {
            if (i == done) continue;
            const Integer factor = e.rows[i][c];
            for (std::size_t j = 0; j < width; ++j) {
                Integer& value = e.rows[i][j];
                value *= p;
                if (factor != 0) value -= factor * e.rows[done][j];
                if (e.pivot != 1) value /= e.pivot;
            }
        }
        e.pivot = p;
        e.columns.push_back(c);
        ++done;
    }
    e.rows.resize(done);
    e.origin.resize(done);
    return e;
}

Matrix augmented(const Matrix& matrix, const std::vector<Rational>& right) {
    Matrix both = matrix;
    for (std::size_t k = 0; k < both.size(); ++k) both[k].push_back(right[k]);
    return both;
}

}  // namespace

int rank(const Matrix& matrix) { return static_cast<int>(eliminate(matrix).rows.size()); }

std::optional<std::vector<Rational>> leastNorm(const Matrix& e, const std::vector<Rational>& r) {
    assert(e.size() == r.size() && !e.empty());
    const std::size_t unknowns = e[0].size();
    const Echelon independent = eliminate(augmented(e, r));
    // A pivot in the last column says 0 x = 1.
    if (!independent.columns.empty() && independent.columns.back() == unknowns) return std::nullopt;

    const auto& chosen = independent.origin;
    Matrix gram;
    std::vector<Rational> right;
    for (const std::size_t i : chosen) {
        auto& row = gram.emplace_back();
        for (const std::size_t j : chosen) {
            Rational product = 0;
            for (std::size_t u = 0; u < unknowns; ++u) {
                if (e[i][u] != 0 && e[j][u] != 0) product += e[i][u] * e[j][u];
            }
            row.push_back(product);
        }
        right.push_back(r[i]);
    }
    const Echelon solved = eliminate(augmented(gram, right));
    assert(solved.rows.size() == chosen.size());  // a Gram matrix of independent rows is regular

    std::vector<Rational> x(unknowns, Rational(0));
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        const Rational y(solved.rows[k].back(), solved.pivot);
        for (std::size_t u = 0; u < unknowns; ++u) {
            if (e[chosen[k]][u] != 0) x[u] += e[chosen[k]][u] * y;
        }
    }
    return x;
}

Matrix nullspace(const Matrix& matrix) {
    assert(!matrix.empty());
    const Echelon e = eliminate(matrix);
    const std::size_t width = matrix[0].size();
    std::vector<bool> isPivot(width, false);
    for (const std::size_t c : e.columns) isPivot[c] = true;
    Matrix basis;
    for (std::size_t free = 0; free < width; ++free) {
        if (isPivot[free]) continue;
        // pivot x_c + row[free] x_free = 0 for every pivot column c: take x_free = pivot.
        std::vector<Integer> x(width, Integer(0));
        x[free] = e.pivot;
        for (std::size_t k = 0; k < e.rows.size(); ++k) x[e.columns[k]] = -e.rows[k][free];
        Integer common = 0;
        for (const auto& value : x) common = gcd(common, value);
        auto& out = basis.emplace_back();
        for (const auto& value : x) out.emplace_back(value / common);
    }
    return basis;
}

}  // namespace isowave::subdivision
