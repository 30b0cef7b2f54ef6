#include "tests/fuzz/vector.h"

#include <cmath>

#include "curves2d/polygon_input.h"
#include "subdivision/curves/curve_files.h"

namespace isowave::fuzz {
namespace {

void checkCurves(std::string_view bytes, const std::string& extension) {
    using subdivision::CurveFile;
    const CurveFile file = CurveFile::parse(std::string(bytes), extension, "curves");
    require(!file.curves().empty(), "a file without curves was read");
    for (const Polyline& curve : file.curves()) {
        require(curve.coordinates.size() == curve.size() * static_cast<std::size_t>(curve.dimension),
                "a point with too few coordinates");
        for (const double x : curve.coordinates) require(std::isfinite(x), "a coordinate that is not finite");
    }
    const CurveFile again = CurveFile::parse(file.with(file.curves()), extension, "again");
    require(again.curves().size() == file.curves().size(), "curves are lost when they are written");
    for (std::size_t i = 0; i < file.curves().size(); ++i)
        require(again.curves()[i].coordinates == file.curves()[i].coordinates &&
                    again.curves()[i].closed == file.curves()[i].closed,
                "a curve changes when it is written and read again");
}

void checkPolygons(const curves2d::PolygonInput& input) {
    require(input.ringCount() > 0, "polygons without a ring were read");
    for (const auto& polygon : input.polygons)
        for (const auto& ring : polygon.rings) {
            require(ring.size() >= 3, "a ring of fewer than three points");
            for (const auto& p : ring) require(std::isfinite(p.x + p.y), "a point that is not finite");
        }
    for (const std::string& remark : input.remarks) requireOneLine(remark);
}

Answer read(std::string_view bytes, const std::string& extension, bool polygons) {
    const Answer curves = answerOf("curves", [&] { checkCurves(bytes, extension); });
    if (!polygons) return curves;
    const auto path = fileOf(bytes, "polygons" + extension);
    return answerOf(path.string(), [&] { checkPolygons(curves2d::readPolygons(path)); });
}

}  // namespace

std::vector<Target> vectorTargets() {
    return {{"svg", [](std::string_view bytes) { return read(bytes, ".svg", false); }},
            {"geojson", [](std::string_view bytes) { return read(bytes, ".geojson", true); }},
            {"points", [](std::string_view bytes) { return read(bytes, ".txt", true); }}};
}

}  // namespace isowave::fuzz
