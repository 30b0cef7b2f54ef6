#include "lod/dry_run/wall_thickness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hold/thin_samples.h"
#include "volume/mesh_nearest.h"

namespace isowave::lod {
namespace {

using openvdb::Vec3d;

constexpr std::size_t kSamples = 10'000;

struct SurfacePoint {
    Vec3d at, normal;  // unit, outwards
};

Vec3d corner(const TriangleMesh& mesh, const Triangle& t, int k) { return Vec3d(mesh.points[t[k]].data()); }

Vec3d areaVector(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3d a = corner(mesh, t, 0);
    return 0.5 * (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a);
}

// The k-th of a sequence that fills the triangle evenly: the R2 sequence of Roberts, folded along the diagonal.
Vec3d pointIn(const TriangleMesh& mesh, const Triangle& t, std::size_t k) {
    constexpr double kPlastic = 1.32471795724474602596;
    double u = std::fmod(0.5 + static_cast<double>(k) / kPlastic, 1.0);
    double v = std::fmod(0.5 + static_cast<double>(k) / (kPlastic * kPlastic), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3d a = corner(mesh, t, 0);
    return a + u * (corner(mesh, t, 1) - a) + v * (corner(mesh, t, 2) - a);
}

// One point for each equal share of the area.
std::vector<SurfacePoint> spreadOver(const TriangleMesh& mesh) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += areaVector(mesh, t).length();
    std::vector<SurfacePoint> points;
    points.reserve(kSamples);
    double before = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3d vector = areaVector(mesh, t);
        const double after = before + vector.length();
        while (points.size() < kSamples &&
               (static_cast<double>(points.size()) + 0.5) / kSamples * area < after)
            points.push_back({pointIn(mesh, t, points.size()), vector.unit()});
        before = after;
    }
    return points;
}

// Nothing where no wall ends at the point, or the ray grazes the surface for long.
std::optional<double> thicknessAt(const SurfacePoint& p, const TriangleHierarchy& mesh, double diagonal) {
    constexpr int kMostSteps = 256;
    constexpr double kFirst =
        1e-7;  // of the diagonal; the distance to p's own triangle then doubles from step to step
    constexpr double kMet = 1e-4;  // of the way: so near, the ray has met the surface
    double way = kFirst * diagonal, bound = way;
    for (int i = 0; i < kMostSteps && way < diagonal; ++i) {
        const Vec3d at = p.at - way * p.normal;
        const auto nearest = mesh.nearest(at, {1.0001 * bound * bound, -1});
        if (nearest.triangle < 0) return std::nullopt;
        const double distance = std::sqrt(nearest.squared);
        if (distance <= kMet * way) {
            Vec3d normal = mesh.areaNormal(nearest.triangle);
            if (!normal.normalize() || normal.dot(p.normal) > kOppositeNormals) return std::nullopt;
            return (p.normal - normal).dot(p.at - mesh.footOn(nearest.triangle, at)) / 2;
        }
        way += distance;
        bound = 2 * distance;  // of the next point
    }
    return std::nullopt;
}

double diagonalOf(const std::vector<Vec3d>& points) {
    openvdb::BBoxd box;
    for (const Vec3d& p : points) box.expand(p);
    return box.extents().length();
}

// Values -> of the thinnest shares. REQUIRES: at least one value.
std::vector<double> quantiles(std::vector<double> values, const std::vector<double>& shares) {
    std::sort(values.begin(), values.end());
    std::vector<double> result;
    for (const double share : shares)
        result.push_back(values[std::min(
            values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))]);
    return result;
}

// ---- voxels

constexpr int kLongestRun = 255;

// Runs along an axis: `shortest` of each voxel becomes its run's length where that is less.
void shortenBy(const InsideVoxels& voxels, int axis, std::vector<std::uint8_t>& shortest) {
    const std::array<std::int64_t, 3> stride{1, voxels.size[0], voxels.size[0] * voxels.size[1]};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::int64_t length = voxels.size[axis], step = stride[axis];
    tbb::parallel_for(std::int64_t{0}, voxels.size[u] * voxels.size[v], [&](std::int64_t line) {
        const std::int64_t start = line % voxels.size[u] * stride[u] + line / voxels.size[u] * stride[v];
        for (std::int64_t i = 0, end = 0; i < length; i = end + 1) {
            for (end = i; end < length && voxels.inside[start + end * step]; ++end) {
            }
            const auto run = static_cast<std::uint8_t>(std::min<std::int64_t>(end - i, kLongestRun));
            for (; i < end; ++i) shortest[start + i * step] = std::min(shortest[start + i * step], run);
        }
    });
}

