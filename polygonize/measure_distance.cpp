// Distances between surfaces: an AABB tree over the target's triangles, samples on the other surface.
//
// Passes of distanceFrom():
//   corners   the distance of every point that a triangle uses, once
//   pieces    every triangle is integrated, halved first where it is larger than `spacing`
//   sum       chunk by chunk, in order: chunks are cut by triangle number, not by thread
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <tbb/parallel_for.h>
#include <boost/iterator/counting_iterator.hpp>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "polygonize/measure.h"

namespace isowave {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point3 = Kernel::Point_3;
using Vector3 = Kernel::Vector_3;

constexpr std::size_t kChunk = 1024;  // triangles or points handed to a thread at once

Point3 toPoint3(const Point& p) { return {p[0], p[1], p[2]}; }

// ---- the nearest point of a triangle --------------------------------------------------------------------

Point3 nearestOnSegment(const Point3& q, const Point3& a, const Point3& b) {
    const Vector3 along = b - a;
    const double length2 = along.squared_length();
    if (length2 == 0) return a;
    return a + std::clamp((q - a) * along / length2, 0.0, 1.0) * along;
}

// Inside the prism over the triangle the nearest point is the foot on its plane, else it lies on a side.
// CGAL's own projection divides by the length of the normal and returns NaN for a triangle without area;
// sliver triangles are what CAD meshes are full of, so that case has to work.
Point3 nearestOnTriangle(const Point3& q, const Point3& a, const Point3& b, const Point3& c) {
    const Vector3 normal = CGAL::cross_product(b - a, c - a);
    const double normal2 = normal.squared_length();
    const auto insideOf = [&](const Point3& u, const Point3& v) {
        return CGAL::cross_product(v - u, q - u) * normal >= 0;
    };
    if (normal2 > 0 && insideOf(a, b) && insideOf(b, c) && insideOf(c, a))
        return q - ((q - a) * normal / normal2) * normal;
    Point3 best = nearestOnSegment(q, a, b);
    for (const Point3& p : {nearestOnSegment(q, b, c), nearestOnSegment(q, c, a)})
        if ((q - p).squared_length() < (q - best).squared_length()) best = p;
    return best;
}

// ---- the tree ---------------------------------------------------------------------------------------------

// A triangle of an index mesh, by number: the tree holds no copies of corners.
class IndexedTriangle {
  public:
    using Point = Point3;
    using Datum = Kernel::Triangle_3;
    using Id = std::uint32_t;

    // As AABB_tree::insert(first, beyond, mesh) calls it, with iterators over numbers.
    IndexedTriangle(boost::counting_iterator<Id> number, const TriangleMesh* mesh)
        : mesh_(mesh), id_(*number) {}
    Id id() const { return id_; }
    Point corner(int i) const { return toPoint3(mesh_->points[mesh_->triangles[id_][i]]); }
    Datum datum() const { return {corner(0), corner(1), corner(2)}; }
    Point reference_point() const { return corner(0); }

  private:
    const TriangleMesh* mesh_;
    Id id_;
};

struct Traits : CGAL::AABB_traits<Kernel, IndexedTriangle> {
    struct NearestPoint {
        Point3 operator()(const Point3& q, const IndexedTriangle& t, const Point3& bound) const {
            const Point3 p = nearestOnTriangle(q, t.corner(0), t.corner(1), t.corner(2));
            return (q - p).squared_length() < (q - bound).squared_length() ? p : bound;
        }
    };
    NearestPoint closest_point_object() const { return {}; }
};

// ---- pieces -----------------------------------------------------------------------------------------------

// Corners of a triangle or of a part of one, with their distances to the target.
struct Sample {
    Point3 at;
    double distance;
};
using Piece = std::array<Sample, 3>;

// The largest distance of a point of the triangle pqr to its nearest corner.
//   no obtuse angle: the circumcentre is in the triangle, R = |a||b||c| / (4 area)
//   obtuse at C:     the farthest point lies on the long side AB, where the bisector of CA or of CB cuts it, at
//                    |b| / (2 cos A) from A or |a| / (2 cos B) from B
// Never more than c/sqrt(3), c the longest side: that is its value for the equilateral triangle.
double coveringRadius(const Point3& p, const Point3& q, const Point3& r) {
    std::array<double, 3> s2 = {(q - p).squared_length(), (r - q).squared_length(), (p - r).squared_length()};
    std::sort(s2.begin(), s2.end());
    const auto [a2, b2, c2] = s2;
    const double worst = std::sqrt(c2 / 3);
    double radius;
    if (a2 + b2 >= c2) {
        const double twiceArea2 = CGAL::cross_product(q - p, r - p).squared_length();
        radius = std::sqrt(a2 * b2 * c2 / twiceArea2) / 2;
    } else {
        // cos A = (b2 + c2 - a2) / (2 |b||c|)
        radius = std::sqrt(c2) * std::max(b2 / (b2 + c2 - a2), a2 / (a2 + c2 - b2));
    }
    return radius < worst ? radius : worst;  // also when radius is NaN: two corners in one place
}

struct Sums {
    double weight = 0, distance = 0, square = 0, max = 0, maxBound = 0;
    std::int64_t samples = 0;

