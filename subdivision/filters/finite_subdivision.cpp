#include "subdivision/filters/finite_subdivision.h"

#include <cassert>
#include <set>

#include "subdivision/filters/exact_solve.h"

namespace isowave::subdivision {

namespace {

std::string nth(const char* product, std::size_t row, std::size_t column, const Rational& found) {
    return std::string(product) + "[" + std::to_string(row) + "][" + std::to_string(column) + "] is " +
           toString(found);
}

void check(Proof& proof, const char* product, const std::vector<Diagram>& rows,
           const std::vector<Diagram>& columns, bool identity) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t j = 0; j < columns.size(); ++j) {
            ++proof.products;
            const Rational found = inner(rows[i], columns[j]);
            const bool right = found == (identity && i == j ? 1 : 0);
            if (!right && proof.failure.empty()) proof.failure = nth(product, i, j, found);
        }
    }
}

std::vector<Rational> valuesOn(const Diagram& diagram, const std::vector<Node>& window) {
    std::vector<Rational> values;
    for (const Node n : window) values.push_back(diagram[n]);
    return values;
}

}  // namespace

void FiniteSubdivision::addRow(Node fine, const Diagram& row) {
    const bool isNew = rows_.emplace(fine, row).second;
    assert(isNew);
    (void)isNew;
    for (const auto& [coarse, weight] : row) columns_[coarse].add(fine, weight);
}

Diagram FiniteSubdivision::subdivided(const Diagram& coarse) const {
    Diagram fine;
    for (const auto& [node, value] : coarse) fine.add(columns_.at(node), value);
    return fine;
}

Proof prove(const System& s, std::size_t fineNodes) {
    Proof proof;
    check(proof, "AP", s.a, s.p, true);
    check(proof, "BP", s.b, s.p, false);
    check(proof, "AQ", s.a, s.q, false);
    check(proof, "BQ", s.b, s.q, true);
    if (proof.failure.empty() &&
        (s.a.size() != s.p.size() || s.b.size() != s.q.size() || s.a.size() + s.b.size() != fineNodes)) {
        proof.failure = std::to_string(s.a.size()) + " coarse values and " + std::to_string(s.b.size()) +
                        " details do not make " + std::to_string(fineNodes) + " fine values";
    }
    return proof;
}

std::optional<Diagram> leastNormRow(const FiniteSubdivision& p, Node coarse,
                                    const std::vector<Node>& window) {
    std::set<Node> touching;
    for (const Node fine : window) {
        for (const auto& [node, weight] : p.row(fine)) touching.insert(node);
    }
    if (!touching.contains(coarse)) return std::nullopt;
    Matrix e;
    std::vector<Rational> r;
    for (const Node node : touching) {
        e.push_back(valuesOn(p.column(node), window));
        r.emplace_back(node == coarse ? 1 : 0);
    }
    const auto x = leastNorm(e, r);
    if (!x) return std::nullopt;
    return Diagram::on(window, *x);
}

std::optional<Diagram> annihilator(const FiniteSubdivision& p, const std::vector<Node>& window) {
    std::set<Node> touching;
    for (const Node fine : window) {
        for (const auto& [node, weight] : p.row(fine)) touching.insert(node);
    }
    Matrix equations;
    for (const Node node : touching) equations.push_back(valuesOn(p.column(node), window));
    const Matrix basis = nullspace(equations);
    if (basis.size() != 1) return std::nullopt;
    return Diagram::on(window, basis[0]);
}

std::optional<Diagram> dualColumn(const std::vector<Diagram>& b, std::size_t k,
                                  const std::vector<Node>& window) {
    Matrix e;
    std::vector<Rational> r;
    for (std::size_t l = 0; l < b.size(); ++l) {
        auto row = valuesOn(b[l], window);
        bool touches = l == k;
        for (const auto& value : row) touches = touches || value != 0;
        if (!touches) continue;
        e.push_back(std::move(row));
        r.emplace_back(l == k ? 1 : 0);
    }
    const auto x = leastNorm(e, r);
    if (!x) return std::nullopt;
    return Diagram::on(window, *x);
}

Diagram lifted(const FiniteSubdivision& p, const std::vector<std::pair<Node, Diagram>>& a, const Diagram& q) {
    Diagram result = q;
    for (const auto& [coarse, row] : a) {
        const Rational value = inner(row, q);
        if (value != 0) result.add(p.column(coarse), -value);
    }
    return result;
}

}  // namespace isowave::subdivision
