// Diagrams: values written on the nodes of a lattice (Bartels and Samavati, "Constructing biorthogonal
// multiresolutions from any subdivision with diagrams", sections 4 to 7).
//
// A row of A or B and a column of P or Q all live on the *fine* nodes, so each is one diagram, and an entry
// of a product such as AP is the inner product of two of them. No node is ever numbered: a diagram does not
// change when points are renamed, and shifting a diagram by 2t is what moving it to the coarse node t means.
//
//   lattice      node      neighbours                     drawn at             a ball of width w has
//   Line         (x, 0)    +-(1,0)                        (x, 0)               2w + 1 nodes
//   Triangular   (i, j)    +-(1,0), +-(0,1), +-(-1,1)     (i + j/2, j sqrt3/2) 1 + 3w(w + 1) nodes
//   Quad         (i, j)    the eight around               (i, j)               (2w + 1)^2 nodes
//
// "Width" counts taps on the line and rings on the other two.
#pragma once

#include <compare>
#include <initializer_list>
#include <map>
#include <utility>
#include <vector>

#include "isowave/filters.h"
#include "subdivision/filters/rational.h"

namespace isowave::subdivision {

struct Node {
    int x = 0, y = 0;
    auto operator<=>(const Node&) const = default;
};
inline Node operator+(Node a, Node b) { return {a.x + b.x, a.y + b.y}; }
inline Node operator-(Node a, Node b) { return {a.x - b.x, a.y - b.y}; }
inline Node operator*(int s, Node a) { return {s * a.x, s * a.y}; }

// The fine node 2t of a coarse node t is its vertex node; the others are edge nodes (faces too, on Quad).
inline bool isVertexNode(Node fine) { return fine.x % 2 == 0 && fine.y % 2 == 0; }

// "line", "triangular", "quad".
const char* name(Lattice lattice);

// Steps between two nodes: the number of the ring around a on which b lies.
int distance(Lattice lattice, Node a, Node b);

// Ring k around the centre, in spiral order: it starts at (0, k) and runs clockwise. On the line: +k, -k.
std::vector<Node> ring(Lattice lattice, Node centre, int k);

// Rings 0 to width, one after the other: a0, a1 .. a6, a7 .. a18, a19 ..
std::vector<Node> spiral(Lattice lattice, Node centre, int width);

// The nodes of the unit cell that are not vertex nodes: where the details sit. One on the line, three else.
std::vector<Node> detailNodes(Lattice lattice);

class Diagram {
  public:
    Diagram() = default;
    Diagram(std::initializer_list<std::pair<Node, Rational>> values);
    // The value 1 on one node.
    static Diagram delta(Node node) { return Diagram{{node, Rational(1)}}; }
    // values[k] on nodes[k]; zeros are left out. REQUIRES: as many values as nodes.
    static Diagram on(const std::vector<Node>& nodes, const std::vector<Rational>& values);

    // 0 where nothing is written. A value that becomes 0 is taken away, so two equal diagrams compare equal.
    Rational operator[](Node node) const;
    void add(Node node, const Rational& value);

    // this += factor * other
    void add(const Diagram& other, const Rational& factor);
    Diagram shifted(Node by) const;
    Diagram scaled(const Rational& factor) const;
    // The value at x moves to centre - x.
    Diagram mirrored(Node centre) const;

    Rational sum() const;
    Rational normSquared() const;
    // The value that is farthest from 0, the first of equals; 0 for an empty diagram.
    Rational largest() const;
    // Number of the outermost ring around the centre that holds a value; 0 for an empty diagram.
    int width(Lattice lattice, Node centre = {}) const;

    std::size_t size() const { return values_.size(); }
    bool empty() const { return values_.empty(); }
    auto begin() const { return values_.begin(); }
    auto end() const { return values_.end(); }
    bool operator==(const Diagram&) const = default;

  private:
    std::map<Node, Rational> values_;
};

// The least common denominator of all values; 1 for an empty diagram.
Integer commonDenominator(const Diagram& diagram);

// The sum of products over the nodes that both hold: one entry of a product of matrices.
Rational inner(const Diagram& a, const Diagram& b);

// The smallest box that holds the diagram. REQUIRES: not empty.
struct Extent {
    Node low, high;
};
Extent extent(const Diagram& diagram);

}  // namespace isowave::subdivision
