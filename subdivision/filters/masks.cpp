#include "subdivision/filters/masks.h"

#include <cassert>

#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

Diagram onLine(int first, const std::vector<Rational>& taps) {
    Diagram diagram;
    for (std::size_t k = 0; k < taps.size(); ++k) diagram.add({first + static_cast<int>(k), 0}, taps[k]);
    return diagram;
}

// A column of P gathers what each fine node takes from the coarse node 0: for the fine node n the rows are
// "n gets weight w from the coarse node at fine position n - offset". So a rule for the edge node along
// direction `along` is written once and turned by the lattice's symmetries.
Diagram butterflyColumn() {
    const Rational w(1, 16);
    // Every edge node e, at the middle of the coarse edge from u to v: 1/2 on u, v; 2w on the two opposite
    // nodes; -w on the four wings. Offsets are from the edge node, in fine steps, for the edge along (1,0).
    const std::vector<std::pair<Node, Rational>> rule = {{{-1, 0}, Rational(1, 2)},
                                                         {{1, 0}, Rational(1, 2)},
                                                         {{-1, 2}, 2 * w},
                                                         {{1, -2}, 2 * w},
                                                         {{-3, 2}, -w},
                                                         {{1, 2}, -w},
                                                         {{3, -2}, -w},
                                                         {{-1, -2}, -w}};
    Diagram p = Diagram::delta({0, 0});
    // Turns by 60 degrees: (x, y) -> (-y, x + y). Three edge directions: none, one and two turns.
    const auto turned = [](Node n, int times) {
        for (; times > 0; --times) n = {-n.y, n.x + n.y};
        return n;
    };
    for (int turn = 0; turn < 3; ++turn) {
        for (const auto& [offset, weight] : rule) p.add(-1 * turned(offset, turn), weight);
    }
    return p;
}

}  // namespace

Mask loopLike(const Rational& alpha, const Rational& gamma) {
    Mask mask{"loop-like:" + toString(alpha) + "," + toString(gamma), Lattice::Triangular, {}};
    mask.p.add({0, 0}, 1 - 6 * alpha);
    for (const Node n : ring(Lattice::Triangular, {}, 1)) {
        mask.p.add(n, Rational(1, 2) - gamma);
        mask.p.add(2 * n, alpha);
    }
    // The edge nodes that lie opposite: ring 2 without its corners.
    for (const Node n : ring(Lattice::Triangular, {}, 2)) {
        if (!isVertexNode(n)) mask.p.add(n, gamma);
    }
    return mask;
}

Mask bspline(int degree) {
    assert(degree >= 1);
    std::vector<Rational> taps{Rational(1)};
    for (int k = 0; k <= degree; ++k) {
        std::vector<Rational> next(taps.size() + 1, Rational(0));
        for (std::size_t i = 0; i < taps.size(); ++i) {
            next[i] += taps[i];
            next[i + 1] += taps[i];
        }
        taps = next;
    }
    for (auto& tap : taps) tap /= Rational(Integer(1) << degree);
    const int first = -((static_cast<int>(taps.size()) - 1) / 2);
    return {"bspline-" + std::to_string(degree), Lattice::Line, onLine(first, taps)};
}

const std::vector<std::string>& maskNames() {
    static const std::vector<std::string> names = {"chaikin",   "cubic", "dlg",
                                                   "butterfly", "loop",  "catmull-clark"};
    return names;
}

Mask namedMask(std::string_view name) {
    if (name == "chaikin" || name == "cubic") {
        Mask mask = bspline(name == "cubic" ? 3 : 2);
        mask.name = name;
        return mask;
    }
    if (name == "dlg") {
        const Rational w(1, 16), v = Rational(1, 2) + w;
        return {"dlg", Lattice::Line, onLine(-3, {-w, 0, v, 1, v, 0, -w})};
    }
    if (name == "butterfly") return {"butterfly", Lattice::Triangular, butterflyColumn()};
    if (name == "loop") {
        Mask mask = loopLike(Rational(1, 16), Rational(1, 8));
        mask.name = "loop";
        return mask;
    }
    if (name == "catmull-clark") {
        Mask mask{"catmull-clark", Lattice::Quad, {}};
        const Diagram line = bspline(3).p;
        for (const auto& [i, u] : line) {
            for (const auto& [j, v] : line) mask.p.add({i.x, j.x}, u * v);
        }
        return mask;
    }
    std::string known;
    for (const auto& each : maskNames()) known += (known.empty() ? "" : ", ") + each;
    throw InputError("subdivision '" + std::string(name) + "'",
                     "is not known; the known ones are " + known + ", or give your own with --mask");
}

Mask customMask(Lattice lattice, const std::vector<Rational>& values) {
    Mask mask{"mask", lattice, {}};
    if (lattice == Lattice::Line) {
        mask.p = onLine(-((static_cast<int>(values.size()) - 1) / 2), values);
    } else {
        int width = 0;
        while (spiral(lattice, {}, width).size() < values.size()) ++width;
        const auto nodes = spiral(lattice, {}, width);
        for (std::size_t k = 0; k < values.size(); ++k) mask.p.add(nodes[k], values[k]);
    }
    if (mask.p.empty())
        throw InputError("mask", "has no tap other than 0; give at least one, as in '1/4 3/4 3/4 1/4'");
    return mask;
}

}  // namespace isowave::subdivision