class Counter {
  public:
    explicit Counter(const InsideVoxels& voxels) : voxels_(voxels) {}

    bool at(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto& n = voxels_.size;
        return x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2] &&
               voxels_.inside[voxels_.index(x, y, z)];
    }
    int facesOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return 6 - at(x - 1, y, z) - at(x + 1, y, z) - at(x, y - 1, z) - at(x, y + 1, z) - at(x, y, z - 1) -
               at(x, y, z + 1);
    }
    // Of the cell whose least corner this is.
    bool isMixed(std::int64_t x, std::int64_t y, std::int64_t z) const {
        int inside = 0;
        for (int k = 0; k < 8; ++k) inside += at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
        return inside > 0 && inside < 8;
    }

  private:
    const InsideVoxels& voxels_;
};

// Of one slice.
struct SliceFacts {
    std::int64_t cells = 0;
    std::array<std::int64_t, kLongestRun + 1> facesByRun{};
    std::array<std::int64_t, 3> low{INT64_MAX, INT64_MAX, INT64_MAX}, high{-1, -1, -1};
};

SliceFacts factsOfSlice(const InsideVoxels& voxels, const std::vector<std::uint8_t>& shortest,
                        std::int64_t z) {
    SliceFacts facts;
    const Counter counter(voxels);
    for (std::int64_t y = -1; y < voxels.size[1]; ++y)
        for (std::int64_t x = -1; x < voxels.size[0]; ++x) {
            facts.cells += counter.isMixed(x, y, z);
            if (!counter.at(x, y, z)) continue;
            facts.facesByRun[shortest[voxels.index(x, y, z)]] += counter.facesOf(x, y, z);
            const std::array<std::int64_t, 3> at{x, y, z};
            for (int a = 0; a < 3; ++a) {
                facts.low[a] = std::min(facts.low[a], at[a]);
                facts.high[a] = std::max(facts.high[a], at[a]);
            }
        }
    return facts;
}

std::vector<double> runsOf(const std::array<std::int64_t, kLongestRun + 1>& facesByRun, std::int64_t faces,
                           const std::vector<double>& shares) {
    std::vector<double> runs;
    for (const double share : shares) {
        std::int64_t sum = 0;
        int run = 0;
        while (run < kLongestRun &&
               static_cast<double>(sum += facesByRun[run]) <= share * static_cast<double>(faces))
            ++run;
        runs.push_back(run);
    }
    return runs;
}

}  // namespace

std::vector<double> thinnestWalls(const TriangleMesh& mesh, const std::vector<double>& shares,
                                  const Progress& progress) {
    std::vector<Vec3d> points;
    points.reserve(mesh.points.size());
    for (const Point& p : mesh.points) points.emplace_back(p.data());
    const TriangleHierarchy hierarchy(points, mesh.triangles);
    const std::vector<SurfacePoint> samples = spreadOver(mesh);
    const double diagonal = diagonalOf(points);
    std::vector<std::optional<double>> found(samples.size());
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        progress.check();
        found[i] = thicknessAt(samples[i], hierarchy, diagonal);
    });
    std::vector<double> thickness;
    for (const auto& t : found)
        if (t) thickness.push_back(*t);
    return thickness.empty() ? std::vector<double>() : quantiles(std::move(thickness), shares);
}

VoxelFacts factsOf(const InsideVoxels& voxels, const std::vector<double>& shares, const Progress& progress) {
    std::vector<std::uint8_t> shortest(voxels.inside.size(), kLongestRun);
    for (int axis = 0; axis < 3; ++axis) {
        progress.check();
        shortenBy(voxels, axis, shortest);
    }
    std::vector<SliceFacts> slices(static_cast<std::size_t>(voxels.size[2]) + 1);  // from z = -1 on
    tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t i) {
        progress.check();
        slices[i] = factsOfSlice(voxels, shortest, static_cast<std::int64_t>(i) - 1);
    });
    VoxelFacts facts;
    SliceFacts sum;
    for (const SliceFacts& slice : slices) {
        facts.cells += slice.cells;
        for (int run = 0; run <= kLongestRun; ++run) sum.facesByRun[run] += slice.facesByRun[run];
        for (int a = 0; a < 3; ++a) {
            sum.low[a] = std::min(sum.low[a], slice.low[a]);
            sum.high[a] = std::max(sum.high[a], slice.high[a]);
        }
    }
    for (const std::int64_t faces : sum.facesByRun) facts.faces += faces;
    facts.low = sum.low;
    facts.high = sum.high;
    if (facts.faces > 0) facts.walls = runsOf(sum.facesByRun, facts.faces, shares);
    return facts;
}

}  // namespace isowave::lod