    void add(const Sums& other) {
        weight += other.weight;
        distance += other.distance;
        square += other.square;
        max = std::max(max, other.max);
        maxBound = std::max(maxBound, other.maxBound);
        samples += other.samples;
    }
};

double squared(double x) { return x * x; }

// A/12 (v(a) + v(b) + v(c) + 9 v(centroid)) for v = distance and v = distance^2, and both bounds.
void addPiece(const Piece& piece, const Sample& centroid, double weight, Sums& sums) {
    const auto& [a, b, c] = piece;
    const double corners = a.distance + b.distance + c.distance;
    const double corners2 = squared(a.distance) + squared(b.distance) + squared(c.distance);
    sums.weight += weight;
    sums.distance += weight / 12 * (corners + 9 * centroid.distance);
    sums.square += weight / 12 * (corners2 + 9 * squared(centroid.distance));
    sums.max = std::max({sums.max, a.distance, b.distance, c.distance, centroid.distance});
    for (int i = 0; i < 3; ++i) {
        const Sample &u = piece[i], &v = piece[(i + 1) % 3];
        const double largest = std::max({u.distance, v.distance, centroid.distance});
        sums.maxBound = std::max(sums.maxBound, largest + coveringRadius(u.at, v.at, centroid.at));
    }
}

double coveringRadius(const Piece& piece, const Point3& centroid) {
    double radius = 0;
    for (int i = 0; i < 3; ++i)
        radius = std::max(radius, coveringRadius(piece[i].at, piece[(i + 1) % 3].at, centroid));
    return radius;
}

int longestSide(const Piece& piece) {
    const auto length2 = [&](int i) { return (piece[(i + 1) % 3].at - piece[i].at).squared_length(); };
    int longest = 0;
    for (int i = 1; i < 3; ++i)
        if (length2(i) > length2(longest)) longest = i;
    return longest;
}

// Halving the longest side, not cutting all sides into k parts: a sliver of length l and no width becomes
// three pieces each time spacing is halved, so (l / spacing)^1.58 of them and not (l / spacing)^2. Cutting
// slivers across into quadrangles would be linear; CAD meshes have not needed it.
template <class Distance>
void integrate(const Piece& piece, double weight, double spacing, int depth, const Distance& distanceTo,
               Sums& sums) {
    const Point3 middle = CGAL::centroid(piece[0].at, piece[1].at, piece[2].at);
    // 100 halvings use up the 53 bits of both coordinates in the plane: no smaller piece can be told apart.
    if (spacing > 0 && depth < 100 && coveringRadius(piece, middle) > spacing) {
        const int i = longestSide(piece), j = (i + 1) % 3;
        const Point3 at = CGAL::midpoint(piece[i].at, piece[j].at);
        const Sample cut{at, distanceTo(at)};
        ++sums.samples;
        for (const int end : {i, j}) {
            Piece half = piece;
            half[end] = cut;
            integrate(half, weight / 2, spacing, depth + 1, distanceTo, sums);
        }
        return;
    }
    ++sums.samples;
    addPiece(piece, {middle, distanceTo(middle)}, weight, sums);
}

// ---- chunks -----------------------------------------------------------------------------------------------

// body(first, last, chunk number), in parallel; the cut does not depend on the number of threads.
template <class Body>
void forChunks(std::size_t count, const Progress& progress, const char* stage, const Body& body) {
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        progress.check();
        body(chunk * kChunk, std::min(count, (chunk + 1) * kChunk), chunk);
        progress(stage, static_cast<double>(++done) / static_cast<double>(chunks));
    });
}

std::vector<char> usedPoints(const TriangleMesh& mesh) {
    std::vector<char> used(mesh.points.size(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) used[v] = 1;
    return used;
}

double areaOf(const TriangleMesh& mesh, const Triangle& t) {
    const Point3 a = toPoint3(mesh.points[t[0]]);
    return std::sqrt(CGAL::cross_product(toPoint3(mesh.points[t[1]]) - a, toPoint3(mesh.points[t[2]]) - a)
                         .squared_length()) /
           2;
}

double areaOf(const TriangleMesh& mesh) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += areaOf(mesh, t);
    return area;
}

