#include "tools/report/filters_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/report/filters.h"

namespace isowave::tools {

using namespace subdivision;

namespace {

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

// Blue for positive, red for negative, white for 0; paler where the value is smaller than the largest.
std::string colourOf(const Rational& value, const Rational& largest) {
    if (value == 0) return "#ffffff";
    const double strength = largest == 0 ? 0 : std::sqrt(std::abs(toDouble(value / largest)));
    const int fade = static_cast<int>(std::lround(255 - 150 * strength));
    return value > 0 ? fmt::format("#{:02x}{:02x}ff", fade, (fade + 255) / 2)
                     : fmt::format("#ff{:02x}{:02x}", fade, fade);
}

// A value in its circle, or its square on a vertex node; the centre's has a thick line.
std::string markOf(const Rational& value, const Rational& largest, Node node, bool isCentre, Point p) {
    const std::string fill = colourOf(value, largest);
    const char* width = isCentre ? "2.5" : "0.8";
    const std::string outline =
        isVertexNode(node)
            ? fmt::format(
                  "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"34\" height=\"34\" fill=\"{}\" stroke=\"#222\" "
                  "stroke-width=\"{}\"/>\n",
                  p.x - 17, p.y - 17, fill, width)
            : fmt::format(
                  "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"18\" fill=\"{}\" stroke=\"#222\" "
                  "stroke-width=\"{}\"/>\n",
                  p.x, p.y, fill, width);
    return outline + fraction(value, p);
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
            marks += markOf(value, largest, n, n == centre, p);
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

}  // namespace

std::string svg(const Filters& f) {
    std::vector<Panel> panels;
    for (const auto& [title, diagram, centre] : namedDiagrams(f)) {
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

}  // namespace isowave::tools
