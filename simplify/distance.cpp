// Distances between surfaces: boxes around the target's triangles, samples on the other surface.
//
// Passes of distanceFrom():
//   corners   the distance of every point that a triangle uses, once
//   pieces    every triangle is integrated, halved first where it is larger than `spacing`
//   sum       chunk by chunk, in order: chunks are cut by triangle number, not by thread
//   tighten   the pieces that may hold a point farther away than any sample are halved on, the least certain
//             ones first, until the bound is close to the maximum
#include "simplify/distance.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/point_box.h"
#include "base/triangle.h"
#include "isowave/error.h"
#include "simplify/boxes.h"
#include "simplify/graph_bound.h"
#include "simplify/nearest_on_triangle.h"

namespace isowave {
namespace {

constexpr std::size_t kChunk = 1024;  // triangles or points handed to a thread at once

// ---- pieces

// Corners of a triangle or of a part of one, with their distances to the target and its triangle there.
struct Sample {
    Vec3 at;
    double distance;
    std::uint32_t nearest;
};
using Piece = std::array<Sample, 3>;

// The largest distance of a point of the triangle pqr to its nearest corner.
//   no obtuse angle: the circumcentre is in the triangle, R = |a||b||c| / (4 area)
//   obtuse at C:     the farthest point lies on the long side AB, where the bisector of CA or of CB cuts it, at
//                    |b| / (2 cos A) from A or |a| / (2 cos B) from B
// Never more than c/sqrt(3), c the longest side: that is its value for the equilateral triangle.
double coveringRadius(const Vec3& p, const Vec3& q, const Vec3& r) {
    std::array<double, 3> s2 = {squaredLength(q - p), squaredLength(r - q), squaredLength(p - r)};
    std::sort(s2.begin(), s2.end());
    const auto [a2, b2, c2] = s2;
    const double worst = std::sqrt(c2 / 3);
    double radius;
    if (a2 + b2 >= c2) {
        const double twiceArea2 = squaredLength(cross(q - p, r - p));
        radius = std::sqrt(a2 * b2 * c2 / twiceArea2) / 2;
    } else {
        // cos A = (b2 + c2 - a2) / (2 |b||c|)
        radius = std::sqrt(c2) * std::max(b2 / (b2 + c2 - a2), a2 / (a2 + c2 - b2));
    }
    return radius < worst ? radius : worst;  // also when radius is NaN: two corners in one place
}

// ---- bounds

// A piece with a bound for the distance of all its points.
struct BoundedPiece {
    Piece corners;
    Sample centroid;
    double bound;
};

// No point of a third (two corners and the centroid) is farther from a sample than the third's covering
// radius, and a distance changes by at most the way walked.
double boundByWay(const Piece& piece, const Sample& centroid) {
    double bound = 0;
    for (int i = 0; i < 3; ++i) {
        const Sample &u = piece[i], &v = piece[(i + 1) % 3];
        bound = std::max(bound, std::max({u.distance, v.distance, centroid.distance}) +
                                    coveringRadius(u.at, v.at, centroid.at));
    }
    return bound;
}

// The distance to one triangle is convex, so over a piece it is largest at a corner; the distance to the
// whole target is smaller still. Tried with the triangles that are nearest to the piece's samples (Tang, Lee
// and Kim 2009). Where one triangle is nearest to all of them, this is the maximum itself.
template <class DistanceToTriangle>
double boundByConvexity(const Piece& piece, const Sample& centroid, const DistanceToTriangle& distanceTo) {
    double bound = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : {centroid.nearest, piece[0].nearest, piece[1].nearest, piece[2].nearest}) {
        double largest = 0;
        for (const Sample& corner : piece)
            largest = std::max(largest, corner.nearest == t ? corner.distance : distanceTo(corner.at, t));
        bound = std::min(bound, largest);
    }
    return bound;
}

// How close the bound has to come to the maximum: 1 %, or, where the maximum is next to nothing, a millionth
// of the surface's extent.
constexpr double kTightness = 0.01, kTightnessOfExtent = 1e-6;
// Memory: of a chunk's pieces with a larger bound this many are kept, those with the largest.
constexpr std::size_t kKeptPieces = kChunk;
// Work: tightening takes at most as many samples as measuring did, but this many are always allowed; and so
// many where there is a limit to prove.
constexpr std::int64_t kTighteningSamples = 200'000, kProvingSamples = 4'000'000;

// The pieces of a chunk whose bound is above `enough`.
class UncertainPieces {
  public:
    explicit UncertainPieces(double enough) : enough_(enough) {}
    void add(const BoundedPiece& piece) {
        if (!(piece.bound > enough_)) return;
        pieces_.push_back(piece);
        if (pieces_.size() >= 2 * kKeptPieces) keepLargest();
    }
    // A bound for the points of all pieces that were not kept.
    double restBound() const { return restBound_; }
    std::vector<BoundedPiece> take() {
        if (pieces_.size() > kKeptPieces) keepLargest();
        return std::move(pieces_);
    }

