#include "subdivision/curves/curve_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "isowave/error.h"

namespace isowave::subdivision {

struct CurveFile::Source {
    std::string extension;
    // text: nothing. GeoJSON: the document and where each curve is in it.
    nlohmann::ordered_json document;
    std::vector<nlohmann::ordered_json::json_pointer> pointers;
    // SVG: the text, and the attribute values (begin, end) with the curves [first, last) that each holds.
    std::string text;
    struct Attribute {
        std::size_t begin, end, first, last;
        bool isPath;
    };
    std::vector<Attribute> attributes;
};

namespace {

using Json = nlohmann::ordered_json;

// Points of one curve as they come in; the closing copy of the first point is taken away at the end.
class Collector {
  public:
    explicit Collector(std::string where) : where_(std::move(where)) {}

    void add(const double* point, int dimension) {
        if (curve_.coordinates.empty()) curve_.dimension = dimension;
        if (dimension != curve_.dimension) {
            throw InputError(
                where_, fmt::format("has points with {} and with {} coordinates; give all of them the same",
                                    curve_.dimension, dimension));
        }
        curve_.coordinates.insert(curve_.coordinates.end(), point, point + dimension);
    }
    void add(double x, double y) {
        const double point[2] = {x, y};
        add(point, 2);
    }
    bool empty() const { return curve_.coordinates.empty(); }

    Polyline finish(bool closed) {
        auto& c = curve_.coordinates;
        const auto d = static_cast<std::size_t>(curve_.dimension);
        if (c.size() >= 3 * d &&
            std::equal(c.begin(), c.begin() + curve_.dimension, c.end() - curve_.dimension)) {
            c.resize(c.size() - d);
            closed = true;
        }
        curve_.closed = closed;
        Polyline result = std::move(curve_);
        curve_ = {};
        return result;
    }

  private:
    std::string where_;
    Polyline curve_;
};

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// --- text
// ---------------------------------------------------------------------------------------------------

std::vector<Polyline> parseText(const std::string& text, const std::string& name) {
    std::vector<Polyline> curves;
    Collector collector(name);
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // editors on Windows put it before UTF-8
    std::istringstream lines(text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        line = line.substr(0, line.find('#'));
        if (!line.empty() && line[0] == '>') {
            if (!collector.empty()) curves.push_back(collector.finish(false));
            collector = Collector(fmt::format("{}: curve {}", name, curves.size() + 1));
            continue;
        }
        double point[3];
        int count = 0;
        const char* at = line.c_str();
        while (true) {
            while (*at && isSpace(*at)) ++at;
            if (!*at) break;
            char* end = nullptr;
            const double value = std::strtod(at, &end);
            if (end == at || (*end && !isSpace(*end))) {
                throw InputError(fmt::format("{}: line {}", name, number),
                                 fmt::format("'{}' is not a number; a line holds a point, as '12.5 -3'", at));
            }
            if (!std::isfinite(value)) {
                throw InputError(fmt::format("{}: line {}", name, number),
                                 "holds a number that is not finite; remove the point");
            }
            if (count == 3)
                throw InputError(fmt::format("{}: line {}", name, number), "has more than 3 coordinates");
            point[count++] = value;
            at = end;
        }
        if (count == 0) continue;
        if (count == 1)
            throw InputError(fmt::format("{}: line {}", name, number),
                             "has 1 coordinate; a point has 2 or 3");
        collector.add(point, count);
    }
    if (!collector.empty()) curves.push_back(collector.finish(false));
    return curves;
}

std::string writeText(const std::vector<Polyline>& curves) {
    std::string text;
    for (const auto& curve : curves) {
        if (curves.size() > 1) text += ">\n";
        const auto d = static_cast<std::size_t>(curve.dimension);
        for (std::size_t k = 0; k < curve.size() + (curve.closed ? 1 : 0); ++k) {
            const double* point = curve.coordinates.data() + (k % curve.size()) * d;
            for (std::size_t c = 0; c < d; ++c) text += fmt::format("{}{}", c ? " " : "", point[c]);
            text += "\n";
        }
    }
    return text;
}

// --- GeoJSON
// ------------------------------------------------------------------------------------------------

// Collections of collections: real files have three or four; each is one call deep in the reader.
constexpr int kDeepestCollection = 100;

struct GeoJsonReader {
    const std::string& name;
    std::vector<Polyline>& curves;
    std::vector<Json::json_pointer>& pointers;

