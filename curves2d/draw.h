// Curves -> files: SVG, GeoJSON, text, PNG, and a sheet with all levels side by side. Every file appears
// whole or not at all. Coordinates are the input's, with 12 digits (SVG: 10), so that rings which are simple
// stay so.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "curves2d/contour.h"
#include "curves2d/segment_tree.h"

namespace isowave::curves2d {

// How the input's coordinates become a picture.
struct View {
    Box extent;        // what the picture shows
    bool yUp = false;  // turn the picture round, so that north is up
};

// One path of all rings, filled by the even-odd rule.
void writeSvg(const std::filesystem::path& path, const Curves& curves, const View& view);
void writeSvg(const std::filesystem::path& path, const SmoothCurves& curves, const View& view);

// A FeatureCollection of one MultiPolygon: every outer ring with the holes directly in it, the first point
// repeated at the end (RFC 7946). name: a property of the feature.
void writeGeojson(const std::filesystem::path& path, const Curves& curves, const std::string& name);

// GMT's multiple segments: "> outer" or "> hole in N" before the lines `x y` of each ring, the first point
// repeated; ring N is the N-th in the file, from 0.
void writeText(const std::filesystem::path& path, const Curves& curves);

// Black on white, 8-bit grey, 16 samples a pixel.
// pixels: along the longer side of the extent.
void writePng(const std::filesystem::path& path, const Curves& curves, const View& view, int pixels = 1024);

// One picture of several: left to right, top to bottom, each with its label below.
struct Panel {
    std::string label;
    Curves curves;
};
// The SVG's text: it is one of several files of a job, which appear together.
std::string sheetOf(const std::vector<Panel>& panels, const View& view);

}  // namespace isowave::curves2d
