#include "curves2d/polygon_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "isowave/error.h"
#include "curves2d/segment_tree.h"

namespace isowave::curves2d {
namespace {

using Json = nlohmann::json;

constexpr double kLargest = 1e9;
// Collections of collections: real files have three or four; each is one call deep in the reader.
constexpr int kDeepestCollection = 100;
// Editors on Windows put it before UTF-8.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

// Takes rings as they come from a file, checks and repairs them.
class Collector {
  public:
    explicit Collector(std::string name) : name_(std::move(name)) {}

    void beginPolygon() { polygon_.rings.clear(); }
    void endPolygon() {
        if (!polygon_.rings.empty()) result_.polygons.push_back(std::move(polygon_));
        polygon_ = {};
    }
    // place: for messages, "polygon 3, ring 0".
    void ring(Ring ring, const std::string& place, bool mustBeClosed) {
        for (std::size_t i = 0; i < ring.size(); ++i)
            if (!(std::abs(ring[i].x) <= kLargest && std::abs(ring[i].y) <= kLargest))
                throw InputError(name_,
                                 fmt::format("{}: point {} is ({}, {}); coordinates up to 1e9 are read. "
                                             "Scale or mend the file",
                                             place, i, ring[i].x, ring[i].y));
        const bool closed = ring.size() > 1 && ring.front() == ring.back();
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
        if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
        if (ring.size() < 3) {
            count(tooShort_, place);
            return;
        }
        if (mustBeClosed && !closed) count(unclosed_, place);
        Point meeting;
        if (selfIntersection(ring, meeting))
            count(crossing_, fmt::format("{} near ({}, {})", place, meeting.x, meeting.y));
        polygon_.rings.push_back(std::move(ring));
    }
    void other(const std::string& type) { count(others_, type); }

    PolygonInput finish() {
        if (result_.polygons.empty())
            throw InputError(name_,
                             tooShort_.number || others_.number
                                 ? "no polygon of three points or more in it"
                                 : "no polygon in it; expected Polygon or MultiPolygon, or lines 'x y'");
        say(unclosed_, "not closed, closed");
        say(tooShort_, "with fewer than three different points, left out");
        say(crossing_, "meeting themselves; inside is what an odd number of turns surrounds");
        if (others_.number)
            result_.remarks.push_back(fmt::format("{} geometries that are no polygons left out (first: {})",
                                                  others_.number, others_.first));
        return std::move(result_);
    }
    const std::string& name() const { return name_; }

  private:
    struct Count {
        std::size_t number = 0;
        std::string first;
    };
    static void count(Count& count, const std::string& place) {
        if (count.number++ == 0) count.first = place;
    }
    void say(const Count& count, const char* what) {
        if (count.number)
            result_.remarks.push_back(fmt::format("{} {} {} (first: {})", count.number,
                                                  count.number == 1 ? "ring" : "rings", what, count.first));
    }

    std::string name_;
    Polygon polygon_;
    PolygonInput result_;
    Count unclosed_, tooShort_, crossing_, others_;
};

// ---- JSON
// -----------------------------------------------------------------------------------------------------

class JsonReader {
  public:
    JsonReader(const Json& root, Collector& out) : root_(root), out_(out) {}

    void read() {
        if (!root_.is_object() || !root_.contains("type"))
            throw InputError(out_.name(), "JSON without a \"type\"; expected GeoJSON or TopoJSON");
        if (root_["type"] == "Topology")
            readTopology();
        else
            readObject(root_);
    }

  private:
    static std::string typeOf(const Json& object) {
        const auto type = object.find("type");
        return type != object.end() && type->is_string() ? type->get<std::string>() : "nothing";
    }

    void readObject(const Json& object, int depth = 0) {
        if (object.is_null()) return;
        if (depth > kDeepestCollection)
            throw InputError(out_.name(),
                             fmt::format("nests collections more than {} deep", kDeepestCollection));
        const std::string type = typeOf(object);
        if (type == "FeatureCollection")
            for (const Json& feature : list(object, "features")) readObject(feature, depth + 1);
        else if (type == "GeometryCollection")
            for (const Json& geometry : list(object, "geometries")) readObject(geometry, depth + 1);
        else if (type == "Feature")
            readObject(object.value("geometry", Json()), depth + 1);
        else if (type == "Polygon")
            readPolygon(list(object, pointsKey()));
        else if (type == "MultiPolygon")
            for (const Json& polygon : list(object, pointsKey())) readPolygon(polygon);
        else
            out_.other(type);
    }