  private:
    void keepLargest() {
        std::stable_sort(pieces_.begin(), pieces_.end(),
                         [](const auto& a, const auto& b) { return a.bound > b.bound; });
        restBound_ = std::max(restBound_, pieces_[kKeptPieces].bound);
        pieces_.resize(kKeptPieces, pieces_.front());
    }
    double enough_, restBound_ = 0;
    std::vector<BoundedPiece> pieces_;
};

struct Sums {
    double weight = 0, distance = 0, square = 0, max = 0, maxBound = 0;
    double weight2 = 0, weight2square = 0, weight2fourth = 0;  // squared weights times 1, d^2, d^4
    std::int64_t samples = 0;

    void add(const Sums& other) {
        weight += other.weight;
        distance += other.distance;
        square += other.square;
        weight2 += other.weight2;
        weight2square += other.weight2square;
        weight2fourth += other.weight2fourth;
        max = std::max(max, other.max);
        maxBound = std::max(maxBound, other.maxBound);
        samples += other.samples;
    }
};

double squared(double x) { return x * x; }

// A/12 (v(a) + v(b) + v(c) + 9 v(centroid)) for v = distance and v = distance^2.
void addPiece(const Piece& piece, const Sample& centroid, double weight, Sums& sums) {
    const auto& [a, b, c] = piece;
    const double corners = a.distance + b.distance + c.distance;
    const double corners2 = squared(a.distance) + squared(b.distance) + squared(c.distance);
    sums.weight += weight;
    sums.distance += weight / 12 * (corners + 9 * centroid.distance);
    const double square = (corners2 + 9 * squared(centroid.distance)) / 12;
    sums.square += weight * square;
    sums.weight2 += weight * weight;
    sums.weight2square += weight * weight * square;
    sums.weight2fourth += weight * weight * square * square;
    sums.max = std::max({sums.max, a.distance, b.distance, c.distance, centroid.distance});
}

// Of a weighted mean m = sum w v / sum w of independent values: its variance is sum w^2 (v - m)^2 / (sum w)^2; and d rms = dm / (2 rms).
double rmsErrorOf(const Sums& sums) {
    constexpr double kDeviations = 1.96;  // 95 %
    const double mean = sums.square / sums.weight;
    const double spread = sums.weight2fourth - 2 * mean * sums.weight2square + mean * mean * sums.weight2;
    return mean > 0 ? kDeviations * std::sqrt(std::max(0.0, spread)) / sums.weight / (2 * std::sqrt(mean))
                    : 0;
}

double coveringRadius(const Piece& piece, const Vec3& centroid) {
    double radius = 0;
    for (int i = 0; i < 3; ++i)
        radius = std::max(radius, coveringRadius(piece[i].at, piece[(i + 1) % 3].at, centroid));
    return radius;
}

int longestSide(const Piece& piece) {
    const auto length2 = [&](int i) { return squaredLength(piece[(i + 1) % 3].at - piece[i].at); };
    int longest = 0;
    for (int i = 1; i < 3; ++i)
        if (length2(i) > length2(longest)) longest = i;
    return longest;
}

Vec3 centroidOf(const Piece& piece) { return (piece[0].at + piece[1].at + piece[2].at) / 3; }

// Both halves of a piece cut at the middle of its longest side; sampleAt(point) measures there.
template <class SampleAt>
std::array<Piece, 2> halves(const Piece& piece, const SampleAt& sampleAt) {
    const int i = longestSide(piece), j = (i + 1) % 3;
    const Sample cut = sampleAt((piece[i].at + piece[j].at) / 2);
    std::array<Piece, 2> result{piece, piece};
    result[0][i] = cut;
    result[1][j] = cut;
    return result;
}

// Halving the longest side, not cutting all sides into k parts: a sliver of length l and no width becomes
// three pieces each time spacing is halved, so (l / spacing)^1.58 of them and not (l / spacing)^2. Cutting
// slivers across into quadrangles would be linear; CAD meshes have not needed it.
template <class SampleAt, class Visit>
void integrate(const Piece& piece, double weight, double spacing, int depth, const SampleAt& sampleAt,
               const Visit& visit, Sums& sums) {
    const Vec3 middle = centroidOf(piece);
    // 100 halvings use up the 53 bits of both coordinates in the plane: no smaller piece can be told apart.
    if (spacing > 0 && depth < 100 && coveringRadius(piece, middle) > spacing) {
        ++sums.samples;
        for (const Piece& half : halves(piece, sampleAt))
            integrate(half, weight / 2, spacing, depth + 1, sampleAt, visit, sums);
        return;
    }
    ++sums.samples;
    const Sample centroid = sampleAt(middle);
    addPiece(piece, centroid, weight, sums);
    visit(piece, centroid);
}

// ---- chunks

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

double areaOf(const TriangleMesh& mesh, const Triangle& t) { return length(areaNormal(mesh, t)) / 2; }

double areaOf(const TriangleMesh& mesh) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += areaOf(mesh, t);
    return area;
}

