// Polygons from files: GeoJSON, TopoJSON, plain text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "curves2d/geometry.h"

namespace isowave::curves2d {

struct PolygonInput {
    std::vector<Polygon> polygons;
    // One line each: what was repaired, and in which ring.
    std::vector<std::string> remarks;

    std::size_t ringCount() const;
    std::size_t pointCount() const;
};

// By content: GeoJSON (Polygon, MultiPolygon, alone, in features or in collections; other geometries are left
// out with a remark), TopoJSON of the same (what npm's world-atlas holds); otherwise text: `x y` a line,
// rings separated by blank lines or lines that start with '>' (GMT's multiple segments); '#' comments. The
// rings of a text file are one polygon.
//
// Repaired, with a remark: a ring that is not closed (it is closed), equal neighbours (one is dropped), rings
// of fewer than three different points (left out), rings that cross the antimeridian once, so that they go round a
// pole (completed along the border of the map), rings that cross themselves (the first place is named; inside is
// what an odd number of windings surrounds). Throws InputError: nothing to read, broken JSON, a
// coordinate that is no finite number or beyond 1e9, no ring left. Names the ring.
PolygonInput readPolygons(const std::filesystem::path& path);

// The first place where a ring meets itself other than in the points where neighbours join; false: nowhere.
bool selfIntersection(const Ring& ring, Point& place);

// Whether the file's name says polygons rather than image: .geojson, .json, .topojson, .txt, .gmt,
// .xy.
bool looksLikePolygons(const std::filesystem::path& path);

}  // namespace isowave::curves2d
