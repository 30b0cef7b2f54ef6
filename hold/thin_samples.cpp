#include "hold/thin_samples.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isowave {
namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

// A vertex on a lattice line along an axis: where on the line, and which of the lines.
struct OnLine {
    std::uint64_t line;  // axis, then the two other lattice coordinates
    double along;
    std::uint32_t vertex;
};

constexpr double kWhole =
    1e-5;  // of a sample edge: polygonize() keeps vertices 1e-3 away from lattice points

// The axis of the lattice edge that a point lies on; -1 for one inside a cell.
int axisOf(const Vec3d& at) {
    int axis = -1, whole = 0;
    for (int a = 0; a < 3; ++a)
        if (std::abs(at[a] - std::round(at[a])) < kWhole)
            ++whole;
        else
            axis = a;
    return whole == 2 ? axis : -1;
}

std::uint64_t lineOf(const Vec3d& at, int axis) {
    constexpr std::int64_t kMiddle = std::int64_t{1} << 30;
    const auto whole = [&](int a) {
        return static_cast<std::uint64_t>(std::llround(at[a]) + kMiddle) & ((std::uint64_t{1} << 31) - 1);
    };
    return static_cast<std::uint64_t>(axis) << 62 | whole((axis + 1) % 3) << 31 | whole((axis + 2) % 3);
}

std::vector<OnLine> verticesOnLines(const FinestSurface& surface) {
    constexpr std::uint64_t kNoLine = ~std::uint64_t{0};
    std::vector<OnLine> found(surface.points.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t v) {
        const Vec3d at = surface.points[v] * surface.refine;
        const int axis = axisOf(at);
        found[v] = {axis < 0 ? kNoLine : lineOf(at, axis), axis < 0 ? 0 : at[axis],
                    static_cast<std::uint32_t>(v)};
    });
    std::erase_if(found, [](const OnLine& v) { return v.line == kNoLine; });
    tbb::parallel_sort(found.begin(), found.end(), [](const OnLine& a, const OnLine& b) {
        return a.line != b.line ? a.line < b.line : a.along < b.along;
    });
    return found;
}

// thickness 0: not thin.
ThinSample sampleBetween(const FinestSurface& surface, const OnLine& in, const OnLine& out, double longest,
                         Side side) {
    ThinSample sample;
    const int axis = static_cast<int>(in.line >> 62);
    const double length = (out.along - in.along) / surface.refine;
    const float sign = side == Side::inside ? 1.0f : -1.0f;
    const Vec3f nIn = sign * surface.normals[in.vertex], nOut = sign * surface.normals[out.vertex];
    if (!(length <= longest) || nIn[axis] >= 0 || nOut[axis] <= 0 || nIn.dot(nOut) > kOppositeNormals)
        return sample;
    sample.normal = (nOut - nIn).unit();
    sample.at = Vec3f((surface.points[in.vertex] + surface.points[out.vertex]) / 2);
    const float share = std::abs(sample.normal[axis]);
    sample.thickness = static_cast<float>(length) * share;
    sample.length = static_cast<float>(length);
    sample.area = share / static_cast<float>(surface.refine * surface.refine);
    sample.partVolume = std::min(surface.partVolume[in.vertex], surface.partVolume[out.vertex]);
    // The wall's normal in the world goes with the inverse of the spacing.
    Vec3d world = Vec3d(sample.normal) / surface.spacing;
    world.normalize();
    sample.thicknessInWorld = static_cast<float>(length * surface.spacing[axis] * std::abs(world[axis]));
    return sample;
}

}  // namespace

FinestSurface surfaceOf(const TriangleMesh& mesh, const MeshComponents& components,
                        const openvdb::math::Transform& transform, int refine) {
    FinestSurface surface;
    surface.refine = refine;
    surface.spacing = transform.voxelSize();
    const std::size_t count = mesh.points.size();
    surface.points.resize(count);
    surface.normals.resize(count);
    surface.partVolume.resize(count);
    const double voxel = transform.baseMap()->determinant();
    const openvdb::Mat3d linear = transform.baseMap()->getAffineMap()->getMat4().getMat3();
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t v) {
        surface.points[v] = transform.worldToIndex(Vec3d(mesh.points[v].data()));
        // index -> world is x M: the gradient in index space is M times that of the world.
        const auto& n = mesh.normals[v];
        surface.normals[v] = Vec3f((linear * Vec3d(n[0], n[1], n[2])).unit());
        const std::uint32_t part = components.of[v];
        if (part != MeshComponents::kNone)
            surface.partVolume[v] = static_cast<float>(std::abs(components.volume[part] / voxel));
    });
    return surface;
}

double areaOf(const FinestSurface& surface) {
    double area = 0;
    for (std::size_t v = 0; v < surface.points.size(); ++v)
        if (const int axis = axisOf(surface.points[v] * surface.refine); axis >= 0)
            area += std::abs(surface.normals[v][axis]);
    return area / (surface.refine * surface.refine);
}

std::vector<ThinSample> thinSamplesOf(const FinestSurface& surface, double longest, Side side,
                                      const Progress& progress) {
    constexpr std::size_t kInPiece = 1 << 16;
    const std::vector<OnLine> vertices = verticesOnLines(surface);
    std::vector<std::vector<ThinSample>> pieces(vertices.size() / kInPiece + 1);
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t piece) {
        progress.check();
        const std::size_t begin = std::max<std::size_t>(1, piece * kInPiece),
                          end = std::min(vertices.size(), (piece + 1) * kInPiece);
        for (std::size_t i = begin; i < end; ++i) {
            if (vertices[i - 1].line != vertices[i].line) continue;
            const ThinSample s = sampleBetween(surface, vertices[i - 1], vertices[i], longest, side);
            if (s.thickness > 0) pieces[piece].push_back(s);
        }
    });
    std::vector<ThinSample> samples;
    samples.reserve(std::accumulate(pieces.begin(), pieces.end(), std::size_t{0},
                                    [](std::size_t n, const auto& piece) { return n + piece.size(); }));
    for (const auto& piece : pieces) samples.insert(samples.end(), piece.begin(), piece.end());
    return samples;
}

namespace {

// The thickness of the sample at which the area, ascending, reaches each of the shares.
std::vector<double> quantiles(const std::vector<ThinSample>& samples, const std::vector<double>& shares,
                              float ThinSample::*thickness) {
    std::vector<std::uint32_t> order(samples.size());
    std::iota(order.begin(), order.end(), 0);
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const float ta = samples[a].*thickness, tb = samples[b].*thickness;
        return ta != tb ? ta < tb : a < b;
    });
    double total = 0, sum = 0;
    for (const ThinSample& s : samples) total += s.area;
    std::vector<double> found(shares.size());
    std::size_t next = 0;
    for (const std::uint32_t i : order) {
        sum += samples[i].area;
        const bool last = i == order.back();
        while (next < shares.size() && (last || sum >= shares[next] * total))
            found[next++] = samples[i].*thickness;
    }
    return found;
}

}  // namespace

std::vector<Thickness> thinnest(const std::vector<ThinSample>& samples, const std::vector<double>& shares) {
    const std::vector<double> voxels = quantiles(samples, shares, &ThinSample::thickness),
                              world = quantiles(samples, shares, &ThinSample::thicknessInWorld);
    std::vector<Thickness> found;
    for (std::size_t i = 0; i < shares.size(); ++i) found.push_back({voxels[i], world[i]});
    return found;
}

}  // namespace isowave