double diagonalOf(const TriangleMesh& mesh) {
    const PointBox box = boxAround(mesh);
    return std::hypot(box.extent(0), box.extent(1), box.extent(2));
}

// Sum of the tetrahedra over all triangles from one point of the mesh, not from the origin, which may be far.
double volumeOf(const TriangleMesh& mesh) {
    const Vec3 apex = toVec3(mesh.points[mesh.triangles[0][0]]);
    double volume6 = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](int i) { return toVec3(mesh.points[t[i]]) - apex; };
        volume6 += dot(cross(corner(0), corner(1)), corner(2));
    }
    return volume6 / 6;
}

}  // namespace

// ---- DistanceTarget

struct DistanceTarget::Tree {
    TriangleMesh mesh;
    TriangleBoxes boxes;

    explicit Tree(TriangleMesh from)
        : mesh{std::move(from.points), std::move(from.triangles), {}}, boxes(mesh) {}

    Vec3 nearestOn(const Vec3& p, std::uint32_t triangle) const {
        const auto& [a, b, c] = mesh.triangles[triangle];
        return nearestOnTriangle(p, toVec3(mesh.points[a]), toVec3(mesh.points[b]), toVec3(mesh.points[c]));
    }
    TriangleBoxes::Nearest nearest(const Vec3& p, double enough = 0) const {
        return boxes.nearest(
            {p.x, p.y, p.z},
            [&](std::uint32_t triangle) { return squaredLength(p - nearestOn(p, triangle)); }, enough);
    }
    Sample sampleAt(const Vec3& p) const {
        const TriangleBoxes::Nearest found = nearest(p);
        return {p, std::sqrt(found.squared), found.triangle};
    }
    double distanceToTriangle(const Vec3& p, std::uint32_t triangle) const {
        return std::sqrt(squaredLength(p - nearestOn(p, triangle)));
    }
    // graph, enough: where there is a limit to prove, what it takes to prove it for a piece over many triangles.
    BoundedPiece bounded(const Piece& piece, const Sample& centroid, const GraphBound* graph,
                         double enough) const {
        const double convex = boundByConvexity(
            piece, centroid, [this](const Vec3& p, std::uint32_t t) { return distanceToTriangle(p, t); });
        double bound = std::min(convex, boundByWay(piece, centroid));
        if (graph && bound > enough)
            if (const auto flat =
                    graph->over({piece[0].at, piece[1].at, piece[2].at}, centroid.nearest, enough))
                bound = std::min(bound, *flat);
        return {piece, centroid, bound};
    }

    struct Maximum {
        double found, bound;
        std::int64_t samples;  // that it took
    };
    // The largest distance over pieces of which `found` is a sample, each bound falling as pieces are halved,
    // until it is close to the maximum or no more than `wanted`. limit: not null where `wanted` is a limit to prove.
    // invariant: no point of any piece, nor of those dropped for being certain, is farther than
    // maximum.bound.
    Maximum tighten(std::vector<BoundedPiece> pieces, double found, double restBound, double wanted,
                    const GraphBound* limit, std::int64_t mostSamples, const Progress& progress) const;
};

