#include "io/vector/geojson.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// Collections of collections: real files have three or four; each is one call deep in the reader.
constexpr int kDeepestCollection = 100;

std::string typeOf(const Json& object) {
    const auto type = object.find("type");
    return type != object.end() && type->is_string() ? type->get<std::string>() : "nothing";
}

GeoFault faultAt(GeoFault::Kind kind, const Pointer& where, const Json& found, std::size_t vertex = 0) {
    return {kind, where.to_string(), found.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40),
            vertex};
}

class Reader {
  public:
    Reader(GeoJson::Positions positions, const std::string& name, std::vector<GeoGeometry>& out)
        : positions_(positions), name_(name), out_(out) {}

    void readObject(const Json& object, const Pointer& where, int depth = 0) {
        if (object.is_null()) return;
        if (depth > kDeepestCollection)
            throw InputError(name_, fmt::format("nests collections more than {} deep", kDeepestCollection));
        const std::string type = typeOf(object);
        if (type == "FeatureCollection") {
            readMembers(object, "features", where, depth);
        } else if (type == "GeometryCollection") {
            readMembers(object, "geometries", where, depth);
        } else if (type == "Feature") {
            if (object.contains("geometry")) readObject(object["geometry"], where / "geometry", depth + 1);
        } else {
            readGeometry(object, where, type);
        }
    }

    // Arcs are steps in whole units of a grid; a ring is a list of arcs, ~i meaning arc i backwards.
    void readTopology(const Json& root) {
        std::array<double, 2> scale{1, 1}, shift{0, 0};
        const bool quantised = root.contains("transform");
        if (quantised) {
            const Json& transform = root["transform"];
            scale = pair(list(transform, "scale"), "transform", 0);
            shift = pair(list(transform, "translate"), "transform", 1);
        }
        for (const Json& arc : list(root, "arcs")) {
            const std::string place = fmt::format("arc {}", arcs_.size());
            std::vector<double> line;
            std::array<double, 2> at{0, 0};
            for (const Json& position : arc) {
                const auto step = pair(position, place, line.size() / 2);
                for (std::size_t c = 0; c < 2; ++c) {
                    at[c] = quantised ? at[c] + step[c] : step[c];
                    line.push_back(shift[c] + scale[c] * at[c]);
                }
            }
            arcs_.push_back(std::move(line));
        }
        const auto objects = root.find("objects");
        if (objects == root.end() || !objects->is_object())
            throw InputError(name_, "a Topology without \"objects\"");
        std::map<std::string, const Json*> byName;
        for (const auto& [key, object] : objects->items()) byName.emplace(key, &object);
        for (const auto& [key, object] : byName) readObject(*object, Pointer("/objects") / key);
    }

  private:
    // ---- GeoJSON

    GeoGeometry& add(const std::string& type, const Pointer& where) {
        out_.push_back({type, where.to_string(), {}, {}});
        return out_.back();
    }

    void readMembers(const Json& object, const char* key, const Pointer& where, int depth) {
        const auto members = object.find(key);
        if (members == object.end() || !members->is_array()) {
            add(typeOf(object), where).fault = {GeoFault::Kind::noList, (where / key).to_string(), key};
            return;
        }
        for (std::size_t k = 0; k < members->size(); ++k)
            readObject((*members)[k], where / key / k, depth + 1);
    }

    const char* pointsKey() const { return arcs_.empty() ? "coordinates" : "arcs"; }

