#include "subdivision/lattice/patch.h"

#include <algorithm>
#include <cassert>

namespace isowave::subdivision {

Patch::Patch(Kind kind, int a, int b) : kind_(kind), a_(a), b_(b) {
    assert(a >= 1 && b >= 1);
    rowLow_ = kind == Kind::Hexagon ? -b : 0;
    const int rowHigh = kind == Kind::Torus ? b - 1 : b;
    starts_.push_back(0);
    for (int j = rowLow_; j <= rowHigh; ++j) {
        starts_.push_back(starts_.back() + static_cast<std::size_t>(high(j) - low(j) + 1));
    }
}

Patch Patch::parallelogram(int a, int b) { return {Kind::Parallelogram, a, b}; }
Patch Patch::triangle(int n) { return {Kind::Triangle, n, n}; }
Patch Patch::hexagon(int n) { return {Kind::Hexagon, n, n}; }
Patch Patch::torus(int a, int b) { return {Kind::Torus, a, b}; }

Patch Patch::subdivided() const { return {kind_, 2 * a_, 2 * b_}; }
bool Patch::canCoarsen() const { return a_ % 2 == 0 && b_ % 2 == 0; }
Patch Patch::coarsened() const {
    assert(canCoarsen());
    return {kind_, a_ / 2, b_ / 2};
}

int Patch::low(int j) const { return kind_ == Kind::Hexagon ? std::max(-a_, -a_ - j) : 0; }

int Patch::high(int j) const {
    switch (kind_) {
        case Kind::Parallelogram:
            return a_;
        case Kind::Triangle:
            return a_ - j;
        case Kind::Hexagon:
            return std::min(a_, a_ - j);
        case Kind::Torus:
            break;
    }
    return a_ - 1;
}

bool Patch::contains(Node n) const {
    if (isTorus()) return true;
    return n.y >= firstRow() && n.y <= lastRow() && n.x >= low(n.y) && n.x <= high(n.y);
}

Node Patch::wrapped(Node n) const {
    if (!isTorus()) return n;
    return {((n.x % a_) + a_) % a_, ((n.y % b_) + b_) % b_};
}

std::vector<Node> Patch::nodes() const {
    std::vector<Node> all;
    all.reserve(size());
    for (int j = firstRow(); j <= lastRow(); ++j) {
        for (int i = low(j); i <= high(j); ++i) all.push_back({i, j});
    }
    return all;
}

std::vector<Node> Patch::edgeNodes() const {
    auto all = nodes();
    std::erase_if(all, isVertexNode);
    return all;
}

std::array<int, 6> Patch::distances(int a, int b, Node n) const {
    std::array<int, 6> d;
    d.fill(kFar);
    switch (kind_) {
        case Kind::Parallelogram:
            d = {n.x, a - n.x, n.y, b - n.y, kFar, kFar};
            break;
        case Kind::Triangle:
            d = {n.x, kFar, n.y, kFar, kFar, a - n.x - n.y};
            break;
        case Kind::Hexagon:
            d = {a + n.x, a - n.x, a + n.y, a - n.y, a + n.x + n.y, a - n.x - n.y};
            break;
        case Kind::Torus:
            break;
    }
    return d;
}

std::string Patch::name() const {
    const std::string a = std::to_string(a_), b = std::to_string(b_);
    switch (kind_) {
        case Kind::Parallelogram:
            return "parallelogram " + a + " x " + b;
        case Kind::Triangle:
            return "triangle " + a;
        case Kind::Hexagon:
            return "hexagon " + a;
        case Kind::Torus:
            break;
    }
    return "torus " + a + " x " + b;
}

}  // namespace isowave::subdivision
