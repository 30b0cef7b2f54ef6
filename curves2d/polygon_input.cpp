#include "curves2d/polygon_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>

#include "base/number_text.h"
#include "base/text.h"
#include "curves2d/segment_tree.h"
#include "io/vector/geojson.h"
#include "io/vector/point_text.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

constexpr double kLargest = 1e9;
constexpr std::size_t kShown = 40;  // bytes of a piece of the file in a remark

bool isInside(Point p, const Ring& ring) {
    bool inside = false;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        if ((ring[i].y > p.y) != (ring[j].y > p.y) &&
            p.x < ring[j].x + (p.y - ring[j].y) * (ring[i].x - ring[j].x) / (ring[i].y - ring[j].y))
            inside = !inside;
    return inside;
}

// By some of its points, and the middles between them: those on the shell itself may be either.
bool liesOutside(const Ring& hole, const Ring& shell) {
    constexpr std::size_t kTried = 16;
    for (std::size_t i = 0; i < std::min(hole.size(), kTried); ++i)
        if (isInside(hole[i], shell) || isInside(0.5 * (hole[i] + hole[(i + 1) % hole.size()]), shell))
            return false;
    return true;
}

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
        if (mustBeClosed && !polygon_.rings.empty() && liesOutside(ring, polygon_.rings.front()))
            count(outside_, place);
        polygon_.rings.push_back(std::move(ring));
    }
    void other(const std::string& type) { count(others_, type); }
    void aroundPole(const std::string& place) { count(polar_, place); }

    PolygonInput finish() {
        if (result_.polygons.empty())
            throw InputError(
                name_,
                others_.number
                    ? fmt::format("no polygon of three points or more in it; of other kinds: {} (first: "
                                  "{}); expected Polygon or MultiPolygon; isowave curve-levels reads lines",
                                  others_.number, messageOf(others_.first.substr(0, kShown)))
                : tooShort_.number ? std::string("no polygon of three points or more in it")
                                   : "no polygon in it; expected Polygon or MultiPolygon, or lines 'x y'");
        say(unclosed_, "not closed, closed");
        say(tooShort_, "with fewer than three different points, left out");
        say(polar_, "around a pole, completed along the border of the map");
        say(crossing_, crossing_.number == 1
                           ? "meeting itself; inside is what an odd number of turns surrounds"
                           : "meeting themselves; inside is what an odd number of turns surrounds");
        say(outside_, outside_.number == 1 ? "is a hole outside of its polygon and adds to it"
                                           : "are holes outside of their polygons and add to them");
        if (others_.number)
            result_.remarks.push_back(
                fmt::format("{} left out (first: {})",
                            counted(static_cast<std::int64_t>(others_.number), "geometry that is no polygon",
                                    "geometries that are no polygons"),
                            messageOf(others_.first.substr(0, kShown))));
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
    Count unclosed_, tooShort_, polar_, crossing_, outside_, others_;
};

// ---- JSON

Ring ringOf(const Polyline& line) {
    Ring ring;
    ring.reserve(line.size());
    for (std::size_t k = 0; k + 1 < line.coordinates.size(); k += 2)
        ring.push_back({line.coordinates[k], line.coordinates[k + 1]});
    return ring;
}

void refuseFault(const GeoFault& fault, const std::string& ring, const std::string& name) {
    if (fault.kind == GeoFault::Kind::notAList) throw InputError(name, ring + ": is no list of points");
    if (fault.kind == GeoFault::Kind::noArc) throw InputError(name, ring + ": " + fault.found);
    throw InputError(name,
                     fmt::format("{}: point {} is {}; expected [x, y]", ring, fault.vertex, fault.found));
}

// A geometry that has not the list that its type promises, or, of several polygons, one that is none.
void refuseFault(const GeoGeometry& geometry, std::size_t polygon, const std::string& name) {
    const std::string last = geometry.fault->pointer.substr(geometry.fault->pointer.rfind('/') + 1);
    if (std::isdigit(static_cast<unsigned char>(last[0])))
        refuseFault(*geometry.fault, fmt::format("polygon {}, ring 0", polygon), name);
    throw InputError(name, fmt::format("a {} without a list \"{}\"", geometry.type, last));
}

// Degrees of longitude, as GeoJSON has them: an edge between two points near the 180th meridian, on either side of it, is one
// across it. As it stands it would run around the world.
std::vector<std::size_t> edgesAcrossAntimeridian(const Ring& ring) {
    constexpr double kNear = 150;
    const auto isDegrees = [](Point p) { return std::abs(p.x) <= 180 && std::abs(p.y) <= 90; };
    const auto isAcross = [](Point a, Point b) {
        const bool isCut = std::abs(a.x) == 180 && std::abs(b.x) == 180;
        return !isCut && a.x * b.x < 0 && std::min(std::abs(a.x), std::abs(b.x)) > kNear;
    };
    std::vector<std::size_t> found;
    if (!std::all_of(ring.begin(), ring.end(), isDegrees)) return found;
    for (std::size_t i = 0; i < ring.size(); ++i)
        if (isAcross(ring[i], ring[(i + 1) % ring.size()])) found.push_back(i);
    return found;
}

