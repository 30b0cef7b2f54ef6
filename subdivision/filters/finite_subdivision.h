// Subdivisions of finite arrangements: open curves, patches with boundaries and corners, small tori. The rows
// of P change near the ends, so every diagram is found for its own place; the algebra is that of construct.h.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "subdivision/filters/construct.h"
#include "subdivision/filters/diagram.h"

namespace isowave::subdivision {

// P by rows and by columns: row(fine) lives on the coarse nodes, column(coarse) on the fine ones.
class FiniteSubdivision {
  public:
    // Adds a fine node and what it takes from the coarse ones. REQUIRES: not added before.
    void addRow(Node fine, const Diagram& row);

    const Diagram& row(Node fine) const { return rows_.at(fine); }
    const Diagram& column(Node coarse) const { return columns_.at(coarse); }
    const std::map<Node, Diagram>& rows() const { return rows_; }
    const std::map<Node, Diagram>& columns() const { return columns_; }

    // P c
    Diagram subdivided(const Diagram& coarse) const;

  private:
    std::map<Node, Diagram> rows_, columns_;
};

// All diagrams of one arrangement, over its fine nodes: rows of A and B, columns of P and Q.
struct System {
    std::vector<Diagram> a, b, p, q;
};

// AP = I, BP = 0, AQ = 0, BQ = I, and as many details as fine nodes less coarse ones. Every entry is checked.
Proof prove(const System& system, std::size_t fineNodes);

// Row `coarse` of A: of least norm among those on `window` with AP = I. Nothing when there is none.
std::optional<Diagram> leastNormRow(const FiniteSubdivision& p, Node coarse, const std::vector<Node>& window);

// The row on `window`, up to a factor, with BP = 0. Nothing unless there is exactly one.
std::optional<Diagram> annihilator(const FiniteSubdivision& p, const std::vector<Node>& window);

// A first column of Q: of least norm among those on `window` with b[k] q = 1 and b[l] q = 0 else.
std::optional<Diagram> dualColumn(const std::vector<Diagram>& b, std::size_t k,
                                  const std::vector<Node>& window);

// (I - P A) q
Diagram lifted(const FiniteSubdivision& p, const std::vector<std::pair<Node, Diagram>>& a, const Diagram& q);

}  // namespace isowave::subdivision
