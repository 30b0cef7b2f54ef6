#include "view/distances.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "curves2d/segment_tree.h"
#include "volume/mesh_nearest.h"

namespace isowave::view {
namespace {

openvdb::Vec3d vectorOf(const Point& p) { return {p[0], p[1], p[2]}; }

std::vector<openvdb::Vec3d> vectorsOf(const std::vector<Point>& points) {
    std::vector<openvdb::Vec3d> result(points.size());
    std::transform(points.begin(), points.end(), result.begin(), vectorOf);
    return result;
}

// Distances with weights, added up in the order in which they come.
struct Samples {
    std::vector<float> distances;
    std::vector<double> weights;

    void add(float distance, double weight) {
        distances.push_back(distance);
        weights.push_back(weight);
    }
    void summarize(DistanceSummary& summary) const {
        double sum = 0, all = 0;
        for (std::size_t i = 0; i < distances.size(); ++i) {
            sum += weights[i] * distances[i] * distances[i];
            all += weights[i];
            summary.max = std::max<double>(summary.max, distances[i]);
        }
        summary.rms = all > 0 ? std::sqrt(sum / all) : 0;
        summary.histogram.assign(DistanceSummary::kBins, 0);
        if (all == 0) return;
        for (std::size_t i = 0; i < distances.size(); ++i)
            summary.histogram[binOf(distances[i], summary.max)] += weights[i] / all;
    }
    static std::size_t binOf(double distance, double max) {
        if (max == 0) return 0;
        return std::min<std::size_t>(static_cast<std::size_t>(distance / max * DistanceSummary::kBins),
                                     DistanceSummary::kBins - 1);
    }
};

double areaOf(const TriangleMesh& mesh, const Triangle& t) {
    const openvdb::Vec3d a = vectorOf(mesh.points[t[0]]);
    return (vectorOf(mesh.points[t[1]]) - a).cross(vectorOf(mesh.points[t[2]]) - a).length() / 2;
}

openvdb::Vec3d centroidOf(const TriangleMesh& mesh, const Triangle& t) {
    return (vectorOf(mesh.points[t[0]]) + vectorOf(mesh.points[t[1]]) + vectorOf(mesh.points[t[2]])) / 3;
}

}  // namespace

// ---- surfaces

struct SurfaceDistance::Tree {
    TriangleHierarchy triangles;

    double at(const openvdb::Vec3d& p) const {
        return std::sqrt(triangles.nearest(p, triangles.distanceTo(0, p)).squared);
    }
};

SurfaceDistance::SurfaceDistance(const TriangleMesh& reference)
    : tree_(std::make_unique<Tree>(
          Tree{TriangleHierarchy(vectorsOf(reference.points), reference.triangles)})) {}
SurfaceDistance::~SurfaceDistance() = default;

namespace {

// measure(0), ..., measure(count - 1), in any order.
template <class Measure>
void each(std::size_t count, const Progress& progress, const Measure& measure) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i < range.end(); ++i) measure(i);
    });
}

}  // namespace

std::vector<float> SurfaceDistance::ofVertices(const TriangleMesh& mesh, const Progress& progress) const {
    std::vector<float> distances(mesh.points.size(), 0);
    std::vector<char> used(mesh.points.size(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) used[v] = 1;
    progress("measure", 0);
    each(mesh.points.size(), progress, [&](std::size_t v) {
        if (used[v]) distances[v] = static_cast<float>(tree_->at(vectorOf(mesh.points[v])));
    });
    return distances;
}

DistanceSummary SurfaceDistance::of(const TriangleMesh& mesh, const Progress& progress) const {
    DistanceSummary summary;
    summary.ofVertex = ofVertices(mesh, progress);
    std::vector<float> atCentroid(mesh.triangles.size());
    each(mesh.triangles.size(), progress, [&](std::size_t t) {
        atCentroid[t] = static_cast<float>(tree_->at(centroidOf(mesh, mesh.triangles[t])));
    });
    Samples samples;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const double twelfth = areaOf(mesh, mesh.triangles[t]) / 12;
        for (const std::uint32_t v : mesh.triangles[t]) samples.add(summary.ofVertex[v], twelfth);
        samples.add(atCentroid[t], 9 * twelfth);
    }
    samples.summarize(summary);
    return summary;
}

// ---- lines

struct CurveDistance::Tree {
    curves2d::SegmentTree segments;
};

namespace {

std::vector<curves2d::Segment> segmentsOf(const Rings& rings) {
    std::vector<curves2d::Segment> segments;
    for (const auto& ring : rings)
        for (std::size_t i = 0; i < ring.size(); ++i)
            segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
    return segments;
}

}  // namespace

CurveDistance::CurveDistance(const Rings& reference)
    : tree_(std::make_unique<Tree>(Tree{curves2d::SegmentTree(segmentsOf(reference))})) {}
CurveDistance::~CurveDistance() = default;

DistanceSummary CurveDistance::of(const Rings& rings) const {
    DistanceSummary summary;
    const auto distance = [&](curves2d::Point p) { return static_cast<float>(tree_->segments.distance(p)); };
    for (const auto& ring : rings)
        for (const curves2d::Point& p : ring) summary.ofVertex.push_back(distance(p));
    Samples samples;
    std::size_t first = 0;
    for (const auto& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const std::size_t next = (i + 1) % ring.size();
            const curves2d::Point a = ring[i], b = ring[next];
            const double sixth = std::hypot(b.x - a.x, b.y - a.y) / 6;
            samples.add(summary.ofVertex[first + i], sixth);
            samples.add(summary.ofVertex[first + next], sixth);
            samples.add(distance({(a.x + b.x) / 2, (a.y + b.y) / 2}), 4 * sixth);
        }
        first += ring.size();
    }
    samples.summarize(summary);
    return summary;
}

}  // namespace isowave::view
