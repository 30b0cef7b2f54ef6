#include "subdivision/filter_catalogue.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "isowave/error.h"
#include "subdivision/curves/curve_schemes.h"
#include "subdivision/filters/finite_subdivision.h"
#include "subdivision/filters/masks.h"
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

// Rows until they repeat: the first that is the next one, moved, and the same again.
std::size_t specialRows(const std::vector<Diagram>& rows, int step) {
    std::size_t k = 0;
    while (k + 2 < rows.size() &&
           !(rows[k].shifted({step, 0}) == rows[k + 1] && rows[k + 1].shifted({step, 0}) == rows[k + 2]))
        ++k;
    return k;
}

void addDiagrams(char filter, const std::vector<Diagram>& diagrams, const std::vector<int>& centres,
                 BoundaryFilters& result) {
    const std::size_t special = specialRows(diagrams, 2);
    for (std::size_t k = 0; k <= special && k < diagrams.size(); ++k)
        result.diagrams.push_back({filter, "", k, k == special, diagrams[k], {centres[k], 0}});
}

// The middle of each diagram's extent; between two nodes the left one, counted from the origin or from the extent.
std::vector<int> middles(const std::vector<Diagram>& diagrams, bool fromOrigin) {
    std::vector<int> centres;
    for (const Diagram& diagram : diagrams) {
        const Extent box = extent(diagram);
        centres.push_back(fromOrigin ? (box.low.x + box.high.x) / 2
                                     : box.low.x + (box.high.x - box.low.x) / 2);
    }
    return centres;
}

BoundaryFilters endFilters(const CurveScheme& scheme) {
    const OpenSystem open = openSystem(scheme, 20);
    BoundaryFilters result;
    result.scheme = scheme.name;
    result.coarsePoints = open.system.a.size();
    result.finePoints = open.p.rows().size();
    result.products = prove(open.system, open.p.rows().size()).products;
    addDiagrams('P', open.system.p, middles(open.system.p, true), result);
    addDiagrams('A', open.system.a, middles(open.system.a, false), result);
    addDiagrams('B', open.system.b, open.detailNode, result);
    addDiagrams('Q', open.system.q, open.detailNode, result);
    return result;
}

BoundaryFilters sideFilters(const SurfaceScheme& scheme) {
    const Patch patch = Patch::parallelogram(20, 20);
    BoundaryFilters result;
    result.scheme = scheme.name;
    result.lattice = Lattice::Triangular;
    for (const auto& [fine, place] : {std::pair(Node{21, 0}, "edge node on the side"),
                                      {Node{20, 1}, "edge node between the side and the first level in"},
                                      {Node{21, 2}, "edge node one level in"}}) {
        const Diagram row = surfaceRowOfP(scheme, patch, fine);
        result.diagrams.push_back({'P', place, 0, false, row, row.begin()->first});
    }
    const char* places[] = {"on the side", "one level in", "two levels in", "three levels in"};
    for (int level = 0; level < 4; ++level)
        result.diagrams.push_back(
            {'A', places[level], 0, false, surfaceRowOfA(scheme, patch, {10, level}), {20, 2 * level}});
    return result;
}

Filter filterOf(const Diagram& diagram, Node centre) {
    Filter filter{centre.x, centre.y, {}};
    for (const auto& [node, value] : diagram)
        filter.taps.push_back({node.x, node.y, toString(value), toDouble(value)});
    return filter;
}

FilterSet setOf(const Filters& filters) {
    const Proof proof = prove(filters);
    FilterSet set;
    set.subdivision = filters.mask.name;
    set.lattice = filters.mask.lattice;
    set.width = filters.width;
    set.p = filterOf(filters.mask.p, {});
    set.a = filterOf(filters.a, {});
    for (std::size_t k = 0; k < filters.details.size(); ++k) {
        set.b.push_back(filterOf(filters.b[k], filters.details[k]));
        set.q.push_back(filterOf(filters.q[k], filters.details[k]));
    }
    set.products = proof.products;
    set.failure = proof.failure;
    return set;
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
    if (name == "dlg" && !width) return namedFilters("dlg-refined", width);  // what it stands for on curves
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
    Filters filters = width ? construct(scheme.mask, *width) : interiorFilters(scheme);
    if (!width && scheme.mask.name == "dlg") filters.mask.name = scheme.name;  // it has three fits
    return filters;
}

BoundaryFilters boundaryFilters(std::string_view name) {
    if (name.starts_with("butterfly") || name.starts_with("loop")) return sideFilters(surfaceScheme(name));
    if (name == "catmull-clark" || name.starts_with("bspline-")) {
        throw InputError("subdivision '" + std::string(name) + "'",
                         "has no boundary rules here; chaikin, cubic, dlg, butterfly and loop have");
    }
    return endFilters(curveScheme(name));
}

FilterSet filterSet(std::string_view name, std::optional<int> width) {
    return setOf(namedFilters(name, width));
}

FilterSet maskFilterSet(std::string_view mask, Lattice lattice, std::optional<int> width) {
    return setOf(maskFilters(customMask(lattice, parseRationals(mask)), width));
}

}  // namespace isowave::subdivision