DistanceTarget::Tree::Maximum DistanceTarget::Tree::tighten(std::vector<BoundedPiece> pieces, double found,
                                                            double restBound, double wanted,
                                                            const GraphBound* limit, std::int64_t mostSamples,
                                                            const Progress& progress) const {
    Maximum maximum{found, std::max(found, restBound), 0};
    const auto enough = [&] { return std::max({(1 + kTightness) * maximum.found, wanted, restBound}); };
    // A limit to prove is wanted, and a sample lies beyond it: the rest does not matter.
    const auto disproved = [&] { return limit && maximum.found > wanted; };
    const auto boundOf = [&] {
        double bound = std::max(maximum.found, restBound);
        for (const BoundedPiece& p : pieces) bound = std::max(bound, p.bound);
        return bound;
    };
    std::vector<std::array<BoundedPiece, 2>> halved;
    for (maximum.bound = boundOf(); maximum.bound > enough() && maximum.samples < mostSamples && !disproved();
         maximum.bound = boundOf()) {
        // This round takes the upper half of the uncertainty; what is certain by now goes.
        const double certain = enough(), now = std::max(certain, (maximum.found + maximum.bound) / 2);
        const auto rest =
            std::stable_partition(pieces.begin(), pieces.end(), [&](const auto& p) { return p.bound > now; });
        std::vector<BoundedPiece> next(rest, pieces.end());
        pieces.erase(rest, pieces.end());
        halved.resize(pieces.size());
        tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
            if (i % kChunk == 0) progress.check();
            const auto measureAt = [this](const Vec3& p) { return sampleAt(p); };
            const std::array<Piece, 2> parts = halves(pieces[i].corners, measureAt);
            for (int k = 0; k < 2; ++k)
                halved[i][k] = bounded(parts[k], measureAt(centroidOf(parts[k])), limit, wanted);
        });
        maximum.samples += 3 * static_cast<std::int64_t>(pieces.size());
        for (const auto& both : halved)
            for (const BoundedPiece& p : both) {
                for (const Sample& corner : p.corners)
                    maximum.found = std::max(maximum.found, corner.distance);
                maximum.found = std::max(maximum.found, p.centroid.distance);
            }
        // A bound of the whole holds for its halves.
        for (std::size_t i = 0; i < halved.size(); ++i)
            for (BoundedPiece& p : halved[i]) {
                p.bound = std::min(p.bound, pieces[i].bound);
                next.push_back(p);
            }
        pieces = std::move(next);
    }
    return maximum;
}

DistanceTarget::DistanceTarget(TriangleMesh mesh) : tree_(std::make_unique<Tree>(std::move(mesh))) {}
DistanceTarget::~DistanceTarget() = default;
DistanceTarget::DistanceTarget(DistanceTarget&&) noexcept = default;
DistanceTarget& DistanceTarget::operator=(DistanceTarget&&) noexcept = default;

double DistanceTarget::distance(const Point& p) const { return tree_->sampleAt(toVec3(p)).distance; }

double DistanceTarget::squaredBeyond(const Point& p, double enough) const {
    return tree_->nearest(toVec3(p), enough).squared;
}

double DistanceTarget::farthestSample(const TriangleMesh& from, double atLeast,
                                      const Progress& progress) const {
    constexpr std::size_t kGrain = 1024;
    const std::size_t points = from.points.size();
    const auto sampleAt = [&](std::size_t i) {
        if (i < points) return from.points[i];
        const auto& [a, b, c] = from.triangles[i - points];
        const Vec3 middle = (toVec3(from.points[a]) + toVec3(from.points[b]) + toVec3(from.points[c])) / 3;
        return Point{middle.x, middle.y, middle.z};
    };
    const double squared = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, points + from.triangles.size(), kGrain), atLeast * atLeast,
        [&](const auto& range, double largest) {
            progress.check();
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                largest = std::max(largest, squaredBeyond(sampleAt(i), largest));
            return largest;
        },
        [](double a, double b) { return std::max(a, b); });
    return std::sqrt(squared);
}

NearestPoint DistanceTarget::nearest(const Point& p) const {
    const std::uint32_t triangle = tree_->sampleAt(toVec3(p)).nearest;
    const Vec3 at = tree_->nearestOn(toVec3(p), triangle);
    return {{at.x, at.y, at.z}, triangle};
}

OneSidedDistance DistanceTarget::distanceFrom(const TriangleMesh& from, double spacing,
                                              const Progress& progress, double enough) const {
    return measured(from, spacing, progress, enough);
}

