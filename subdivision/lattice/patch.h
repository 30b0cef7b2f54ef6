// Where surface data lives: nodes of the triangular lattice, closed to a torus or cut off at straight sides.
//
//   parallelogram(a, b)   0 <= i <= a, 0 <= j <= b
//   triangle(n)           0 <= i, 0 <= j, i + j <= n
//   hexagon(n)            |i|, |j|, |i + j| <= n
//   torus(a, b)           i mod a, j mod b: no side
//
// Subdividing doubles the numbers: the fine node 2t of a coarse node t is its vertex node, the others lie in
// the middle of coarse edges. Nodes are stored row by row (j from low to high, in a row i from low to high).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "subdivision/filters/diagram.h"

namespace isowave::subdivision {

class Patch {
  public:
    // REQUIRES: a, b, n >= 1.
    static Patch parallelogram(int a, int b);
    static Patch triangle(int n);
    static Patch hexagon(int n);
    static Patch torus(int a, int b);

    Patch subdivided() const;
    // REQUIRES: canCoarsen().
    Patch coarsened() const;
    // All side lengths are even.
    bool canCoarsen() const;

    bool isTorus() const { return kind_ == Kind::Torus; }
    bool contains(Node node) const;
    // On a torus the node between 0 and the side length that this one is; else the node itself.
    Node wrapped(Node node) const;

    std::size_t size() const { return starts_.back(); }
    int firstRow() const { return rowLow_; }
    int lastRow() const { return rowLow_ + static_cast<int>(starts_.size()) - 2; }
    int low(int j) const;
    int high(int j) const;
    // REQUIRES: contains(node), and on a torus wrapped(node) == node.
    std::size_t index(Node node) const {
        return starts_[static_cast<std::size_t>(node.y - rowLow_)] +
               static_cast<std::size_t>(node.x - low(node.y));
    }
    std::vector<Node> nodes() const;
    // The nodes that are no vertex nodes, in the order of nodes(): where details sit.
    std::vector<Node> edgeNodes() const;

    // Steps to each side (six places; a side that the patch does not have is farther than any other).
    // 0 on the side itself. Two zeros: a corner.
    std::array<int, 6> distances(Node node) const { return distances(a_, b_, node); }
    // subdivided().distances(fine), without making that patch.
    std::array<int, 6> fineDistances(Node fine) const { return distances(2 * a_, 2 * b_, fine); }
    // The step along side s of distances(): 0, 1 have x fixed, 2, 3 y, 4, 5 x + y.
    static Node stepAlong(std::size_t side) {
        if (side < 2) return {0, 1};
        return side < 4 ? Node{1, 0} : Node{-1, 1};
    }
    static constexpr int kFar = 1 << 28;

    // "parallelogram 8 x 4", "hexagon 5": for messages.
    std::string name() const;
    bool operator==(const Patch& other) const {
        return kind_ == other.kind_ && a_ == other.a_ && b_ == other.b_;
    }

  private:
    enum class Kind { Parallelogram, Triangle, Hexagon, Torus };
    Patch(Kind kind, int a, int b);
    std::array<int, 6> distances(int a, int b, Node node) const;
    Kind kind_;
    int a_, b_, rowLow_ = 0;
    std::vector<std::size_t> starts_;  // index of the first node of each row, and the size at the end
};

}  // namespace isowave::subdivision