    // A geometry's list holds positions, or lines of them, or polygons of lines.
    void readGeometry(const Json& object, const Pointer& where, const std::string& type) {
        static const std::map<std::string, int> nesting = {
            {"LineString", 0}, {"MultiLineString", 1}, {"Polygon", 1}, {"MultiPolygon", 2}};
        const auto known = nesting.find(type);
        if (known == nesting.end()) {
            add(type, where);
            return;
        }
        const Pointer place = where / pointsKey();
        const auto list = object.find(pointsKey());
        if (list == object.end() || list->is_null())
            add(type, where).fault = {GeoFault::Kind::noList, place.to_string(), pointsKey()};
        else if (known->second == 0)
            addLine(add(type, where), *list, place);
        else if (known->second == 1)
            addLines(add(type, where), *list, place);
        else if (!list->is_array())
            add(type, where).fault = faultAt(GeoFault::Kind::notAList, place, *list);
        else
            for (std::size_t k = 0; k < list->size(); ++k) addLines(add(type, where), (*list)[k], place / k);
    }

    void addLines(GeoGeometry& geometry, const Json& lines, const Pointer& where) {
        if (lines.is_null()) return;
        if (!lines.is_array()) {
            geometry.fault = faultAt(GeoFault::Kind::notAList, where, lines);
            return;
        }
        for (std::size_t k = 0; k < lines.size(); ++k) addLine(geometry, lines[k], where / k);
    }

    void addLine(GeoGeometry& geometry, const Json& list, const Pointer& where) {
        GeoLine line;
        line.pointer = where.to_string();
        line.points.closed = geometry.isPolygon();
        if (!list.is_array())
            line.fault = faultAt(GeoFault::Kind::notAList, where, list);
        else if (arcs_.empty())
            addPositions(line, list, where);
        else
            addArcs(line, list, where);
        geometry.lines.push_back(std::move(line));
    }

    void addPositions(GeoLine& line, const Json& list, const Pointer& where) const {
        auto& coordinates = line.points.coordinates;
        coordinates.reserve(2 * list.size());
        for (std::size_t k = 0; k < list.size() && !line.fault; ++k) {
            line.fault = faultOf(list[k], where, k);
            if (line.fault) return;
            const int count = positions_ == GeoJson::Positions::plane ? 2 : static_cast<int>(list[k].size());
            if (coordinates.empty()) line.points.dimension = count;
            if (count != line.points.dimension) {
                line.fault = {GeoFault::Kind::otherDimension, where.to_string(), std::to_string(count), k};
                return;
            }
            for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
                coordinates.push_back(list[k][c].get<double>());
        }
    }

    std::optional<GeoFault> faultOf(const Json& position, const Pointer& where, std::size_t k) const {
        const bool plane = positions_ == GeoJson::Positions::plane;
        if (!position.is_array() || position.size() < 2 || (!plane && position.size() > 3))
            return faultAt(GeoFault::Kind::notAPosition, where / k, position, k);
        for (std::size_t c = 0; c < (plane ? 2 : position.size()); ++c)
            if (!position[c].is_number())
                return faultAt(GeoFault::Kind::notANumber, where / k / c, plane ? position : position[c], k);
        return {};
    }

    // ---- TopoJSON

    void addArcs(GeoLine& line, const Json& numbers, const Pointer& where) const {
        for (const Json& n : numbers) {
            const std::int64_t number = n.is_number_integer() ? n.get<std::int64_t>() : INT64_MAX;
            // What is beyond 64 bits with a sign is kept without one, and would wrap to an arc that there is.
            const bool wraps = n.is_number_unsigned() && number < 0;
            const std::int64_t index = number < 0 ? ~number : number;
            if (wraps || index >= static_cast<std::int64_t>(arcs_.size())) {
                line.fault = {GeoFault::Kind::noArc, where.to_string(),
                              fmt::format("arc {} of {}", n.dump(), arcs_.size())};
                return;
            }
            const std::vector<double>& arc = arcs_[static_cast<std::size_t>(index)];
            auto& to = line.points.coordinates;
            if (number >= 0) to.insert(to.end(), arc.begin(), arc.end());
            for (std::size_t k = arc.size(); number < 0 && k > 0; k -= 2)
                to.insert(to.end(), {arc[k - 2], arc[k - 1]});
        }
    }