    const char* pointsKey() const { return arcs_.empty() ? "coordinates" : "arcs"; }

    const Json& list(const Json& object, const char* key) const {
        const auto at = object.find(key);
        if (at == object.end() || !at->is_array())
            throw InputError(out_.name(), fmt::format("a {} without a list \"{}\"", typeOf(object), key));
        return *at;
    }

    void readPolygon(const Json& rings) {
        out_.beginPolygon();
        std::size_t r = 0;
        for (const Json& ring : rings) {
            const std::string place = fmt::format("polygon {}, ring {}", polygon_, r++);
            if (!ring.is_array()) throw InputError(out_.name(), place + ": is no list of points");
            out_.ring(arcs_.empty() ? points(ring, place) : stitched(ring, place), place, true);
        }
        out_.endPolygon();
        ++polygon_;
    }

    Ring points(const Json& list, const std::string& place) const {
        Ring ring;
        ring.reserve(list.size());
        for (const Json& p : list) {
            if (!p.is_array() || p.size() < 2 || !p[0].is_number() || !p[1].is_number())
                throw InputError(out_.name(), fmt::format("{}: point {} is {}; expected [x, y]", place,
                                                          ring.size(), p.dump().substr(0, 40)));
            ring.push_back({p[0], p[1]});
        }
        return ring;
    }

    // TopoJSON: arcs of steps in whole units of a grid; a ring is a list of arcs, ~i meaning arc i backwards.
    void readTopology() {
        Point scale{1, 1}, shift{0, 0};
        const bool quantised = root_.contains("transform");
        if (quantised) {
            const Json& transform = root_["transform"];
            const Ring two =
                points(Json::array({list(transform, "scale"), list(transform, "translate")}), "transform");
            scale = two[0];
            shift = two[1];
        }
        for (const Json& arc : list(root_, "arcs")) {
            Ring line = points(arc, fmt::format("arc {}", arcs_.size()));
            Point at{0, 0};
            for (Point& p : line) {
                at = quantised ? at + p : p;
                p = {shift.x + scale.x * at.x, shift.y + scale.y * at.y};
            }
            arcs_.push_back(std::move(line));
        }
        const auto objects = root_.find("objects");
        if (objects == root_.end() || !objects->is_object())
            throw InputError(out_.name(), "a Topology without \"objects\"");
        for (const Json& object : *objects) readObject(object);
    }

    Ring stitched(const Json& numbers, const std::string& place) const {
        Ring ring;
        for (const Json& n : numbers) {
            const std::int64_t number = n.is_number_integer() ? n.get<std::int64_t>() : INT64_MAX;
            // What is beyond 64 bits with a sign is kept without one, and would wrap to an arc that there is.
            const bool wraps = n.is_number_unsigned() && number < 0;
            const std::int64_t index = number < 0 ? ~number : number;
            if (wraps || index >= static_cast<std::int64_t>(arcs_.size()))
                throw InputError(out_.name(), fmt::format("{}: arc {} of {}", place, n.dump(), arcs_.size()));
            const Ring& arc = arcs_[static_cast<std::size_t>(index)];
            if (number < 0)
                ring.insert(ring.end(), arc.rbegin(), arc.rend());
            else
                ring.insert(ring.end(), arc.begin(), arc.end());
        }
        return ring;
    }

