#include "volume/repair/holes.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/number_text.h"
#include "base/point_box.h"
#include "base/polygon_triangles.h"
#include "base/triangle.h"
#include "isowave/error.h"

namespace isowave::repair {
namespace {

constexpr std::size_t kMostTriangulated = 4096;
constexpr double kMostLoose = 0.01;  // of the area

std::vector<Point> pointsOf(const TriangleMesh& mesh, const Loop& loop) {
    std::vector<Point> points;
    points.reserve(loop.size());
    for (const Index p : loop) points.push_back(mesh.points[p]);
    return points;
}

Vec3 meanOf(const std::vector<Point>& points) {
    Vec3 sum;
    for (const Point& p : points) sum += toVec3(p);
    return sum / static_cast<double>(points.size());
}

// The least distance between two parallel lines around the points, in the plane across `normal`, of 180 directions.
double caliper(const std::vector<Point>& points, Vec3 normal) {
    constexpr int kDirections = 180;
    const double size = length(normal);
    if (!(size > 0)) return HUGE_VAL;
    normal = normal / size;
    const int least = std::abs(normal.x) <= std::abs(normal.y) && std::abs(normal.x) <= std::abs(normal.z) ? 0
                      : std::abs(normal.y) <= std::abs(normal.z)                                           ? 1
                                                                 : 2;
    Vec3 axis;
    axis[least] = 1;
    Vec3 u = cross(normal, axis);
    u = u / length(u);
    const Vec3 v = cross(normal, u);
    double width = HUGE_VAL;
    for (int d = 0; d < kDirections; ++d) {
        const Vec3 direction = std::cos(d * M_PI / kDirections) * u + std::sin(d * M_PI / kDirections) * v;
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const Point& p : points) {
            const double x = dot(toVec3(p), direction);
            low = std::min(low, x);
            high = std::max(high, x);
        }
        width = std::min(width, high - low);
    }
    return width;
}

void fillByFan(Hole& hole, Index apex) {
    for (std::size_t i = 0; i < hole.loop.size(); ++i)
        hole.filling.push_back({hole.loop[i], hole.loop[(i + 1) % hole.loop.size()], apex});
}

void fill(Hole& hole, const std::vector<Point>& points, Index apex) {
    if (points.size() > kMostTriangulated) return fillByFan(hole, apex);
    for (const auto& [a, b, c] : trianglesOf(points))
        hole.filling.push_back({hole.loop[a], hole.loop[b], hole.loop[c]});
}

Hole measured(const TriangleMesh& mesh, Loop loop) {
    Hole hole{std::move(loop), 0, 0, 0, {}};
    const std::vector<Point> points = pointsOf(mesh, hole.loop);
    const auto apex = static_cast<Index>(mesh.points.size());
    fill(hole, points, apex);
    const Vec3 mean = meanOf(points);
    const auto at = [&](Index p) { return p == apex ? mean : toVec3(mesh.points[p]); };
    Vec3 normal;
    for (const auto& [a, b, c] : hole.filling) {
        const Vec3 twice = cross(at(b) - at(a), at(c) - at(a));
        normal += twice;
        hole.area += length(twice) / 2;
    }
    PointBox box;
    for (const Point& p : points) box.add(p);
    hole.length = length(toVec3(box.high) - toVec3(box.low));
    if (hole.length > 0) hole.width = 2 * hole.area / hole.length;
    if (points.size() > 3) hole.width = std::min(hole.width, caliper(points, normal));
    return hole;
}

double diagonal(const TriangleMesh& mesh) {
    const PointBox box = boxAround(mesh);
    return length(toVec3(box.high) - toVec3(box.low));
}

// meshArea: a hole as large as what is around it is the other side of a sheet, however narrow.
bool closes(const RepairOptions& options, const Hole& hole, double diagonal, double meshArea) {
    constexpr double kRounding = 1 + 1e-6;
    if (options.closeHoles) return hole.width <= *options.closeHoles * kRounding;
    const double widest = options.maxHole * diagonal;
    return options.maxHole > 0 && hole.width <= widest && hole.area <= M_PI / 4 * widest * widest &&
           hole.area <= 1.5 * options.maxHole * meshArea;
}

double areaOf(const TriangleMesh& mesh) {
    double twice = 0;
    for (const Triangle& t : mesh.triangles) twice += length(areaNormal(mesh, t));
    return twice / 2;
}

// Three digits, rounded up: a width to type.
double roundedUp(double width) {
    const double unit = std::pow(10.0, std::floor(std::log10(std::max(width, 1e-300))) - 2);
    return std::ceil(width / unit * (1 - 1e-9)) * unit;
}

}  // namespace

