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
#include "curves2d/segment_tree.h"

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

// The same as ringComplaint and ringsMeet together, for any number of rings: pairs of pieces whose boxes meet, of a
// tree, each pair by CGAL's exact predicates. "" or what is wrong.
inline std::string crossingComplaint(const std::vector<CurveRing>& rings) {
    struct Piece {
        std::size_t ring, at;
    };
    std::vector<Segment> segments;
    std::vector<Piece> pieces;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const Ring& ring = rings[r].points;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
            pieces.push_back({r, i});
        }
    }
    const auto toKernel = [](const Segment& s) { return Kernel::Segment_2({s.a.x, s.a.y}, {s.b.x, s.b.y}); };
    const auto nextOf = [&](const Piece& p) { return (p.at + 1) % rings[p.ring].points.size(); };
    const SegmentTree tree(segments);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        std::string wrong;
        Box box;
        box.take(segments[i].a);
        box.take(segments[i].b);
        tree.eachMeeting(box, [&](std::size_t j) {
            if (j <= i) return true;
            const Piece &p = pieces[i], &q = pieces[j];
            const bool follows = p.ring == q.ring && nextOf(p) == q.at,
                       leads = p.ring == q.ring && nextOf(q) == p.at;
            const auto a = toKernel(segments[i]), b = toKernel(segments[j]);
            // Neighbours share a point, and nothing else: neither far end lies on the other piece.
            const bool bad = follows ? a.has_on(b.target()) || b.has_on(a.source())
                             : leads ? a.has_on(b.source()) || b.has_on(a.target())
                                     : CGAL::do_intersect(a, b);
            if (bad)
                wrong = "ring " + std::to_string(p.ring) + ", piece " + std::to_string(p.at) +
                        " meets ring " + std::to_string(q.ring) + ", piece " + std::to_string(q.at);
            return !bad;
        });
        if (!wrong.empty()) return wrong;
    }
    return "";
}

// "" or what is wrong with directions and nesting of rings that do not meet.
inline std::string nestingComplaint(const std::vector<CurveRing>& rings) {
    std::vector<CgalPolygon> polygons;
    std::vector<CGAL::Bbox_2> boxes;
    std::vector<double> areas;
    for (const CurveRing& ring : rings) {
        polygons.push_back(toCgal(ring.points));
        boxes.push_back(polygons.back().bbox());
        areas.push_back(CGAL::to_double(polygons.back().area()));
    }
    for (std::size_t i = 0; i < rings.size(); ++i) {
        if ((areas[i] < 0) != rings[i].hole) return "ring " + std::to_string(i) + " turns the wrong way";
        // The rings around ring i, by its first point; the innermost has the smallest area.
        int parent = -1;
        std::size_t depth = 0;
        for (std::size_t j = 0; j < rings.size(); ++j) {
            if (j == i || !CGAL::do_overlap(boxes[i], boxes[j]) ||
                polygons[j].bounded_side(polygons[i][0]) != CGAL::ON_BOUNDED_SIDE)
                continue;
            ++depth;
            if (parent < 0 || std::abs(areas[j]) < std::abs(areas[static_cast<std::size_t>(parent)]))
                parent = static_cast<int>(j);
        }
        if (rings[i].parent != parent)
            return "ring " + std::to_string(i) + " lies in " + std::to_string(parent) + ", not in " +
                   std::to_string(rings[i].parent);
        if (rings[i].hole != (depth % 2 == 1)) return "ring " + std::to_string(i) + " is no hole, or is one";
    }
    return "";
}

// "" or what is wrong, for thousands of rings.
inline std::string complaintOfMany(const std::vector<CurveRing>& rings) {
    for (const CurveRing& ring : rings)
        if (ring.points.size() < 3) return "a ring of " + std::to_string(ring.points.size()) + " points";
    const std::string crossing = crossingComplaint(rings);
    return crossing.empty() ? nestingComplaint(rings) : crossing;
}

// "" or what is wrong. All pairs of rings: for hundreds of rings.
inline std::string complaint(const std::vector<CurveRing>& rings) {
    std::vector<CgalPolygon> polygons;
    for (const CurveRing& ring : rings) {
        const std::string wrong = ringComplaint(ring.points, ring.hole);
        if (!wrong.empty()) return wrong;
        polygons.push_back(toCgal(ring.points));
    }
    for (std::size_t i = 0; i < rings.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (ringsMeet(polygons[i], polygons[j]))
                return "rings " + std::to_string(j) + " and " + std::to_string(i) + " meet";
    return nestingComplaint(rings);
}

}  // namespace isowave::curves2d::validity