// Sum of the tetrahedra over all triangles from one point of the mesh, not from the origin, which may be far.
double volumeOf(const TriangleMesh& mesh) {
    const Point3 apex = toPoint3(mesh.points[mesh.triangles[0][0]]);
    double volume6 = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](int i) { return toPoint3(mesh.points[t[i]]) - apex; };
        volume6 += CGAL::cross_product(corner(0), corner(1)) * corner(2);
    }
    return volume6 / 6;
}

}  // namespace

// ---- DistanceTarget ---------------------------------------------------------------------------------------

struct DistanceTarget::Tree {
    TriangleMesh mesh;
    CGAL::AABB_tree<Traits> boxes;

    explicit Tree(const TriangleMesh& from) : mesh{from.points, from.triangles, {}} {
        assert(!mesh.triangles.empty());
        const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
        boxes.insert(boost::counting_iterator<std::uint32_t>(0),
                     boost::counting_iterator<std::uint32_t>(count), static_cast<const TriangleMesh*>(&mesh));
        boxes.build();
        boxes.accelerate_distance_queries();
    }

    double distance(const Point3& p) const {
        return std::sqrt((p - boxes.closest_point(p)).squared_length());
    }
};

DistanceTarget::DistanceTarget(const TriangleMesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
DistanceTarget::~DistanceTarget() = default;
DistanceTarget::DistanceTarget(DistanceTarget&&) noexcept = default;
DistanceTarget& DistanceTarget::operator=(DistanceTarget&&) noexcept = default;

double DistanceTarget::distance(const Point& p) const { return tree_->distance(toPoint3(p)); }

OneSidedDistance DistanceTarget::distanceFrom(const TriangleMesh& from, double spacing,
                                              const Progress& progress) const {
    assert(spacing >= 0);
    if (from.triangles.empty()) return {};

    const std::vector<char> used = usedPoints(from);
    std::vector<double> corners(from.points.size(), 0.0);
    forChunks(from.points.size(), progress, "distances of vertices",
              [&](std::size_t first, std::size_t last, auto) {
                  for (std::size_t i = first; i < last; ++i)
                      if (used[i]) corners[i] = distance(from.points[i]);
              });

    const double area = areaOf(from);
    const auto distanceTo = [this](const Point3& p) { return tree_->distance(p); };
    std::vector<Sums> sums((from.triangles.size() + kChunk - 1) / kChunk);
    forChunks(
        from.triangles.size(), progress, "distances of triangles",
        [&](std::size_t first, std::size_t last, std::size_t chunk) {
            for (std::size_t i = first; i < last; ++i) {
                const Triangle& t = from.triangles[i];
                const auto corner = [&](int k) { return Sample{toPoint3(from.points[t[k]]), corners[t[k]]}; };
                const double weight = area > 0 ? areaOf(from, t) : 1.0;
                integrate({corner(0), corner(1), corner(2)}, weight, spacing, 0, distanceTo, sums[chunk]);
            }
        });

    Sums total;
    for (const Sums& s : sums) total.add(s);
    total.samples += std::count(used.begin(), used.end(), 1);
    return {total.distance / total.weight,
            std::sqrt(total.square / total.weight),
            total.max,
            total.maxBound,
            area,
            total.samples};
}

// ---- both sides -------------------------------------------------------------------------------------------

MeshComparison compareMeshes(const TriangleMesh& a, const TriangleMesh& b, double spacing,
                             const Progress& progress) {
    for (const auto& [mesh, name] : {std::pair{&a, "first mesh"}, std::pair{&b, "second mesh"}})
        if (mesh->triangles.empty())
            throw InputError(name, "it has no triangle, so there is nothing to compare");

    MeshComparison result;
    result.aToB = DistanceTarget(b).distanceFrom(a, spacing, progress);
    result.bToA = DistanceTarget(a).distanceFrom(b, spacing, progress);

    // Shares of the two surfaces; halves where neither has area.
    const double areas = result.aToB.area + result.bToA.area;
    const double shareA = areas > 0 ? result.aToB.area / areas : 0.5, shareB = 1 - shareA;
    result.mean = shareA * result.aToB.mean + shareB * result.bToA.mean;
    result.rms = std::sqrt(shareA * squared(result.aToB.rms) + shareB * squared(result.bToA.rms));
    result.max = std::max(result.aToB.max, result.bToA.max);
    result.maxBound = std::max(result.aToB.maxBound, result.bToA.maxBound);
    result.volumeA = volumeOf(a);
    result.volumeB = volumeOf(b);
    result.volumeDifference = result.volumeB - result.volumeA;
    return result;
}

}  // namespace isowave