std::vector<Hole> holesOf(const TriangleMesh& mesh, std::vector<Loop> loops, const Progress& progress) {
    std::vector<Hole> holes;
    holes.reserve(loops.size());
    for (Loop& loop : loops) {
        checkNowAndThen(progress, holes.size() + 1);
        if (loop.size() > 64) progress.check();
        holes.push_back(measured(mesh, std::move(loop)));
    }
    return holes;
}

void refuseLargeHoles(const TriangleMesh& mesh, const std::string& name, const std::vector<Hole>& holes,
                      const MeshRepairReport& report, const RepairOptions& options) {
    if (holes.empty()) return;
    const double size = diagonal(mesh), area = areaOf(mesh);
    const Hole* widest = nullptr;
    std::int64_t tooLarge = 0;
    for (const Hole& hole : holes) {
        if (closes(options, hole, size, area)) continue;
        ++tooLarge;
        if (!widest || hole.width > widest->width) widest = &hole;
    }
    if (!widest) return;
    const Point& place = mesh.points[widest->loop.front()];
    throw InputError(
        name,
        fmt::format(
            "not closed: {} in {}, {} too large to fill unasked; the widest, at ({:g}, {:g}, {:g}), is "
            "{:.4g} "
            "wide and {:.4g} long; --close-holes {:g} fills holes up to that width, --thicken T makes a "
            "sheet a solid of thickness T",
            counted(report.boundaryEdges, "boundary edge"),
            counted(static_cast<std::int64_t>(holes.size()), "loop"), tooLarge, place[0], place[1], place[2],
            widest->width, widest->length, roundedUp(widest->width)));
}

std::pair<Triangle, bool> sortedCorners(Triangle t) {
    bool even = true;
    const auto order = [&](Index& a, Index& b) {
        if (a > b) {
            std::swap(a, b);
            even = !even;
        }
    };
    order(t[0], t[1]);
    order(t[1], t[2]);
    order(t[0], t[1]);
    return {t, even};
}

namespace {

std::vector<Triangle> loopsOfThree(const std::vector<Hole>& holes) {
    std::vector<Triangle> threes;
    for (const Hole& hole : holes)
        if (hole.loop.size() == 3)
            threes.push_back(sortedCorners({hole.loop[0], hole.loop[1], hole.loop[2]}).first);
    std::sort(threes.begin(), threes.end());
    return threes;
}

// Takes the triangles with such a loop around them out; gives back their corners, sorted.
std::vector<Triangle> takeLoose(TriangleMesh& mesh, const std::vector<Triangle>& threes, double& area) {
    std::vector<Triangle> loose;
    if (threes.empty()) return loose;
    std::erase_if(mesh.triangles, [&](const Triangle& triangle) {
        const Triangle corners = sortedCorners(triangle).first;
        if (!std::binary_search(threes.begin(), threes.end(), corners)) return false;
        loose.push_back(corners);
        area += length(areaNormal(mesh, triangle)) / 2;
        return true;
    });
    std::sort(loose.begin(), loose.end());
    return loose;
}

void refuseMuchLoose(const TriangleMesh& mesh, const std::string& name, std::size_t count, double area) {
    if (mesh.triangles.empty()) return;
    const double left = areaOf(mesh);
    if (area <= kMostLoose * (left + area)) return;
    throw InputError(
        name,
        fmt::format("{} share no edge with another one, {:.0f} % of the area: their corners lie too far "
                    "from each other to be one point; merge points by distance in a mesh editor",
                    counted(static_cast<std::int64_t>(count), "triangle"), 100 * area / (left + area)));
}

}  // namespace

void closeHoles(TriangleMesh& mesh, const std::string& name, const std::vector<Hole>& holes,
                MeshRepairReport& report) {
    double looseArea = 0;
    const std::vector<Triangle> loose = takeLoose(mesh, loopsOfThree(holes), looseArea);
    if (!loose.empty()) refuseMuchLoose(mesh, name, loose.size(), looseArea);
    const auto past = static_cast<Index>(mesh.points.size());
    for (const Hole& hole : holes) {
        if (hole.loop.size() == 3) {
            const Triangle corners = sortedCorners({hole.loop[0], hole.loop[1], hole.loop[2]}).first;
            if (std::binary_search(loose.begin(), loose.end(), corners)) continue;
        }
        const auto apex = static_cast<Index>(mesh.points.size());
        bool hasApex = false;
        for (Triangle t : hole.filling) {
            for (Index& corner : t)
                if (corner == past) corner = apex, hasApex = true;
            mesh.triangles.push_back(t);
        }
        if (hasApex) {
            const Vec3 mean = meanOf(pointsOf(mesh, hole.loop));
            mesh.points.push_back({mean.x, mean.y, mean.z});
        }
        ++report.holesFilled;
        report.widestFilled = std::max(report.widestFilled, hole.width);
    }
    report.looseRemoved = static_cast<std::int64_t>(loose.size());
}

}  // namespace isowave::repair
