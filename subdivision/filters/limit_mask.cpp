#include "subdivision/filters/limit_mask.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>

#include "isowave/error.h"
#include "subdivision/filters/exact_solve.h"

namespace isowave::subdivision {
namespace {

// Iterated masks of so many nodes are enough to see differences shrink, and take a moment.
constexpr std::size_t kMostNodes = 1u << 18;

std::vector<Node> edgeDirections(Lattice lattice) {
    if (lattice == Lattice::Line) return {{1, 0}};
    return {{1, 0}, {0, 1}, {-1, 1}};
}

// ---- the taps of one fine node ----

Node parityOf(Node node) { return {node.x & 1, node.y & 1}; }

// What the fine nodes of each parity take from the coarse ones, in sum.
std::map<Node, Rational> sumsByParity(const Mask& mask) {
    std::map<Node, Rational> sums{{{0, 0}, Rational(0)}};
    for (const Node node : detailNodes(mask.lattice)) sums[parityOf(node)] = 0;
    for (const auto& [node, weight] : mask.p) sums[parityOf(node)] += weight;
    return sums;
}

// ---- differences ----

// A function on the nodes of a box, row by row; 0 outside.
struct Values {
    Node low;
    int columns = 0, rows = 0;
    std::vector<double> at;

    Values(Node l, Node high) : low(l), columns(high.x - l.x + 1), rows(high.y - l.y + 1) {
        at.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.0);
    }
    Node high() const { return low + Node{columns - 1, rows - 1}; }
    bool has(Node n) const {
        return n.x >= low.x && n.y >= low.y && n.x < low.x + columns && n.y < low.y + rows;
    }
    std::size_t index(Node n) const {
        return static_cast<std::size_t>(n.y - low.y) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(n.x - low.x);
    }
    double operator[](Node n) const { return has(n) ? at[index(n)] : 0.0; }
};

// a_(k+1)(i) = sum of p[i - 2j] a_k(j).
Values subdividedOnce(const Values& a, const Mask& mask) {
    const Extent box = extent(mask.p);
    Values fine(2 * a.low + box.low, 2 * a.high() + box.high);
    for (const auto& [node, weight] : mask.p) {
        const double w = toDouble(weight);
        for (int y = 0; y < a.rows; ++y)
            for (int x = 0; x < a.columns; ++x) {
                const Node j = a.low + Node{x, y};
                fine.at[fine.index(2 * j + node)] += w * a[j];
            }
    }
    return fine;
}

// The largest sum over t of |a(i - 2^k t) - a(i + e - 2^k t)|. Nodes i that differ by multiples of 2^k have the same sum.
double largestDifference(const Values& a, Node e, int size) {
    const auto residue = [size](Node n) {
        const auto part = [size](int v) { return ((v % size) + size) % size; };
        return static_cast<std::size_t>(part(n.y)) * static_cast<std::size_t>(size) +
               static_cast<std::size_t>(part(n.x));
    };
    std::map<std::size_t, double> sums;
    for (int y = a.low.y - std::abs(e.y); y <= a.high().y + std::abs(e.y); ++y)
        for (int x = a.low.x - std::abs(e.x); x <= a.high().x + std::abs(e.x); ++x)
            sums[residue({x, y})] += std::abs(a[{x, y}] - a[Node{x, y} + e]);
    double most = 0;
    for (const auto& [place, sum] : sums) most = std::max(most, sum);
    return most;
}

// Some iterate of the mask shrinks differences. The coarse nodes that reach a fine edge lie within the box of F and a step.
bool shrinksDifferences(const Mask& mask) {
    const Extent box = extent(mask.p);
    const double reach = (box.high.x - box.low.x) + (box.high.y - box.low.y) + 1;
    Values a(Node{}, Node{});
    a.at = {1.0};
    for (int size = 2;; size *= 2) {
        a = subdividedOnce(a, mask);
        double most = 0;
        for (const Node e : edgeDirections(mask.lattice))
            most = std::max(most, largestDifference(a, e, size));
        if (!std::isfinite(most)) return false;
        if (reach * most < 1) return true;
        if (a.at.size() > kMostNodes) return false;
    }
}

// ---- F ----

// F at x + all nodes.
using Translates = Diagram;

// The nodes at which F may differ from 0: those of the box that the mask spans.
std::vector<Node> support(const Mask& mask) {
    const Extent box = extent(mask.p);
    std::vector<Node> nodes;
    for (int y = box.low.y; y <= box.high.y; ++y)
        for (int x = box.low.x; x <= box.high.x; ++x) nodes.push_back({x, y});
    return nodes;
}

// F(i) = sum of p[2i - j] F(j), and their sum is 1.
Translates atNodes(const Mask& mask) {
    const auto nodes = support(mask);
    Matrix equations;
    for (const Node i : nodes) {
        std::vector<Rational> row;
        for (const Node j : nodes) row.push_back(mask.p[2 * i - j] - Rational(i == j ? 1 : 0));
        equations.push_back(std::move(row));
    }
    const Matrix basis = nullspace(equations);
    assert(basis.size() == 1 && "a convergent subdivision has one limit function");
    const Diagram values = Diagram::on(nodes, basis[0]);
    return values.scaled(1 / values.sum());
}

bool isInteger(const Rational& value) { return denominator(value) == 1; }

// F(x + i) = sum of p[k] F(2x + 2i - k); every k has a translate of 2x of its own.
// On the line, where alone the place may lie between nodes.
Translates atPlace(const Mask& mask, const Rational& x, const Translates& whole) {
    if (isInteger(x)) return whole.shifted(Node{-1 * numerator(x).convert_to<int>(), 0});
    const Translates twice = atPlace(mask, 2 * x, whole);
    const Extent box = extent(mask.p);
    const int low = box.low.x - 1 - static_cast<int>(std::abs(std::ceil(toDouble(x)))),
              high = box.high.x + 1 + static_cast<int>(std::abs(std::floor(toDouble(x))));
    Translates result;
    for (int i = low; i <= high; ++i)
        for (const auto& [k, weight] : mask.p) result.add({i, 0}, weight * twice[{2 * i - k.x, 0}]);
    return result;
}

// (2), the coordinate along the line.
Rational centre(const Mask& mask) {
    Rational sum = 0;
    for (const auto& [node, weight] : mask.p) sum += weight * node.x;
    return sum / 2;
}

bool isPowerOfTwo(const Integer& value) { return (value & (value - 1)) == 0; }

// S(m) = sum of c_t F(m - t).
Diagram weightsAt(const Translates& atM) { return atM.mirrored({}); }

Diagram limitOnLine(const Mask& mask) {
    const Rational m = centre(mask);
    if (!isPowerOfTwo(denominator(m)))
        throw InputError("'" + mask.name + "'",
                         "has no limit positions: the centre of its taps, " + toString(m) +
                             ", has a denominator that is no power of two; take a symmetric mask");
    return weightsAt(atPlace(mask, m, atNodes(mask)));
}

}  // namespace

std::string whyNoLimit(const Mask& mask) {
    for (const auto& [parity, sum] : sumsByParity(mask))
        if (sum != 1)
            return "the taps that make a fine point must add up to 1; some add up to " + toString(sum);
    if (!shrinksDifferences(mask))
        return "its subdivisions are not seen to converge: differences of neighbours do not shrink";
    return {};
}

Diagram limitMask(const Mask& mask) {
    if (const std::string why = whyNoLimit(mask); !why.empty())
        throw InputError("'" + mask.name + "'", "has no limit positions: " + why);
    if (mask.lattice == Lattice::Line) return limitOnLine(mask);
    assert(mask.lattice == Lattice::Triangular);
    return weightsAt(atNodes(mask));  // loop-like masks lie evenly about their vertex node: m = 0
}

}  // namespace isowave::subdivision
