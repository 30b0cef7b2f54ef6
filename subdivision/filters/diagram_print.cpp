#include "subdivision/filters/diagram_print.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace isowave::subdivision {

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

// The diagrams in the order in which they are shown, with the node each is centred on.
struct Named {
    std::string title;
    const Diagram* diagram;
    Node centre;
};
std::vector<Named> all(const Filters& f) {
    std::vector<Named> list = {{"P", &f.mask.p, {}}, {"A", &f.a, {}}};
    for (const auto& [letter, group] : {std::pair("B", &f.b), std::pair("Q", &f.q)}) {
        for (std::size_t k = 0; k < group->size(); ++k) {
            const Node e = f.details[k];
            const std::string at = group->size() == 1 ? "" : fmt::format(" at edge node ({},{})", e.x, e.y);
            list.push_back({letter + at, &(*group)[k], e});
        }
    }
    return list;
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

// --- SVG
// ----------------------------------------------------------------------------------------------------

struct Point {
    double x, y;
};
constexpr double kStep = 46;  // between neighbouring fine nodes, in SVG units

Point place(Lattice lattice, Node n) {
    if (lattice == Lattice::Triangular) return {kStep * (n.x + 0.5 * n.y), -kStep * std::sqrt(0.75) * n.y};
    return {kStep * n.x, -kStep * n.y};
}

std::vector<Node> edgeSteps(Lattice lattice) {
    switch (lattice) {
        case Lattice::Line:
            return {{1, 0}};
        case Lattice::Triangular:
            return {{1, 0}, {0, 1}, {-1, 1}};
        case Lattice::Quad:
            break;
    }
    return {{1, 0}, {0, 1}};
}

struct Panel {
    std::string body;
    double left = 0, top = 0, right = 0, bottom = 0;
};

std::string fraction(const Rational& value, Point at) {
    const auto line = [&](const std::string& text, double dy, double size) {
        return fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" font-size=\"{:.1f}\">{}</text>\n", at.x,
            at.y + dy, size, text);
    };
    const auto sizeFor = [](std::size_t letters) {
        return std::min(11.0, 50.0 / static_cast<double>(letters + 1));
    };
    const std::string above = Integer(numerator(value)).str(), below = Integer(denominator(value)).str();
    if (below == "1") return line(above, 4, sizeFor(above.size()));
    const double size = sizeFor(std::max(above.size(), below.size()));
    return line(above, -2, size) + line(below, size - 1, size) +
           fmt::format(
               "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#222\" "
               "stroke-width=\"0.7\"/>\n",
               at.x - 12, at.y - 0.5, at.x + 12, at.y - 0.5);
}

Panel panel(const Diagram& diagram, Lattice lattice, Node centre, const std::string& title) {
    Extent box = diagram.empty() ? Extent{centre, centre} : extent(diagram);
    box.low = {std::min(box.low.x, centre.x), std::min(box.low.y, centre.y)};
    box.high = {std::max(box.high.x, centre.x), std::max(box.high.y, centre.y)};
    // The mesh is drawn where a value is, and one step around.
    const auto isShown = [&](Node n) {
        if (lattice == Lattice::Line) return n.y == 0;
        for (const auto& [node, value] : diagram) {
            if (distance(lattice, node, n) <= 1) return true;
        }
        return n == centre;
    };
    Panel result;
    std::string thin, thick, marks;
    Rational largest = 0;
    for (const auto& [node, value] : diagram) largest = std::max(largest, Rational(abs(value)));
    bool first = true;
    const int around = 1, up = lattice == Lattice::Line ? 0 : 1;
    for (int y = box.low.y - up; y <= box.high.y + up; ++y) {
        for (int x = box.low.x - around; x <= box.high.x + around; ++x) {
            const Node n{x, y};
            if (!isShown(n)) continue;
            const Point p = place(lattice, n);
            if (first) result = {"", p.x, p.y, p.x, p.y};
            first = false;
            result.left = std::min(result.left, p.x);
            result.right = std::max(result.right, p.x);
            result.top = std::min(result.top, p.y);
            result.bottom = std::max(result.bottom, p.y);
            for (const Node step : edgeSteps(lattice)) {
                if (!isShown(n + step)) continue;
                const Point q = place(lattice, n + step);
                // Half of a coarse edge: it begins or ends in a vertex node.
                const bool coarse = isVertexNode(n) || isVertexNode(n + step);
                (coarse ? thick : thin) += fmt::format(
                    "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", p.x, p.y, q.x, q.y);
            }
            const Rational value = diagram[n];
            if (value == 0 && n != centre) continue;
            const double strength = largest == 0 ? 0 : std::sqrt(std::abs(toDouble(value / largest)));
            const int fade = static_cast<int>(std::lround(255 - 150 * strength));
            const std::string fill = value == 0  ? "#ffffff"
                                     : value > 0 ? fmt::format("#{:02x}{:02x}ff", fade, (fade + 255) / 2)
                                                 : fmt::format("#ff{:02x}{:02x}", fade, fade);
            const char* width = n == centre ? "2.5" : "0.8";
            if (isVertexNode(n)) {
                marks += fmt::format(
                    "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"34\" height=\"34\" fill=\"{}\" stroke=\"#222\" "
                    "stroke-width=\"{}\"/>\n",
                    p.x - 17, p.y - 17, fill, width);
            } else {
                marks += fmt::format(
                    "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"18\" fill=\"{}\" stroke=\"#222\" "
                    "stroke-width=\"{}\"/>\n",
                    p.x, p.y, fill, width);
            }
            marks += fraction(value, p);
        }
    }
    result.left -= 30;
    result.right += 30;
    result.top -= 56;
    result.bottom += 30;
    result.body = "<g stroke=\"#bbb\" stroke-width=\"1\">\n" + thin +
                  "</g>\n<g stroke=\"#888\" stroke-width=\"2.2\">\n" + thick + "</g>\n" + marks +
                  fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"15\">{}</text>\n", result.left + 8,
                              result.top + 18, title);
    return result;
}

