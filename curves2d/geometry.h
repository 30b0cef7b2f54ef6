// Points, rings and polygons of the plane, and where the lattice lies in it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace isowave::curves2d {

struct Point {
    double x = 0, y = 0;

    double operator[](int axis) const { return axis == 0 ? x : y; }
    friend Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
    friend Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
    friend Point operator*(double s, Point p) { return {s * p.x, s * p.y}; }
    friend bool operator==(const Point&, const Point&) = default;
};

inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
inline double length(Point a) { return std::hypot(a.x, a.y); }

// A closed polyline; the last point is joined to the first one, which is not repeated.
using Ring = std::vector<Point>;

// Twice a sum would overflow nothing, but far from the origin it loses digits: taken relative to the first
// point. Positive when counter-clockwise (y pointing up).
inline double signedArea(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i)
        twice += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
    return twice / 2;
}

// The points that lie inside an odd number of its rings. Which ring is the outer one follows from that; their
// directions mean nothing.
struct Polygon {
    std::vector<Ring> rings;
};

// A straight piece of a boundary.
struct Segment {
    Point a, b;
};

// Where lattice point (i, j) lies: origin + spacing * (i, j). One step down the pyramid doubles one spacing
// and leaves the origin.
struct Frame {
    Point origin{0, 0};
    Point spacing{1, 1};

    Point toWorld(Point lattice) const {
        return {origin.x + spacing.x * lattice.x, origin.y + spacing.y * lattice.y};
    }
    Point toLattice(Point world) const {
        return {(world.x - origin.x) / spacing.x, (world.y - origin.y) / spacing.y};
    }
    friend bool operator==(const Frame&, const Frame&) = default;
};

}  // namespace isowave::curves2d
