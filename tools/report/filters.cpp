#include "tools/report/filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace isowave::tools {

using namespace subdivision;

namespace {

std::string over(const Integer& denominator) {
    return denominator == 1 ? "" : "1/" + denominator.str() + " x";
}

std::string cell(const Rational& value, bool isCentre) {
    const std::string text = value == 0 ? "." : toString(value);
    return isCentre ? "[" + text + "]" : " " + text + " ";
}

std::string lineRow(const Diagram& diagram, Node centre) {
    const Integer denominator = commonDenominator(diagram);
    const Extent box = extent(diagram);
    std::string text = over(denominator);
    for (int x = std::min(box.low.x, centre.x); x <= std::max(box.high.x, centre.x); ++x) {
        text += " " + cell(diagram[{x, 0}] * Rational(denominator), Node{x, 0} == centre);
    }
    return text + "\n";
}

// Half cells from the left at which a node stands, and whether its row is moved by one.
int halfCells(Lattice lattice, Node n) { return lattice == Lattice::Triangular ? 2 * n.x + n.y : 2 * n.x; }

std::string planePicture(const Diagram& diagram, Lattice lattice, Node centre) {
    const Integer denominator = commonDenominator(diagram);
    Extent box = extent(diagram);
    std::size_t widest = 3;
    int left = halfCells(lattice, centre);
    for (const auto& [node, value] : diagram) {
        widest = std::max(widest, cell(value * Rational(denominator), true).size());
        left = std::min(left, halfCells(lattice, node));
    }
    widest += widest % 2;  // so that half a cell is a whole number of letters
    std::string text = denominator == 1 ? "" : over(denominator) + "\n";
    for (int y = std::max(box.high.y, centre.y); y >= std::min(box.low.y, centre.y); --y) {
        // Zeros are shown between the first and the last value of a row only.
        int first = box.high.x + 1, last = box.low.x - 1;
        for (int x = box.low.x; x <= box.high.x; ++x) {
            if (diagram[{x, y}] == 0 && Node{x, y} != centre) continue;
            first = std::min(first, x);
            last = std::max(last, x);
        }
        std::string row;
        for (int x = first; x <= last; ++x) {
            const auto start = static_cast<std::size_t>(halfCells(lattice, {x, y}) - left) * widest / 2;
            row.resize(std::max(row.size(), start), ' ');
            row += fmt::format("{:^{}}", cell(diagram[{x, y}] * Rational(denominator), Node{x, y} == centre),
                               widest);
        }
        row.erase(row.find_last_not_of(' ') + 1);
        text += row + "\n";
    }
    return text;
}

const char* roleOf(char letter) {
    switch (letter) {
        case 'P':
            return "column of P: what a coarse value adds to the fine ones";
        case 'A':
            return "row of A: a coarse value from the fine ones";
        case 'B':
            return "row of B: a detail from the fine values";
        default:
            return "column of Q: what a detail adds to the fine values";
    }
}

Json toJson(Node node, Lattice lattice) {
    if (lattice == Lattice::Line) return node.x;
    return {node.x, node.y};
}

Json toJson(const Diagram& diagram, Lattice lattice) {
    Json nodes = Json::array(), values = nodes, doubles = nodes;
    for (const auto& [node, value] : diagram) {
        nodes.push_back(toJson(node, lattice));
        values.push_back(toString(value));
        doubles.push_back(toDouble(value));
    }
    return {{"nodes", nodes}, {"values", values}, {"doubles", doubles}};
}

std::string endText(const BoundaryFilters& f) {
    std::string out = fmt::format(
        "{}, open: the diagrams beside the first point (fine points counted from it)\n"
        "{} coarse points, {} fine ones; {} products of diagrams, exact\n\n",
        f.scheme, f.coarsePoints, f.finePoints, f.products);
    for (const BoundaryDiagram& d : f.diagrams) {
        const Extent box = extent(d.diagram);
        out += fmt::format("{}{}   from f{} to f{}{}\n{}\n", d.filter, d.number, box.low.x, box.high.x,
                           d.asInside ? ", as inside" : "", picture(d.diagram, f.lattice, d.centre));
    }
    return out;
}

std::string sideText(const BoundaryFilters& f) {
    std::string out =
        fmt::format("{}: beside a side (the lowest row of nodes), far from corners\n\n", f.scheme);
    for (const BoundaryDiagram& d : f.diagrams) {
        out += d.filter == 'P' ? fmt::format("row of P, {} (over coarse nodes)", d.place)
                               : fmt::format("row of A, {}; {} taps, squared norm {:.8f}", d.place,
                                             d.diagram.size(), toDouble(d.diagram.normSquared()));
        out += "\n" + picture(d.diagram, f.lattice, d.centre) + "\n";
    }
    return out;
}

}  // namespace

std::vector<NamedDiagram> namedDiagrams(const Filters& f) {
    std::vector<NamedDiagram> list = {{"P", &f.mask.p, {}}, {"A", &f.a, {}}};
    for (const auto& [letter, group] : {std::pair("B", &f.b), std::pair("Q", &f.q)}) {
        for (std::size_t k = 0; k < group->size(); ++k) {
            const Node e = f.details[k];
            const std::string at = group->size() == 1 ? "" : fmt::format(" at edge node ({},{})", e.x, e.y);
            list.push_back({letter + at, &(*group)[k], e});
        }
    }
    return list;
}

std::string picture(const Diagram& diagram, Lattice lattice, Node centre) {
    if (diagram.empty()) return "(nothing)\n";
    return lattice == Lattice::Line ? lineRow(diagram, centre) : planePicture(diagram, lattice, centre);
}

std::string textOf(const Filters& f, const Proof& proof) {
    std::string text =
        fmt::format("{} on the {} lattice, A of width {}\n", f.mask.name, name(f.mask.lattice), f.width);
    text += fmt::format("AP = I, BP = 0, AQ = 0, BQ = I: {} ({} products of diagrams, exact)\n",
                        proof ? "proved" : proof.failure, proof.products);
    for (const auto& [title, diagram, centre] : namedDiagrams(f)) {
        text += fmt::format("\n{}   {}; {} taps\n{}", title, roleOf(title[0]), diagram->size(),
                            picture(*diagram, f.mask.lattice, centre));
    }
    return text;
}

namespace {

Json treeOf(const Filters& f, const Proof& proof) {
    Json j = {{"version", 1},
              {"subdivision", f.mask.name},
              {"lattice", name(f.mask.lattice)},
              {"width", f.width},
              {"P", toJson(f.mask.p, f.mask.lattice)},
              {"A", toJson(f.a, f.mask.lattice)}};
    for (const auto& [letter, group] : {std::pair("B", &f.b), std::pair("Q", &f.q)}) {
        Json list = Json::array();
        for (std::size_t k = 0; k < group->size(); ++k) {
            Json one = toJson((*group)[k], f.mask.lattice);
            one["centre"] = toJson(f.details[k], f.mask.lattice);
            list.push_back(one);
        }
        j[letter] = list;
    }
    j["proof"] = {{"holds", static_cast<bool>(proof)}, {"products", proof.products}};
    return j;
}

}  // namespace

std::string jsonOf(const Filters& f, const Proof& proof) { return dumped(treeOf(f, proof), 1); }

std::string textOf(const BoundaryFilters& f) { return f.lattice == Lattice::Line ? endText(f) : sideText(f); }

}  // namespace isowave::tools