    void curve(const Json& points, const Json::json_pointer& where, bool ring) {
        const std::string place = name + ": " + where.to_string();
        Collector collector(place);
        if (!points.is_array()) throw InputError(place, "is not a list of positions");
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Json& position = points[k];
            if (!position.is_array() || position.size() < 2 || position.size() > 3) {
                throw InputError(fmt::format("{}/{}", place, k), "is not a position of 2 or 3 numbers");
            }
            double point[3];
            for (std::size_t c = 0; c < position.size(); ++c) {
                if (!position[c].is_number())
                    throw InputError(fmt::format("{}/{}/{}", place, k, c), "is not a number");
                point[c] = position[c].get<double>();
            }
            collector.add(point, static_cast<int>(position.size()));
        }
        if (collector.empty()) return;
        curves.push_back(collector.finish(ring));
        pointers.push_back(where);
    }

    void list(const Json& coordinates, const Json::json_pointer& where, int depth, bool ring) {
        if (depth == 0) return curve(coordinates, where, ring);
        if (!coordinates.is_array() && !coordinates.is_null()) {
            throw InputError(name + ": " + where.to_string(),
                             ring ? "is not a list of rings" : "is not a list of lines");
        }
        for (std::size_t k = 0; k < coordinates.size(); ++k) list(coordinates[k], where / k, depth - 1, ring);
    }

    void object(const Json& value, const Json::json_pointer& where, int depth = 0) {
        if (depth > kDeepestCollection)
            throw InputError(name, fmt::format("nests collections more than {} deep", kDeepestCollection));
        if (!value.is_object() || !value.contains("type") || !value["type"].is_string()) return;
        const std::string type = value["type"];
        for (const char* part : {"features", "geometries"}) {
            if (!value.contains(part) || !value[part].is_array()) continue;
            for (std::size_t k = 0; k < value[part].size(); ++k)
                object(value[part][k], where / part / k, depth + 1);
        }
        if (value.contains("geometry")) object(value["geometry"], where / "geometry", depth + 1);
        if (!value.contains("coordinates")) return;
        const auto coordinates = where / "coordinates";
        if (type == "LineString") list(value["coordinates"], coordinates, 0, false);
        if (type == "MultiLineString") list(value["coordinates"], coordinates, 1, false);
        if (type == "Polygon") list(value["coordinates"], coordinates, 1, true);
        if (type == "MultiPolygon") list(value["coordinates"], coordinates, 2, true);
    }
};

Json toJson(const Polyline& curve) {
    Json points = Json::array();
    const auto d = static_cast<std::size_t>(curve.dimension);
    for (std::size_t k = 0; k < curve.size() + (curve.closed ? 1 : 0); ++k) {
        const auto first = curve.coordinates.begin() + static_cast<std::ptrdiff_t>((k % curve.size()) * d);
        points.push_back(std::vector<double>(first, first + curve.dimension));
    }
    return points;
}

// --- SVG
// ----------------------------------------------------------------------------------------------------

// Numbers and commands of a path's d, or of points.
struct PathReader {
    const std::string& text;
    std::size_t at, end;
    std::string where;

