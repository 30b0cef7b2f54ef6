#include "io/mesh/stl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/mesh/equal_points.h"
#include "io/mesh/float32.h"
#include "io/mesh/lines.h"
#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::size_t kHeader = 80, kStart = 84, kTriangle = 50, kNormal = 12;

template <class T>
T at(std::string_view bytes, std::size_t place) {
    T value;
    std::memcpy(&value, bytes.data() + place, sizeof value);  // little-endian, as this machine
    return value;
}

// Many binary files start with "solid", and some count wrong: first the sum of bytes decides, then the words.
bool isBinary(std::string_view bytes) {
    if (bytes.size() >= kStart &&
        bytes.size() == kStart + kTriangle * std::size_t{at<std::uint32_t>(bytes, kHeader)})
        return true;
    if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
        return false;  // a text, as Lines will say
    std::string_view text = bytes;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    return !isKeyword(text.substr(0, 5), "solid") || bytes.substr(0, 1024).find('\0') != bytes.npos;
}

void checkCount(std::string_view bytes, const std::string& name) {
    if (bytes.size() < kStart)
        throw InputError(
            name, fmt::format("{} bytes are too few for an STL file, and it does not start with 'solid'",
                              bytes.size()));
    const std::size_t promised = at<std::uint32_t>(bytes, kHeader),
                      held = (bytes.size() - kStart) / kTriangle;
    if (promised > held)
        throw InputError(name,
                         fmt::format("the header promises {} triangles ({} bytes) but the file holds {} ({} "
                                     "bytes); it is truncated or no STL",
                                     promised, kStart + kTriangle * promised, held, bytes.size()));
    if (promised < held)
        throw InputError(name,
                         fmt::format("the header promises {} triangles but the file has room for {}; the "
                                     "count is wrong: export it again",
                                     promised, held));
}

// Three points a triangle.
std::vector<Point> readBinary(std::string_view bytes, const std::string& name, PolygonSoup& soup) {
    checkCount(bytes, name);
    const std::size_t triangles = (bytes.size() - kStart) / kTriangle;
    std::vector<Point> points;
    points.reserve(3 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const auto corners = at<std::array<FloatPoint, 3>>(bytes, kStart + kTriangle * t + kNormal);
        if (at<std::uint16_t>(bytes, kStart + kTriangle * (t + 1) - 2) != 0) soup.drop(Dropped::colours);
        for (std::size_t i = 0; i < 3; ++i) {
            for (const float x : corners[i])
                if (!std::isfinite(x))
                    throw InputError(name, fmt::format("triangle {}, corner {}: coordinate {} is not finite",
                                                       t + 1, i + 1, x));
            points.push_back({corners[i][0], corners[i][1], corners[i][2]});
        }
    }
    return points;
}

// Words over any line breaks; solids may have names of several words, up to the end of their line, or where all stands on one
// line up to the words "facet normal".
class TextStl {
  public:
    TextStl(std::string_view text, const std::string& name) : lines_(text, name, Lines::Break::blank) {}

    // How many solids, whether one of them has colours, the most digits of a coordinate.
    std::size_t solids() const { return solids_; }
    bool hasColours() const { return hasColours_; }
    int digits() const { return lines_.mostDigits(); }

    // Three points a triangle. A word that STL has not, before something else is wrong, is what is wrong.
    std::vector<Point> read() {
        try {
            readAll();
        } catch (const InputError&) {
            if (!unknown_.empty()) throw InputError(lines_.name(), unknown_);
            throw;
        }
        return std::move(points_);
    }

  private:
    void readAll() {
        for (auto word = lines_.word(); !word.empty(); word = lines_.word()) take(word);
        if (inFacet_)
            throw InputError(lines_.name(),
                             fmt::format("the file ends inside facet {} (line {}); it is truncated",
                                         points_.size() / 3 + 1, facetLine_));
        if (inSolid_)
            throw InputError(
                lines_.name(),
                fmt::format(
                    "the file ends after {} facets without 'endsolid'; it is truncated, or append that line",
                    points_.size() / 3));
    }
    void take(std::string_view word) {
        if (isKeyword(word, "vertex"))
            takeVertex();
        else if (isKeyword(word, "facet"))
            beginFacet();
        else if (isKeyword(word, "endfacet"))
            endFacet();
        else if (isKeyword(word.substr(0, 8), "endsolid"))
            endSolid();
        else if (isKeyword(word.substr(0, 5), "solid") && lines_.isFirstWord())
            beginSolid();
        else if (isKeyword(word, "color"))
            hasColours_ = true;
        else if (unknown_.empty() && lines_.isFirstWord() && !isKeyword(word, "outer") &&
                 !isKeyword(word, "endloop"))
            unknown_ = fmt::format("line {}: '{}' is no STL keyword", lines_.number(), shown(word));
    }
    void beginSolid() {
        if (inSolid_)
            lines_.fail(
                fmt::format("'solid' inside the solid of line {}; 'endsolid' is missing", solidLine_));
        inSolid_ = true;
        ++solids_;
        solidLine_ = lines_.number();
        while (!lines_.isLineDone() && !facetFollows()) lines_.word();
    }
    bool facetFollows() const {
        Lines ahead = lines_;
        return isKeyword(ahead.word(), "facet") && isKeyword(ahead.word(), "normal");
    }
    void endSolid() {
        if (inFacet_) lines_.fail("'endsolid' inside a facet");
        inSolid_ = false;
        while (!lines_.isLineDone())
            if (isKeyword(lines_.word(), "solid") && namesSolidWithFacets()) return beginSolid();
    }
    // Whether what is left of this line is the name of a solid and its facets: a file on one line.
    bool namesSolidWithFacets() const {
        constexpr std::size_t kLongestName = 400;
        Lines ahead = lines_;
        return lowerCase(ahead.restOfLine().substr(0, kLongestName)).find("facet normal") !=
               std::string::npos;
    }
    void beginFacet() {
        if (inFacet_) lines_.fail(fmt::format("the facet of line {} has no 'endfacet'", facetLine_));
        inFacet_ = true;
        facetLine_ = lines_.number();
        corners_ = 0;
    }
    void takeVertex() {
        if (!inFacet_) lines_.fail("a vertex outside a facet");
        points_.push_back(lines_.point());
        ++corners_;
    }
    void endFacet() {
        if (!inFacet_) return;
        if (corners_ != 3)
            lines_.failAt(facetLine_,
                          fmt::format("the facet has {} vertices; STL holds triangles only", corners_));
        inFacet_ = false;
    }