OneSidedDistance DistanceTarget::sampledDistanceFrom(const TriangleMesh& from, double spacing,
                                                     const Progress& progress) const {
    return measured(from, spacing, progress, std::nullopt);
}

// boundEnough: without it no bound is sought.
OneSidedDistance DistanceTarget::measured(const TriangleMesh& from, double spacing, const Progress& progress,
                                          std::optional<double> boundEnough) const {
    assert(spacing >= 0);
    const double enough = boundEnough.value_or(0);
    if (from.triangles.empty()) return {};

    // A large triangle is cut into millions of samples: a wish to stop is asked for at each, not by the
    // chunk.
    const auto sampleAt = [this, &progress](const Vec3& p) {
        progress.check();
        return tree_->sampleAt(p);
    };
    const std::vector<char> used = usedPoints(from);
    std::vector<Sample> corners(from.points.size());
    forChunks(from.points.size(), progress, "distances of vertices",
              [&](std::size_t first, std::size_t last, auto) {
                  for (std::size_t i = first; i < last; ++i)
                      corners[i] = used[i] ? sampleAt(toVec3(from.points[i])) : Sample{};
              });
    double largestCorner = 0;
    for (const Sample& corner : corners) largestCorner = std::max(largestCorner, corner.distance);

    const double area = areaOf(from), wanted = std::max(enough, kTightnessOfExtent * diagonalOf(from));
    std::optional<GraphBound> graph;
    if (enough > 0) graph.emplace(tree_->mesh);
    std::vector<Sums> sums((from.triangles.size() + kChunk - 1) / kChunk);
    std::vector<UncertainPieces> uncertain(sums.size(), UncertainPieces(std::max(largestCorner, wanted)));
    forChunks(from.triangles.size(), progress, "distances of triangles",
              [&](std::size_t first, std::size_t last, std::size_t chunk) {
                  const auto visit = [&](const Piece& piece, const Sample& centroid) {
                      if (!boundEnough) return;
                      const BoundedPiece bounded =
                          tree_->bounded(piece, centroid, graph ? &*graph : nullptr, wanted);
                      sums[chunk].maxBound = std::max(sums[chunk].maxBound, bounded.bound);
                      uncertain[chunk].add(bounded);
                  };
                  for (std::size_t i = first; i < last; ++i) {
                      const Triangle& t = from.triangles[i];
                      const double weight = area > 0 ? areaOf(from, t) : 1.0;
                      integrate({corners[t[0]], corners[t[1]], corners[t[2]]}, weight, spacing, 0, sampleAt,
                                visit, sums[chunk]);
                  }
              });

    Sums total;
    for (const Sums& s : sums) total.add(s);
    total.samples += std::count(used.begin(), used.end(), 1);
    if (!boundEnough)
        return {total.distance / total.weight,
                std::sqrt(total.square / total.weight),
                total.max,
                std::numeric_limits<double>::infinity(),
                area,
                total.samples,
                rmsErrorOf(total)};

    std::vector<BoundedPiece> pieces;
    double restBound = 0;
    for (UncertainPieces& chunk : uncertain) {
        const std::vector<BoundedPiece> kept = chunk.take();
        pieces.insert(pieces.end(), kept.begin(), kept.end());
        restBound = std::max(restBound, chunk.restBound());
    }
    const std::int64_t most = enough > 0 ? kProvingSamples : std::max(total.samples, kTighteningSamples);
    const Tree::Maximum maximum = tree_->tighten(std::move(pieces), total.max, restBound, wanted,
                                                 graph ? &*graph : nullptr, most, progress);
    return {total.distance / total.weight,
            std::sqrt(total.square / total.weight),
            maximum.found,
            std::min(std::max(maximum.bound, std::min(wanted, total.maxBound)),
                     std::max(total.maxBound, maximum.found)),
            area,
            total.samples + maximum.samples,
            0};
}

// ---- both sides

MeshComparison compareMeshes(const TriangleMesh& a, const TriangleMesh& b, double spacing,
                             const Progress& progress, double enough) {
    for (const auto& [mesh, name] : {std::pair{&a, "first mesh"}, std::pair{&b, "second mesh"}})
        if (mesh->triangles.empty())
            throw InputError(name, "it has no triangle, so there is nothing to compare");

    MeshComparison result;
    result.aToB = DistanceTarget(b).distanceFrom(a, spacing, progress, enough);
    result.bToA = DistanceTarget(a).distanceFrom(b, spacing, progress, enough);

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