    const Json& root_;
    Collector& out_;
    std::vector<Ring> arcs_;
    std::size_t polygon_ = 0;
};

// ---- text
// -----------------------------------------------------------------------------------------------------

bool parsePoint(const std::string& line, Point& point) {
    const char* at = line.data();
    const char* end = at + line.size();
    for (double* value : {&point.x, &point.y}) {
        while (at != end && (std::isspace(static_cast<unsigned char>(*at)) || *at == ',')) ++at;
        if (at != end && *at == '+') ++at;
        const auto [behind, error] = std::from_chars(at, end, *value);
        if (error != std::errc()) return false;
        at = behind;
    }
    return at == end || std::isspace(static_cast<unsigned char>(*at)) || *at == ',';
}

void readText(const std::string& text, Collector& out) {
    out.beginPolygon();
    Ring ring;
    std::size_t number = 0, lineNumber = 0;
    const auto flush = [&] {
        if (!ring.empty()) out.ring(std::move(ring), fmt::format("ring {}", number++), false);
        ring.clear();
    };
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, end - begin);
        begin = end + 1;
        ++lineNumber;
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '>') {
            flush();
        } else if (line[first] != '#') {
            Point p;
            if (!parsePoint(line, p))
                throw InputError(out.name(),
                                 fmt::format("line {}: '{}'; expected two numbers 'x y', '>' or an "
                                             "image",
                                             lineNumber, line.substr(0, 40)));
            ring.push_back(p);
        }
    }
    flush();
    out.endPolygon();
}

int turn(Point a, Point b, Point c) {
    const double area = cross(b - a, c - a);
    return (area > 0) - (area < 0);
}

bool onSegment(Point p, const Segment& s) {
    return turn(s.a, s.b, p) == 0 && std::min(s.a.x, s.b.x) <= p.x && p.x <= std::max(s.a.x, s.b.x) &&
           std::min(s.a.y, s.b.y) <= p.y && p.y <= std::max(s.a.y, s.b.y);
}

bool segmentsMeet(const Segment& s, const Segment& t) {
    const int a = turn(s.a, s.b, t.a), b = turn(s.a, s.b, t.b), c = turn(t.a, t.b, s.a),
              d = turn(t.a, t.b, s.b);
    if (a * b < 0 && c * d < 0) return true;
    return onSegment(t.a, s) || onSegment(t.b, s) || onSegment(s.a, t) || onSegment(s.b, t);
}

}  // namespace

bool selfIntersection(const Ring& ring, Point& place) {
    const std::size_t n = ring.size();
    std::vector<Segment> segments;
    segments.reserve(n);
    for (std::size_t i = 0; i < n; ++i) segments.push_back({ring[i], ring[(i + 1) % n]});
    const SegmentTree tree(segments);
    for (std::size_t i = 0; i < n; ++i) {
        Box box;
        box.take(segments[i].a);
        box.take(segments[i].b);
        bool found = false;
        tree.eachMeeting(box, [&](std::size_t j) {
            if (j <= i) return true;
            const bool next = j == i + 1, previous = i == 0 && j == n - 1;
            if (next || previous) {
                // Neighbours share a point; they meet elsewhere only when one folds back over the other.
                const Segment& first = next ? segments[i] : segments[j];
                const Segment& second = next ? segments[j] : segments[i];
                found =
                    turn(first.a, first.b, second.b) == 0 && dot(first.b - first.a, second.b - second.a) < 0;
            } else {
                found = segmentsMeet(segments[i], segments[j]);
            }
            return !found;
        });
        if (found) {
            place = segments[i].a;
            return true;
        }
    }
    return false;
}

std::size_t PolygonInput::ringCount() const {
    std::size_t count = 0;
    for (const Polygon& polygon : polygons) count += polygon.rings.size();
    return count;
}

std::size_t PolygonInput::pointCount() const {
    std::size_t count = 0;
    for (const Polygon& polygon : polygons)
        for (const Ring& ring : polygon.rings) count += ring.size();
    return count;
}

PolygonInput readPolygons(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::ifstream stream(path, std::ios::binary);
    if (!stream || std::filesystem::is_directory(path)) throw InputError(name, "cannot be read");
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) throw InputError(name, "is empty; expected polygons");
    Collector out(name);
    if (text[first] == '{' || text[first] == '[') {
        Json json;
        try {
            json = Json::parse(text);
        } catch (const Json::exception& error) {
            std::string what = error.what();
            std::replace(what.begin(), what.end(), '\n', ' ');
            throw InputError(name, "is no JSON, or truncated: " + what);
        }
        JsonReader(json, out).read();
    } else {
        readText(text, out);
    }
    return out.finish();
}

bool looksLikePolygons(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* known : {".geojson", ".json", ".topojson", ".txt", ".gmt", ".xy"})
        if (extension == known) return true;
    return false;
}

}  // namespace isowave::curves2d