    void skip() {
        while (at < end && isSpace(text[at])) ++at;
    }
    bool hasNumber() {
        skip();
        return at < end && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '-' ||
                            text[at] == '+' || text[at] == '.');
    }
    double number() {
        skip();
        char* after = nullptr;
        const double value = std::strtod(text.c_str() + at, &after);
        const auto next = static_cast<std::size_t>(after - text.c_str());
        if (next == at || next > end || !std::isfinite(value)) {
            throw InputError(where, fmt::format("has no number at '{}'",
                                                text.substr(at, std::min<std::size_t>(12, end - at))));
        }
        at = next;
        return value;
    }
};

std::vector<Polyline> parsePath(PathReader in) {
    std::vector<Polyline> curves;
    Collector collector(in.where);
    double x = 0, y = 0, startX = 0, startY = 0;
    const auto flush = [&](bool closed) {
        if (!collector.empty()) curves.push_back(collector.finish(closed));
    };
    char command = 0;
    while (true) {
        in.skip();
        if (in.at >= in.end) break;
        if (!in.hasNumber()) {
            command = in.text[in.at++];
        } else if (command == 0 || command == 'Z' || command == 'z') {
            throw InputError(in.where, "has numbers without a command before them");
        }
        const bool relative = command >= 'a';
        switch (command) {
            case 'Z':
            case 'z':
                flush(true);
                x = startX;
                y = startY;
                continue;
            case 'H':
            case 'h':
                x = in.number() + (relative ? x : 0);
                break;
            case 'V':
            case 'v':
                y = in.number() + (relative ? y : 0);
                break;
            case 'M':
            case 'm':
            case 'L':
            case 'l': {
                const double u = in.number(), v = in.number();
                x = u + (relative ? x : 0);
                y = v + (relative ? y : 0);
                break;
            }
            default:
                throw InputError(
                    in.where, fmt::format("has the command '{}'; only straight pieces (M L H V Z) are read: "
                                          "flatten curves first (Inkscape: Flatten Beziers)",
                                          command));
        }
        if (command == 'M' || command == 'm') {
            flush(false);
            startX = x;
            startY = y;
            command = command == 'M' ? 'L' : 'l';  // more pairs are lines
        } else if (collector.empty()) {
            collector.add(startX, startY);  // goes on after a Z
        }
        collector.add(x, y);
    }
    flush(false);
    return curves;
}

std::vector<Polyline> parsePoints(PathReader in, bool closed) {
    Collector collector(in.where);
    while (in.hasNumber()) {
        const double x = in.number();
        collector.add(x, in.number());
    }
    in.skip();
    if (in.at < in.end) throw InputError(in.where, fmt::format("has '{}' among its points", in.text[in.at]));
    if (collector.empty()) return {};
    return {collector.finish(closed)};
}

std::string writePath(const std::vector<Polyline>& curves, std::size_t first, std::size_t last, bool isPath) {
    std::string text;
    for (std::size_t k = first; k < last; ++k) {
        const Polyline& curve = curves[k];
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const double x = curve.coordinates[2 * i], y = curve.coordinates[2 * i + 1];
            const char* before = !isPath ? (i ? " " : "") : i == 0 ? "M" : i == 1 ? "L" : " ";
            text += fmt::format("{}{},{}", before, x, y);
        }
        if (isPath && curve.closed) text += "Z";
    }
    return text;
}

// The value of an attribute of the tag [begin, end), or nothing. The name must stand alone: id="d" is not d.
bool findAttribute(const std::string& text, std::size_t begin, std::size_t end, const std::string& attribute,
                   std::size_t& valueBegin, std::size_t& valueEnd) {
    char quote = 0;
    for (std::size_t at = begin; at < end; ++at) {
        if (quote) {
            if (text[at] == quote) quote = 0;
            continue;
        }
        if (text[at] == '"' || text[at] == '\'') {
            quote = text[at];
            continue;
        }
        if (!std::isspace(static_cast<unsigned char>(text[at]))) continue;
        if (text.compare(at + 1, attribute.size(), attribute) != 0) continue;
        std::size_t next = at + 1 + attribute.size();
        while (next < end && std::isspace(static_cast<unsigned char>(text[next]))) ++next;
        if (next >= end || text[next] != '=') continue;
        ++next;
        while (next < end && std::isspace(static_cast<unsigned char>(text[next]))) ++next;
        if (next >= end || (text[next] != '"' && text[next] != '\'')) continue;
        const std::size_t close = text.find(text[next], next + 1);
        if (close == std::string::npos || close > end) continue;
        valueBegin = next + 1;
        valueEnd = close;
        return true;
    }
    return false;
}

