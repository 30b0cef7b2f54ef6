// Curves in files. What is not a curve in the file (properties, styles, other elements) is kept when it is written
// again with other points.
//
//   .txt .xy .dat .csv  a point a line, "x y" or "x y z" (spaces or commas); a line that starts with '>' begins another
//                       curve, as GMT writes it; '#' begins a comment
//   .geojson .json      every LineString, Polygon ring and their Multi- forms, wherever they are in the document
//   .svg                every <path> of straight pieces (M L H V Z and lower case), <polyline>, <polygon>; points are
//                       the file's own numbers, transformations of the drawing are left to the drawing
//
// A curve is closed when its last point repeats its first (then it is not stored twice), or the file says so (a ring,
// Z, <polygon>).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "subdivision/curves/curve.h"

namespace isowave::subdivision {

class CurveFile {
  public:
    // Throws InputError naming the file and the line or element: no curve, a coordinate that is no number,
    // mixed dimensions, a curved SVG path, an unknown extension.
    static CurveFile read(const std::filesystem::path& path);
    // `text` as a file of this extension (".svg") would hold it; `name` stands in messages.
    static CurveFile parse(const std::string& text, const std::string& extension, const std::string& name);

    const std::vector<Polyline>& curves() const { return curves_; }
    // The file with curve k replaced by points[k]. REQUIRES: as many as curves().
    std::string with(const std::vector<Polyline>& points) const;

  private:
    struct Source;
    std::vector<Polyline> curves_;
    std::shared_ptr<const Source> source_;
};

}  // namespace isowave::subdivision
