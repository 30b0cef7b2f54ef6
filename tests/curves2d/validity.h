// Whether curves are what contour.h promises, found out the slow and independent way: CGAL's exact predicates
// for rings, all pairs of rings for the rest.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <string>
#include <vector>

#include "curves2d/contour.h"

namespace isowave::curves2d::validity {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPolygon = CGAL::Polygon_2<Kernel>;

inline CgalPolygon toCgal(const Ring& ring) {
    CgalPolygon polygon;
    for (const Point& p : ring) polygon.push_back({p.x, p.y});
    return polygon;
}

// "" or what is wrong with one ring.
inline std::string ringComplaint(const Ring& ring, bool hole) {
    if (ring.size() < 3) return "a ring of " + std::to_string(ring.size()) + " points";
    const CgalPolygon polygon = toCgal(ring);
    if (!polygon.is_simple()) return "a ring that meets itself";
    if (polygon.is_clockwise_oriented() != hole) return "a ring that turns the wrong way";
    return "";
}

inline bool ringsMeet(const CgalPolygon& a, const CgalPolygon& b) {
    if (!CGAL::do_overlap(a.bbox(), b.bbox())) return false;
    for (auto i = a.edges_begin(); i != a.edges_end(); ++i) {
        if (!CGAL::do_overlap(i->bbox(), b.bbox())) continue;
        for (auto j = b.edges_begin(); j != b.edges_end(); ++j)
            if (CGAL::do_overlap(i->bbox(), j->bbox()) && CGAL::do_intersect(*i, *j)) return true;
    }
    return false;
}

// "" or what is wrong. All pairs of rings: for hundreds of rings.
inline std::string complaint(const std::vector<CurveRing>& rings) {
    std::vector<CgalPolygon> polygons;
    for (const CurveRing& ring : rings) {
        const std::string wrong = ringComplaint(ring.points, ring.hole);
        if (!wrong.empty()) return wrong;
        polygons.push_back(toCgal(ring.points));
    }
    for (std::size_t i = 0; i < rings.size(); ++i) {
        // The rings around ring i, by its first point; the innermost has the smallest area.
        int parent = -1;
        std::size_t depth = 0;
        for (std::size_t j = 0; j < rings.size(); ++j) {
            if (j == i) continue;
            if (j < i && ringsMeet(polygons[i], polygons[j]))
                return "rings " + std::to_string(j) + " and " + std::to_string(i) + " meet";
            if (!CGAL::do_overlap(polygons[i].bbox(), polygons[j].bbox()) ||
                polygons[j].bounded_side(polygons[i][0]) != CGAL::ON_BOUNDED_SIDE)
                continue;
            ++depth;
            if (parent < 0 || CGAL::abs(polygons[j].area()) < CGAL::abs(polygons[parent].area()))
                parent = static_cast<int>(j);
        }
        if (rings[i].parent != parent)
            return "ring " + std::to_string(i) + " lies in " + std::to_string(parent) + ", not in " +
                   std::to_string(rings[i].parent);
        if (rings[i].hole != (depth % 2 == 1)) return "ring " + std::to_string(i) + " is no hole, or is one";
    }
    return "";
}

}  // namespace isowave::curves2d::validity
