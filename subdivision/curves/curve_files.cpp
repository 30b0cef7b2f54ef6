#include "subdivision/curves/curve_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <variant>

#include "io/vector/geojson.h"
#include "io/vector/point_text.h"
#include "io/vector/svg.h"
#include "isowave/error.h"

namespace isowave::subdivision {

struct CurveFile::Source {
    struct Json {
        GeoJson file;
        std::vector<std::string> pointers;  // of the curves
    };
    std::variant<std::monostate, Json, SvgLines> document;  // text: nothing
};

namespace {

// ---- text

[[noreturn]] void throwMixed(const std::string& where, int first, int other) {
    throw InputError(
        where,
        fmt::format("has points with {} and with {} coordinates; give all of them the same", first, other));
}

// Throws InputError unless the row is a point of two or three finite numbers; false: there is nothing in it.
bool isPoint(const PointRow& row, const std::string& where) {
    if (row.kind != PointRow::Kind::point) return false;
    if (!std::all_of(row.values, row.values + row.columns, [](double v) { return std::isfinite(v); }))
        throw InputError(where, "holds a number that is not finite; remove the point");
    if (!row.noNumber.empty())
        throw InputError(
            where, fmt::format("'{}' is not a number; a line holds a point, as '12.5 -3'", row.noNumber));
    if (row.columns > 3) throw InputError(where, "has more than 3 coordinates");
    if (row.columns == 1) throw InputError(where, "has 1 coordinate; a point has 2 or 3");
    return row.columns > 0;
}

std::vector<Polyline> parseText(const std::string& text, const std::string& name) {
    std::vector<Polyline> curves;
    Polyline curve;
    std::string where = name;
    const auto flush = [&] {
        dropClosingCopy(curve);
        if (!curve.coordinates.empty()) curves.push_back(std::move(curve));
        curve = {};
    };
    eachPointRow(text, [&](const PointRow& row) {
        if (row.kind == PointRow::Kind::separator) {
            flush();
            where = fmt::format("{}: curve {}", name, curves.size() + 1);
        } else if (isPoint(row, fmt::format("{}: line {}", name, row.number))) {
            if (curve.coordinates.empty()) curve.dimension = row.columns;
            if (curve.dimension != row.columns) throwMixed(where, curve.dimension, row.columns);
            curve.coordinates.insert(curve.coordinates.end(), row.values, row.values + row.columns);
        }
    });
    flush();
    return curves;
}

// ---- GeoJSON

[[noreturn]] void throwFault(const GeoFault& fault, const std::string& name, int dimension,
                             const char* list) {
    switch (fault.kind) {
        case GeoFault::Kind::notAPosition:
            throw InputError(name + ": " + fault.pointer, "is not a position of 2 or 3 numbers");
        case GeoFault::Kind::notANumber:
            throw InputError(name + ": " + fault.pointer, "is not a number");
        case GeoFault::Kind::otherDimension:
            throwMixed(name + ": " + fault.pointer, dimension, std::stoi(fault.found));
        default:
            throw InputError(name + ": " + fault.pointer, std::string("is not a list of ") + list);
    }
}

void takeCurves(const GeoJson& file, const std::string& name, std::vector<Polyline>& curves,
                std::vector<std::string>& pointers) {
    for (const GeoGeometry& geometry : file.geometries()) {
        if (geometry.fault && geometry.fault->kind != GeoFault::Kind::noList)
            throwFault(*geometry.fault, name, 0, geometry.isPolygon() ? "rings" : "lines");
        for (const GeoLine& line : geometry.lines) {
            if (line.fault) throwFault(*line.fault, name, line.points.dimension, "positions");
            if (line.points.coordinates.empty()) continue;
            curves.push_back(line.points);
            dropClosingCopy(curves.back());
            pointers.push_back(line.pointer);
        }
    }
}

}  // namespace

CurveFile CurveFile::read(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(path.string(), "cannot be opened; is the name right?");
    std::ostringstream text;
    text << stream.rdbuf();
    return parse(text.str(), path.extension().string(), path.string());
}

CurveFile CurveFile::parse(const std::string& text, const std::string& extension, const std::string& name) {
    CurveFile file;
    auto source = std::make_shared<Source>();
    if (extension == ".txt" || extension == ".xy" || extension == ".dat" || extension == ".csv") {
        file.curves_ = parseText(text, name);
    } else if (extension == ".geojson" || extension == ".json") {
        Source::Json json{GeoJson(text, GeoJson::Positions::space, name), {}};
        if (json.file.complaint()) throw InputError(name, *json.file.complaint());
        if (json.file.type() == "Topology")
            throw InputError(
                name,
                "is TopoJSON, which keeps shared borders as arcs; make it GeoJSON first: topo2geo "
                "NAME=out.geojson < in.json (npm topojson-client), or mapshaper in.json -o out.geojson");
        takeCurves(json.file, name, file.curves_, json.pointers);
        source->document = std::move(json);
    } else if (extension == ".svg") {
        SvgLines svg(text, name);
        file.curves_ = svg.lines();
        source->document = std::move(svg);
    } else {
        throw InputError(name,
                         "is of no kind that holds curves; they are .txt .xy .dat .csv .geojson .json .svg");
    }
    if (file.curves_.empty()) throw InputError(name, "holds no curve");
    file.source_ = std::move(source);
    return file;
}

std::string CurveFile::with(const std::vector<Polyline>& points) const {
    if (const auto* svg = std::get_if<SvgLines>(&source_->document)) return svg->with(points);
    if (const auto* json = std::get_if<Source::Json>(&source_->document))
        return json->file.with(json->pointers, points);
    return pointText(points);
}

}  // namespace isowave::subdivision