// A ring whose only edge across is edge i goes round a pole, as Antarctica does in many maps of the world. On the plane it
// is completed along the border of the map: to the pole on the side of the edge's start, and back on the other side.
void completeAroundPole(Ring& ring, std::size_t i) {
    const Point a = ring[i], b = ring[(i + 1) % ring.size()];
    const double side = std::copysign(180, a.x), pole = std::copysign(90, a.y);
    const double before = 180 - std::abs(a.x), after = 180 - std::abs(b.x);
    const double y = std::lerp(a.y, b.y, before / (before + after));
    const Point border[] = {{side, y}, {side, pole}, {-side, pole}, {-side, y}};
    ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i + 1), std::begin(border), std::end(border));
}

// Returns whether the ring was completed around a pole. Throws InputError for any other that runs across.
bool mendAntimeridian(Ring& ring, const std::string& place, const std::string& name) {
    constexpr double kPolar =
        60;  // nearer to the equator an edge across is more likely one of a shape that is not cut
    const std::vector<std::size_t> across = edgesAcrossAntimeridian(ring);
    if (across.empty()) return false;
    const std::size_t i = across[0], next = (i + 1) % ring.size();
    const Point a = ring[i], b = ring[next];
    if (across.size() > 1 || a.y * b.y < 0 || std::min(std::abs(a.y), std::abs(b.y)) < kPolar)
        throw InputError(
            name, fmt::format("{}: crosses the antimeridian between points {} ({}, {}) and {} ({}, {}); "
                              "RFC 7946, 3.1.9 wants it cut there: ogr2ogr -wrapdateline does so",
                              place, i, a.x, a.y, next, b.x, b.y));
    completeAroundPole(ring, i);
    return true;
}

void readJson(const GeoJson& file, Collector& out) {
    if (file.complaint()) throw InputError(out.name(), *file.complaint());
    if (!file.type()) throw InputError(out.name(), "JSON without a \"type\"; expected GeoJSON or TopoJSON");
    std::size_t polygon = 0;
    for (const GeoGeometry& geometry : file.geometries()) {
        const bool isCollection = geometry.type.ends_with("Collection");
        if (geometry.fault && (geometry.isPolygon() || isCollection))
            refuseFault(geometry, polygon, out.name());
        if (!geometry.isPolygon()) {
            out.other(geometry.type);
            continue;
        }
        out.beginPolygon();
        for (std::size_t r = 0; r < geometry.lines.size(); ++r) {
            const GeoLine& line = geometry.lines[r];
            const std::string place = fmt::format("polygon {}, ring {}", polygon, r);
            if (line.fault) refuseFault(*line.fault, place, out.name());
            Ring ring = ringOf(line.points);
            if (mendAntimeridian(ring, place, out.name())) out.aroundPole(place);
            out.ring(std::move(ring), place, true);
        }
        out.endPolygon();
        ++polygon;
    }
}

// ---- text

void readText(const std::string& text, Collector& out) {
    out.beginPolygon();
    Ring ring;
    std::size_t number = 0;
    const auto flush = [&] {
        if (!ring.empty()) out.ring(std::move(ring), fmt::format("ring {}", number++), false);
        ring.clear();
    };
    eachPointRow(text, [&](const PointRow& row) {
        if (row.kind == PointRow::Kind::separator || row.kind == PointRow::Kind::blank) flush();
        if (row.kind != PointRow::Kind::point) return;
        if (row.columns < 2)
            throw InputError(out.name(),
                             fmt::format("line {}: '{}'; expected two numbers 'x y' or '>' "
                                         "(GeoJSON begins with a bracket; an image has other bytes)",
                                         row.number, row.text.substr(0, 40)));
        ring.push_back({row.values[0], row.values[1]});
    });
    flush();
    out.endPolygon();
}

// ---- where a ring meets itself

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

// A point that both have, of segments that meet.
Point meeting(const Segment& s, const Segment& t) {
    const Point along = s.b - s.a, other = t.b - t.a;
    const double across = cross(along, other);
    if (across != 0) return s.a + (cross(t.a - s.a, other) / across) * along;
    for (const Point p : {t.a, t.b})
        if (onSegment(p, s)) return p;
    return onSegment(s.a, t) ? s.a : s.b;
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
        std::size_t other = i;
        tree.eachMeeting(box, [&](std::size_t j) {
            if (j <= i) return true;
            other = j;
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
            place = meeting(segments[i], segments[other]);
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
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const std::string_view content = withoutByteOrderMark(text);
    const std::size_t first = content.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) throw InputError(name, "is empty; expected polygons");
    Collector out(name);
    if (content[first] == '{' || content[first] == '[')
        readJson(GeoJson(text, GeoJson::Positions::plane, name), out);
    else
        readText(text, out);
    return out.finish();
}

bool looksLikePolygons(const std::filesystem::path& path) {
    const std::string extension = toLower(path.extension().string());
    for (const char* known : {".geojson", ".json", ".topojson", ".txt", ".gmt", ".xy"})
        if (extension == known) return true;
    return false;
}

}  // namespace isowave::curves2d
