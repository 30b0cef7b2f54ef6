#include "subdivision/named_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "isowave/error.h"
#include "subdivision/curves/curve_schemes.h"
#include "subdivision/filters/diagram_print.h"
#include "subdivision/lattice/surface.h"

namespace isowave::subdivision {

namespace {

bool isMaskName(std::string_view name) { return std::ranges::find(maskNames(), name) != maskNames().end(); }

std::optional<int> usualWidth(std::string_view mask) {
    if (mask == "chaikin") return 4;
    if (mask == "cubic") return 7;
    if (mask == "dlg") return 9;
    if (mask == "butterfly") return 3;
    return std::nullopt;
}

std::string titled(const std::string& title, const Diagram& diagram, Lattice lattice, Node centre) {
    return title + "\n" + picture(diagram, lattice, centre) + "\n";
}

// Rows until they repeat: the first that is the next one, moved, and the same again.
std::size_t specialRows(const std::vector<Diagram>& rows, int step) {
    std::size_t k = 0;
    while (k + 2 < rows.size() &&
           !(rows[k].shifted({step, 0}) == rows[k + 1] && rows[k + 1].shifted({step, 0}) == rows[k + 2]))
        ++k;
    return k;
}

std::string endPictures(const CurveScheme& scheme) {
    const OpenSystem open = openSystem(scheme, 20);
    const Proof proof = prove(open.system, open.p.rows().size());
    std::string text = fmt::format(
        "{}, open: the diagrams beside the first point (fine points counted from it)\n"
        "{} coarse points, {} fine ones; {} products of diagrams, exact\n\n",
        scheme.name, open.system.a.size(), open.p.rows().size(), proof.products);
    const auto group = [&](const char* letter, const std::vector<Diagram>& diagrams, const auto& centreOf) {
        const std::size_t special = specialRows(diagrams, 2);
        for (std::size_t k = 0; k <= special && k < diagrams.size(); ++k) {
            const Extent box = extent(diagrams[k]);
            text += titled(fmt::format("{}{}   from f{} to f{}{}", letter, k, box.low.x, box.high.x,
                                       k == special ? ", as inside" : ""),
                           diagrams[k], Lattice::Line, {centreOf(k), 0});
        }
    };
    const auto vertex = [&](std::size_t j) {
        return extent(open.system.a[j]).low.x +
               (extent(open.system.a[j]).high.x - extent(open.system.a[j]).low.x) / 2;
    };
    const auto middle = [](const Diagram& d) { return (extent(d).low.x + extent(d).high.x) / 2; };
    group("P", open.system.p, [&](std::size_t j) { return middle(open.system.p[j]); });
    group("A", open.system.a, vertex);
    group("B", open.system.b, [&](std::size_t k) { return open.detailNode[k]; });
    group("Q", open.system.q, [&](std::size_t k) { return open.detailNode[k]; });
    return text;
}

std::string sidePictures(const SurfaceScheme& scheme) {
    const Patch patch = Patch::parallelogram(20, 20);
    std::string text =
        fmt::format("{}: beside a side (the lowest row of nodes), far from corners\n\n", scheme.name);
    for (const auto& [fine, what] : {std::pair(Node{21, 0}, "edge node on the side"),
                                     {Node{20, 1}, "edge node between the side and the first level in"},
                                     {Node{21, 2}, "edge node one level in"}}) {
        const Diagram row = surfaceRowOfP(scheme, patch, fine);
        text += titled(fmt::format("row of P, {} (over coarse nodes)", what), row, Lattice::Triangular,
                       row.begin()->first);
    }
    const char* places[] = {"on the side", "one level in", "two levels in", "three levels in"};
    for (int level = 0; level < 4; ++level) {
        const Diagram row = surfaceRowOfA(scheme, patch, {10, level});
        text += titled(fmt::format("row of A, {}; {} taps, squared norm {:.8f}", places[level], row.size(),
                                   toDouble(row.normSquared())),
                       row, Lattice::Triangular, {20, 2 * level});
    }
    return text;
}

}  // namespace

Filters maskFilters(const Mask& mask, std::optional<int> width) {
    if (width) return construct(mask, *width);
    const bool line = mask.lattice == Lattice::Line;
    if (const auto smallest = smallestWidth(mask, line ? 41 : 4)) return construct(mask, *smallest);
    // There is none: construct() says why. An even number of taps has even widths.
    const Extent box = extent(mask.p);
    return construct(mask, line ? 2 - (box.high.x - box.low.x + 1) % 2 : 0);
}

Filters namedFilters(std::string_view name, std::optional<int> width) {
    if (isMaskName(name)) return maskFilters(namedMask(name), width ? width : usualWidth(name));
    if (name.starts_with("bspline-")) {
        int degree = 0;
        const auto digits = name.substr(8);
        const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), degree);
        if (read.ec == std::errc() && read.ptr == digits.data() + digits.size() && degree >= 1 &&
            degree <= 20) {
            return maskFilters(bspline(degree), width);
        }
        throw InputError("subdivision '" + std::string(name) + "'",
                         "has no degree from 1 to 20, as bspline-3 has");
    }
    if (name.starts_with("loop-like:")) return maskFilters(surfaceScheme(name).mask, width ? *width : 1);
    const std::string_view base = name.substr(0, name.find('-'));
    if (base == name || !isMaskName(base) || base == "catmull") return maskFilters(namedMask(name), width);
    if (base == "butterfly" || base == "loop") {
        const SurfaceScheme scheme = surfaceScheme(name);
        return construct(scheme.mask, width.value_or(scheme.width));
    }
    CurveScheme scheme = curveScheme(name);
    if (!width) return interiorFilters(scheme);
    return construct(scheme.mask, *width);
}

std::string boundaryPictures(std::string_view name) {
    if (name.starts_with("butterfly") || name.starts_with("loop")) return sidePictures(surfaceScheme(name));
    if (name == "catmull-clark" || name.starts_with("bspline-")) {
        throw InputError("subdivision '" + std::string(name) + "'",
                         "has no boundary rules here; chaikin, cubic, dlg, butterfly and loop have");
    }
    return endPictures(curveScheme(name));
}

}  // namespace isowave::subdivision
