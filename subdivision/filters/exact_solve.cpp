#include "subdivision/filters/exact_solve.h"

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

// Row k begins in column columns[k] and came from row origin[k] of the input. Eliminated below only, the rows
// are a staircase; above too, every pivot is the integer `pivot` and stands alone in its column.
struct Echelon {
    IntegerMatrix rows;
    std::vector<std::size_t> columns, origin;
    Integer pivot = 1;
};

enum class Eliminate { Below, Everywhere };

// Bareiss' fraction-free elimination:
//   row_i <- (p row_i - row_i[c] row_k) / (the pivot before p),  an exact division,
// so entries stay minors of the matrix (their size is bounded by Hadamard) and no gcd is ever taken. GMP is
// called by name because this is where the time goes: no temporaries, and a division that knows that it is
// exact.
Echelon eliminate(IntegerMatrix rows, Eliminate where) {
    Echelon e;
    e.rows = std::move(rows);
    for (std::size_t k = 0; k < e.rows.size(); ++k) e.origin.push_back(k);
    const std::size_t width = e.rows.empty() ? 0 : e.rows[0].size();
    // invariant: rows [0, done) have their pivots, rows [done, end) are 0 left of column c
    std::size_t done = 0;
    for (std::size_t c = 0; c < width && done < e.rows.size(); ++c) {
        std::size_t chosen = done;
        while (chosen < e.rows.size() && e.rows[chosen][c] == 0) ++chosen;
        if (chosen == e.rows.size()) continue;
        std::swap(e.rows[done], e.rows[chosen]);
        std::swap(e.origin[done], e.origin[chosen]);
        const Integer p = e.rows[done][c];
        for (std::size_t i = where == Eliminate::Below ? done + 1 : 0; i < e.rows.size(); ++i) {
            if (i == done) continue;
            const Integer factor = e.rows[i][c];
            for (std::size_t j = where == Eliminate::Below ? c : 0; j < width; ++j) {
                mpz_ptr value = e.rows[i][j].backend().data();
                mpz_mul(value, value, p.backend().data());
                mpz_submul(value, factor.backend().data(), e.rows[done][j].backend().data());
                mpz_divexact(value, value, e.pivot.backend().data());
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

// The y with (the staircase's left square) y = (its last column), from the last row up.
std::vector<Rational> backSubstituted(const Echelon& e) {
    const std::size_t n = e.rows.size();
    std::vector<Rational> y(n);
    for (std::size_t k = n; k-- > 0;) {
        Rational right(e.rows[k][n]);
        for (std::size_t j = k + 1; j < n; ++j) right -= Rational(e.rows[k][j]) * y[j];
        y[k] = right / Rational(e.rows[k][k]);
    }
    return y;
}

}  // namespace

int rank(const Matrix& matrix) {
    return static_cast<int>(eliminate(cleared(matrix), Eliminate::Below).rows.size());
}

std::optional<std::vector<Rational>> leastNorm(const Matrix& e, const std::vector<Rational>& r) {
    assert(e.size() == r.size() && !e.empty());
    const std::size_t unknowns = e[0].size();
    Matrix both = e;
    for (std::size_t k = 0; k < both.size(); ++k) both[k].push_back(r[k]);
    // A row times a number, right side included, is the same equation.
    const IntegerMatrix equations = cleared(both);
    const Echelon independent = eliminate(equations, Eliminate::Below);
    // A pivot in the last column says 0 x = 1.
    if (!independent.columns.empty() && independent.columns.back() == unknowns) return std::nullopt;

    IntegerMatrix gram;
    for (const std::size_t i : independent.origin) {
        auto& row = gram.emplace_back();
        for (const std::size_t j : independent.origin) {
            Integer product = 0;
            for (std::size_t u = 0; u < unknowns; ++u) product += equations[i][u] * equations[j][u];
            row.push_back(product);
        }
        row.push_back(equations[i][unknowns]);
    }
    const Echelon solved = eliminate(std::move(gram), Eliminate::Below);
    assert(solved.rows.size() == independent.origin.size());  // a Gram matrix of independent rows is regular
    const auto y = backSubstituted(solved);

    std::vector<Rational> x(unknowns, Rational(0));
    for (std::size_t k = 0; k < y.size(); ++k) {
        const auto& row = equations[independent.origin[k]];
        for (std::size_t u = 0; u < unknowns; ++u) {
            if (row[u] != 0) x[u] += Rational(row[u]) * y[k];
        }
    }
    return x;
}

Matrix nullspace(const Matrix& matrix) {
    assert(!matrix.empty());
    const Echelon e = eliminate(cleared(matrix), Eliminate::Everywhere);
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