    Lines lines_;
    std::vector<Point> points_;
    bool inSolid_ = false, inFacet_ = false, hasColours_ = false;
    std::size_t solids_ = 0;
    std::size_t solidLine_ = 0, facetLine_ = 0, corners_ = 0;
    std::string unknown_;  // the first word that STL has not, as a complaint
};

std::vector<Point> readText(std::string_view bytes, const std::string& name, PolygonSoup& soup) {
    TextStl text(bytes, name);
    std::vector<Point> points = text.read();
    if (text.hasColours()) soup.drop(Dropped::colours);
    if (text.solids() > 1) soup.drop(Dropped::groups);
    soup.digits = text.digits();
    return points;
}

bool allFloat32(const std::vector<Point>& points) {
    return std::all_of(points.begin(), points.end(), [](const Point& p) {
        return std::all_of(p.begin(), p.end(),
                           [](double x) { return static_cast<double>(static_cast<float>(x)) == x; });
    });
}

// What is left of the mesh must be enough for readMesh.
void checkSteps(const std::vector<FloatPoint>& points, const std::string& name) {
    if (points.empty()) return;
    float largest = 0, extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            points.begin(), points.end(), [&](const auto& p, const auto& q) { return p[axis] < q[axis]; });
        largest = std::max({largest, (*high)[axis], -(*low)[axis]});
        extent = std::max(extent, (*high)[axis] - (*low)[axis]);
    }
    const float step = stepAt(largest);
    if (extent < kFewestSteps * step)
        throw OperationError(name, fmt::format("float32, which is all that STL has, has steps of {:.2g} at "
                                               "{:g}, fewer than {} across a mesh of {:g}; write PLY, which "
                                               "can have float64",
                                               step, largest, kFewestSteps, extent));
}

FloatPoint normalOf(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c) {
    const Vec3 normal = cross(toVec3(b) - toVec3(a), toVec3(c) - toVec3(a));
    const double l = length(normal);
    // + 0.0 turns -0 into 0.
    return toFloat(l > 0 ? Vec3{normal.x / l + 0.0, normal.y / l + 0.0, normal.z / l + 0.0} : normal);
}

}  // namespace

PolygonSoup readStl(std::string_view bytes, const std::string& name) {
    const bool binary = isBinary(bytes);
    PolygonSoup soup;
    soup.format = binary ? "binary STL" : "ASCII STL";
    soup.space = spaceIn(bytes.substr(0, binary ? kHeader : bytes.find('\n')));
    const std::vector<Point> corners = binary ? readBinary(bytes, name, soup) : readText(bytes, name, soup);
    DistinctPoints distinct = distinctPoints(corners);
    soup.points.reserve(distinct.firsts.size());
    for (const std::uint32_t i : distinct.firsts) soup.points.push_back(corners[i]);
    soup.corners = std::move(distinct.which);
    soup.faceBegin.reserve(corners.size() / 3 + 1);
    for (std::size_t end = 3; end <= corners.size(); end += 3)
        soup.faceBegin.push_back(static_cast<std::uint32_t>(end));
    // Text may have more digits than float32, as a CAD system that computes in float64 writes them.
    soup.float32 = binary || allFloat32(soup.points);
    return soup;
}

void writeStl(Sink& sink, const MeshView& mesh, const std::string& name) {
    if (mesh.triangles.size() > 0xffffffffu)
        throw OperationError(name, "STL holds at most 2^32 - 1 triangles; write PLY");
    const std::vector<FloatPoint> points = separateFloats(mesh.points, name, "STL");
    checkSteps(points, name);
    // Not "solid": that is how the text form begins.
    std::string header = "binary STL by isowave";
    if (mesh.space != Space::unspecified) header += " " + mesh.comments().back();
    header.resize(kHeader, ' ');
    sink.text(header);
    sink.binary(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& [a, b, c] : mesh.triangles)
        sink.binary(normalOf(points[a], points[b], points[c]), points[a], points[b], points[c],
                    std::uint16_t{0});
}

}  // namespace isowave