// A tag's end: the '>' outside quotes.
std::size_t tagEnd(const std::string& text, std::size_t at) {
    char quote = 0;
    for (; at < text.size(); ++at) {
        if (quote) {
            if (text[at] == quote) quote = 0;
        } else if (text[at] == '"' || text[at] == '\'') {
            quote = text[at];
        } else if (text[at] == '>') {
            return at;
        }
    }
    return std::string::npos;
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
    source->extension = extension;
    if (extension == ".txt" || extension == ".xy" || extension == ".dat" || extension == ".csv") {
        file.curves_ = parseText(text, name);
    } else if (extension == ".geojson" || extension == ".json") {
        try {
            source->document = Json::parse(text);
        } catch (const nlohmann::json::exception& error) {
            throw InputError(name, std::string("is not JSON: ") + error.what());
        }
        GeoJsonReader{name, file.curves_, source->pointers}.object(source->document, Json::json_pointer());
    } else if (extension == ".svg") {
        source->text = text;
        int count = 0;
        for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
            if (text.compare(at, 4, "<!--") == 0) {
                at = text.find("-->", at);
                if (at == std::string::npos) break;
                continue;
            }
            const auto is = [&](const char* tag) {
                const std::size_t length = std::char_traits<char>::length(tag);
                return text.compare(at + 1, length, tag) == 0 && at + 1 + length < text.size() &&
                       (std::isspace(static_cast<unsigned char>(text[at + 1 + length])) ||
                        text[at + 1 + length] == '/');
            };
            const bool path = is("path"), polyline = is("polyline"), polygon = is("polygon");
            if (!path && !polyline && !polygon) continue;
            const std::size_t end = tagEnd(text, at);
            if (end == std::string::npos) throw InputError(name, "ends inside a tag; it is truncated");
            ++count;
            std::size_t valueBegin = 0, valueEnd = 0;
            if (!findAttribute(text, at, end, path ? "d" : "points", valueBegin, valueEnd)) continue;
            const PathReader in{text, valueBegin, valueEnd,
                                fmt::format("{}: {} {}", name,
                                            path      ? "path"
                                            : polygon ? "polygon"
                                                      : "polyline",
                                            count)};
            const auto found = path ? parsePath(in) : parsePoints(in, polygon);
            source->attributes.push_back(
                {valueBegin, valueEnd, file.curves_.size(), file.curves_.size() + found.size(), path});
            file.curves_.insert(file.curves_.end(), found.begin(), found.end());
        }
    } else {
        throw InputError(name,
                         "is of no kind that holds curves; they are .txt .xy .dat .csv .geojson .json .svg");
    }
    if (file.curves_.empty()) throw InputError(name, "holds no curve");
    file.source_ = std::move(source);
    return file;
}

std::string CurveFile::with(const std::vector<Polyline>& points) const {
    assert(points.size() == curves_.size());
    if (!source_->text.empty()) {
        std::string result;
        std::size_t at = 0;
        for (const auto& attribute : source_->attributes) {
            result += source_->text.substr(at, attribute.begin - at);
            result += writePath(points, attribute.first, attribute.last, attribute.isPath);
            at = attribute.end;
        }
        return result + source_->text.substr(at);
    }
    if (!source_->document.is_null()) {
        Json document = source_->document;
        for (std::size_t k = 0; k < points.size(); ++k) document[source_->pointers[k]] = toJson(points[k]);
        return document.dump() + "\n";
    }
    return writeText(points);
}

}  // namespace isowave::subdivision