std::string page(const std::vector<Panel>& panels) {
    double y = 0, width = 0;
    std::string body;
    for (const auto& p : panels) {
        body +=
            fmt::format("<g transform=\"translate({:.1f} {:.1f})\">\n{}</g>\n", -p.left, y - p.top, p.body);
        y += p.bottom - p.top;
        width = std::max({width, p.right - p.left, 420.0});
    }
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.1f} {1:.1f}\" width=\"{0:.1f}\" "
               "height=\"{1:.1f}\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" "
               "fill=\"#fff\"/>\n",
               width, y) +
           body + "</svg>\n";
}

nlohmann::ordered_json toJson(Node node, Lattice lattice) {
    if (lattice == Lattice::Line) return node.x;
    return {node.x, node.y};
}

nlohmann::ordered_json toJson(const Diagram& diagram, Lattice lattice) {
    nlohmann::ordered_json nodes = nlohmann::ordered_json::array(), values = nodes, doubles = nodes;
    for (const auto& [node, value] : diagram) {
        nodes.push_back(toJson(node, lattice));
        values.push_back(toString(value));
        doubles.push_back(toDouble(value));
    }
    return {{"nodes", nodes}, {"values", values}, {"doubles", doubles}};
}

}  // namespace

Integer commonDenominator(const Diagram& diagram) {
    Integer common = 1;
    for (const auto& [node, value] : diagram) common = lcm(common, Integer(denominator(value)));
    return common;
}

std::string picture(const Diagram& diagram, Lattice lattice, Node centre) {
    if (diagram.empty()) return "(nothing)\n";
    return lattice == Lattice::Line ? lineRow(diagram, centre) : planePicture(diagram, lattice, centre);
}

std::string picture(const Filters& f) {
    const Proof proof = prove(f);
    std::string text =
        fmt::format("{} on the {} lattice, A of width {}\n", f.mask.name, name(f.mask.lattice), f.width);
    text += fmt::format("AP = I, BP = 0, AQ = 0, BQ = I: {} ({} products of diagrams, exact)\n",
                        proof ? "proved" : proof.failure, proof.products);
    for (const auto& [title, diagram, centre] : all(f)) {
        text += fmt::format("\n{}   {}; {} taps\n{}", title, roleOf(title[0]), diagram->size(),
                            picture(*diagram, f.mask.lattice, centre));
    }
    return text;
}

std::string json(const Filters& f) {
    const Proof proof = prove(f);
    nlohmann::ordered_json j = {{"version", 1},
                                {"subdivision", f.mask.name},
                                {"lattice", name(f.mask.lattice)},
                                {"width", f.width},
                                {"P", toJson(f.mask.p, f.mask.lattice)},
                                {"A", toJson(f.a, f.mask.lattice)}};
    for (const auto& [letter, group] : {std::pair("B", &f.b), std::pair("Q", &f.q)}) {
        auto list = nlohmann::ordered_json::array();
        for (std::size_t k = 0; k < group->size(); ++k) {
            auto one = toJson((*group)[k], f.mask.lattice);
            one["centre"] = toJson(f.details[k], f.mask.lattice);
            list.push_back(one);
        }
        j[letter] = list;
    }
    j["proof"] = {{"holds", static_cast<bool>(proof)}, {"products", proof.products}};
    return j.dump(1) + "\n";
}

std::string svg(const Filters& f) {
    std::vector<Panel> panels;
    for (const auto& [title, diagram, centre] : all(f)) {
        // The other orientations are the first one, turned.
        const bool repeats = f.mask.lattice == Lattice::Triangular && (title[0] == 'B' || title[0] == 'Q') &&
                             centre != f.details[0];
        if (repeats) continue;
        panels.push_back(panel(*diagram, f.mask.lattice, centre, f.mask.name + ", " + title));
    }
    return page(panels);
}

std::string svg(const Diagram& diagram, Lattice lattice, Node centre, const std::string& title) {
    return page({panel(diagram, lattice, centre, title)});
}

}  // namespace isowave::subdivision
