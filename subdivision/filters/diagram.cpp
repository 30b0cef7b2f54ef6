#include "subdivision/filters/diagram.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace isowave::subdivision {

const char* name(Lattice lattice) {
    switch (lattice) {
        case Lattice::Line:
            return "line";
        case Lattice::Triangular:
            return "triangular";
        case Lattice::Quad:
            break;
    }
    return "quad";
}

int distance(Lattice lattice, Node a, Node b) {
    const Node d = b - a;
    const int box = std::max(std::abs(d.x), std::abs(d.y));
    // A step along (1,1) is not an edge of the triangular lattice: it takes two.
    return lattice == Lattice::Triangular ? std::max(box, std::abs(d.x + d.y)) : box;
}

std::vector<Node> ring(Lattice lattice, Node centre, int k) {
    if (k == 0) return {centre};
    if (lattice == Lattice::Line) return {centre + Node{k, 0}, centre - Node{k, 0}};
    std::vector<Node> nodes;
    Node at = centre + Node{0, k};
    const auto walk = [&](Node step, int count) {
        for (int s = 0; s < count; ++s, at = at + step) nodes.push_back(at);
    };
    if (lattice == Lattice::Triangular) {
        for (Node step : {Node{1, -1}, Node{0, -1}, Node{-1, 0}, Node{-1, 1}, Node{0, 1}, Node{1, 0}})
            walk(step, k);
    } else {
        walk({1, 0}, k);
        walk({0, -1}, 2 * k);
        walk({-1, 0}, 2 * k);
        walk({0, 1}, 2 * k);
        walk({1, 0}, k);
    }
    return nodes;
}

std::vector<Node> spiral(Lattice lattice, Node centre, int width) {
    std::vector<Node> nodes;
    for (int k = 0; k <= width; ++k) {
        const auto next = ring(lattice, centre, k);
        nodes.insert(nodes.end(), next.begin(), next.end());
    }
    return nodes;
}

std::vector<Node> detailNodes(Lattice lattice) {
    switch (lattice) {
        case Lattice::Line:
            return {{1, 0}};
        case Lattice::Triangular:
            return {{1, 0}, {0, 1}, {-1, 1}};
        case Lattice::Quad:
            break;
    }
    return {{1, 0}, {0, 1}, {1, 1}};
}

Diagram::Diagram(std::initializer_list<std::pair<Node, Rational>> values) {
    for (const auto& [node, value] : values) add(node, value);
}

Diagram Diagram::on(const std::vector<Node>& nodes, const std::vector<Rational>& values) {
    assert(nodes.size() == values.size());
    Diagram diagram;
    for (std::size_t k = 0; k < nodes.size(); ++k) diagram.add(nodes[k], values[k]);
    return diagram;
}

Rational Diagram::operator[](Node node) const {
    const auto found = values_.find(node);
    return found == values_.end() ? Rational(0) : found->second;
}

void Diagram::add(Node node, const Rational& value) {
    if (value == 0) return;
    const auto [place, isNew] = values_.try_emplace(node, value);
    if (isNew) return;
    place->second += value;
    if (place->second == 0) values_.erase(place);
}

void Diagram::add(const Diagram& other, const Rational& factor) {
    if (factor == 0) return;
    for (const auto& [node, value] : other) add(node, value * factor);
}

Diagram Diagram::shifted(Node by) const {
    Diagram moved;
    // The order of the nodes does not change under a shift, so each goes to the end.
    for (const auto& [node, value] : values_)
        moved.values_.emplace_hint(moved.values_.end(), node + by, value);
    return moved;
}

Diagram Diagram::scaled(const Rational& factor) const {
    Diagram result;
    result.add(*this, factor);
    return result;
}

Diagram Diagram::mirrored(Node centre) const {
    Diagram result;
    for (const auto& [node, value] : values_) result.add(centre - node, value);
    return result;
}

Rational Diagram::sum() const {
    Rational total = 0;
    for (const auto& [node, value] : values_) total += value;
    return total;
}

Rational Diagram::normSquared() const {
    Rational total = 0;
    for (const auto& [node, value] : values_) total += value * value;
    return total;
}

Rational Diagram::largest() const {
    Rational best = 0;
    for (const auto& [node, value] : values_)
        if (abs(value) > abs(best)) best = value;
    return best;
}

int Diagram::width(Lattice lattice, Node centre) const {
    int widest = 0;
    for (const auto& [node, value] : values_) widest = std::max(widest, distance(lattice, centre, node));
    return widest;
}

Integer commonDenominator(const Diagram& diagram) {
    Integer common = 1;
    for (const auto& [node, value] : diagram) common = lcm(common, Integer(denominator(value)));
    return common;
}

Rational inner(const Diagram& a, const Diagram& b) {
    Rational total = 0;
    auto i = a.begin();
    auto j = b.begin();
    while (i != a.end() && j != b.end()) {
        if (i->first < j->first) {
            ++i;
        } else if (j->first < i->first) {
            ++j;
        } else {
            total += (i++)->second * (j++)->second;
        }
    }
    return total;
}

Extent extent(const Diagram& diagram) {
    assert(!diagram.empty());
    Extent box{diagram.begin()->first, diagram.begin()->first};
    for (const auto& [node, value] : diagram) {
        box.low = {std::min(box.low.x, node.x), std::min(box.low.y, node.y)};
        box.high = {std::max(box.high.x, node.x), std::max(box.high.y, node.y)};
    }
    return box;
}

}  // namespace isowave::subdivision