    const Json& list(const Json& object, const char* key) const {
        const auto at = object.find(key);
        if (at == object.end() || !at->is_array())
            throw InputError(name_, fmt::format("a {} without a list \"{}\"", typeOf(object), key));
        return *at;
    }

    std::array<double, 2> pair(const Json& p, const std::string& place, std::size_t number) const {
        if (!p.is_array() || p.size() < 2 || !p[0].is_number() || !p[1].is_number())
            throw InputError(name_, fmt::format("{}: point {} is {}; expected [x, y]", place, number,
                                                p.dump().substr(0, 40)));
        return {p[0], p[1]};
    }

    GeoJson::Positions positions_;
    const std::string& name_;
    std::vector<GeoGeometry>& out_;
    std::vector<std::vector<double>> arcs_;
};

Json toJson(const Polyline& line) {
    Json points = Json::array();
    const auto d = static_cast<std::ptrdiff_t>(line.dimension);
    for (std::size_t k = 0; k < line.size() + (line.closed ? 1 : 0); ++k) {
        const auto first = line.coordinates.begin() + static_cast<std::ptrdiff_t>(k % line.size()) * d;
        points.push_back(std::vector<double>(first, first + d));
    }
    return points;
}

// "line 3, column 14"
std::string placeOf(std::string_view text, std::size_t at) {
    const std::string_view before = text.substr(0, at);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t lineStart = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
    return fmt::format("line {}, column {}", line, at - lineStart + 1);
}

// error: of a number beyond double, which it quotes.
std::string complaintOfNumber(std::string_view text, std::string_view error) {
    constexpr std::size_t kShown = 40;
    const std::size_t open = error.find('\''), close = error.rfind('\'');
    if (open == error.npos || close <= open) return "has a number that is too large; it is damaged";
    const std::string_view number = error.substr(open + 1, close - open - 1);
    return fmt::format("{}: the number {} is too large; expected at most 1.8e308; it is damaged",
                       placeOf(text, std::min(text.find(number), text.size())), number.substr(0, kShown));
}

// byte: counted from 1, the last one read; beyond the end where more was expected.
std::string complaintAt(std::string_view text, std::size_t byte) {
    const std::size_t at = std::min(byte == 0 ? 0 : byte - 1, text.size());
    const std::string_view before = text.substr(0, at);
    if (at >= text.size())
        return fmt::format("ends in line {} (byte {}), before its brackets are closed; it is truncated",
                           1 + std::count(before.begin(), before.end(), '\n'), text.size());
    std::string found(text.substr(at, 20));
    for (char& c : found)
        if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
    return fmt::format("{}: found '{}', where JSON expects something else; it is damaged or no JSON",
                       placeOf(text, at), found);
}

}  // namespace

struct GeoJson::Document {
    Json root;
};

GeoJson::GeoJson(const std::string& text, Positions positions, const std::string& name) {
    auto document = std::make_shared<Document>();
    Json& root = document->root;
    try {
        root = Json::parse(withoutByteOrderMark(text));
    } catch (const nlohmann::json::parse_error& error) {
        complaint_ = complaintAt(withoutByteOrderMark(text), error.byte);
        return;
    } catch (const nlohmann::json::exception& error) {  // a number beyond double
        complaint_ = complaintOfNumber(withoutByteOrderMark(text), error.what());
        return;
    }
    if (root.is_object() && root.contains("type")) type_ = typeOf(root);
    Reader reader(positions, name, geometries_);
    if (type_ != "Topology")
        reader.readObject(root, Pointer());
    else if (positions == Positions::plane)
        reader.readTopology(root);
    document_ = std::move(document);
}

std::string GeoJson::with(const std::vector<std::string>& pointers,
                          const std::vector<Polyline>& lines) const {
    assert(pointers.size() == lines.size());
    Json root = document_->root;
    for (std::size_t k = 0; k < lines.size(); ++k) root[Pointer(pointers[k])] = toJson(lines[k]);
    return root.dump() + "\n";
}

}  // namespace isowave
