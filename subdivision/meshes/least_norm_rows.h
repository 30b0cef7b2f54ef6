// Rows of A on any mesh, in doubles: on a window of fine points, the shortest row with AP = I, which is the window's
// least-squares fit (construct.h). x = P y with P'P y = (1 at v, 0 else), P cut to the window.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

// A node may be named more than once; its weights add up.
struct Tap {
    Index node;
    double weight;
};
using Taps = std::vector<Tap>;

// Windows on which P is the same matrix are solved for once. Not for several threads at once.
class LeastNormRows {
  public:
    // The row of P at a fine node, over coarse vertices.
    using RowOfP = std::function<void(Index fine, Taps& row)>;
    explicit LeastNormRows(RowOfP rowOfP) : rowOfP_(std::move(rowOfP)) {}

    // The weights of the row at the coarse vertex whose number the row of P at window[0] names first; one for each
    // node of the window, empty when the window has no such row. They stay where they are for as long as this lives.
    const std::vector<double>& weights(const std::vector<Index>& window);
    // Different matrices solved for so far.
    std::size_t solutionCount() const { return solutions_.size(); }

  private:
    void restrictTo(const std::vector<Index>& window);
    void factorise();
    std::vector<double> solve(const std::vector<double>& r) const;
    std::vector<double> shortest() const;
    std::vector<double> shortestByDirections() const;
    std::vector<double> leftOf(const std::vector<double>& x) const;
    bool isSolved(const std::vector<double>& x) const;

    RowOfP rowOfP_;
    // Of the present window: P, its coarse vertices numbered as they come; all of that in one vector.
    std::vector<Taps> p_;
    std::vector<Index> touched_;
    std::vector<double> key_;
    // The columns of P that were found independent, and the factor of their P'P.
    std::vector<std::size_t> chosen_;
    std::vector<std::vector<double>> directions_;
    std::map<std::vector<double>, std::vector<double>> solutions_;
};

// Where a value stands; values.size() when it is not there.
template <class Values, class Value>
std::size_t placeIn(const Values& values, const Value& value) {
    std::size_t k = 0;
    while (k < values.size() && values[k] != value) ++k;
    return k;
}

inline void addOnce(std::vector<Index>& nodes, Index node) {
    if (placeIn(nodes, node) == nodes.size()) nodes.push_back(node);
}

}  // namespace isowave::subdivision
