#include "lod/edit/tool.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "isowave/error.h"
#include "isowave/measure.h"
#include "lod/memory.h"
#include "lod/option_checks.h"
#include "lod/regions/region_distance.h"
#include "lod/voxel_edges.h"
#include "polygonize/specks.h"
#include "volume/blocks.h"
#include "volume/cubic_weights.h"
#include "volume/distance_mesh.h"
#include "volume/fit.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int kLeaf = Leaf::DIM;
constexpr double kLeastHalfWidth = 4;  // voxels of level L, as of any solid

void check(const Ball& ball, const std::string& name) {
    requireFinite(name, ball.centre);
    if (!(ball.radius > 0) || !std::isfinite(ball.radius))
        throw UsageError(fmt::format("{}: radius {:g} is not a number above 0", name, ball.radius));
}

RegionBox sorted(RegionBox box, const std::string& name) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        requireFinite(name, std::array{box.low[axis], box.high[axis]});
        if (box.low[axis] == box.high[axis])
            throw UsageError(
                fmt::format("{}: the box is empty, it has no extent along {}; give two opposite corners",
                            name, "xyz"[axis]));
        if (box.low[axis] > box.high[axis]) std::swap(box.low[axis], box.high[axis]);
    }
    return box;
}

PointBox boundsOf(const Ball& ball) {
    PointBox bounds;
    for (const double sign : {-1.0, 1.0}) {
        Point corner = ball.centre;
        for (double& x : corner) x += sign * ball.radius;
        bounds.add(corner);
    }
    return bounds;
}

double areaOf(const PointBox& box) {
    return 2 *
           (box.extent(0) * box.extent(1) + box.extent(1) * box.extent(2) + box.extent(2) * box.extent(0));
}

double largestSpacing(const openvdb::math::Transform& lattice) {
    const Vec3d size = lattice.voxelSize();
    return std::max({size.x(), size.y(), size.z()});
}

// In index space, widened by `voxels`.
openvdb::CoordBBox indexBox(const PointBox& bounds, const openvdb::math::Transform& lattice, double voxels) {
    openvdb::BBoxd box;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            p[axis] = corner >> axis & 1 ? bounds.high[a] : bounds.low[a];
        }
        box.expand(lattice.worldToIndex(p));
    }
    return {Coord::floor(box.min() - Vec3d(voxels)), Coord::ceil(box.max() + Vec3d(voxels))};
}

void requireExtent(const PointBox& bounds, const openvdb::math::Transform& lattice, const std::string& name) {
    constexpr double kCountable = 1e6;  // voxels that an int surely holds
    for (int corner = 0; corner < 2; ++corner) {
        const Point& p = corner ? bounds.high : bounds.low;
        const Vec3d index = lattice.worldToIndex(Vec3d(p[0], p[1], p[2]));
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(index[axis]) < kCountable))
                throw InputError(name,
                                 fmt::format("reaches {:.3g} voxels far; is it in the units of the solid?",
                                             std::abs(index[axis])));
    }
    const Coord size = indexBox(bounds, lattice, 0).dim();
    const int most = std::max({size.x(), size.y(), size.z()});
    if (most > ToolFunction::kLargest)
        throw InputError(name,
                         fmt::format("is {} voxels of level 0 across, more than {:g}; is it in the units of "
                                     "the solid? Give a smaller one",
                                     most, ToolFunction::kLargest));
}

// A leaf of signed distances, in voxels; or the one value that all of it has.
struct SampledLeaf {
    std::unique_ptr<Leaf> leaf;
    float tile = 0;
};

// distance: signed, world units. Distances in voxels, as fitDistance() takes them.
openvdb::FloatGrid::Ptr sampled(const std::function<double(const Vec3d&)>& distance, const PointBox& bounds,
                                const openvdb::math::Transform& lattice, double halfWidth,
                                const Progress& progress) {
    const double voxel = voxelOf(lattice);
    const auto width = static_cast<float>(halfWidth);
    const double reach = kLeaf / 2 * std::sqrt(3.0) * largestSpacing(lattice) + halfWidth * voxel;
    auto grid = openvdb::FloatGrid::create(width);
    grid->setTransform(lattice.copy());
    grid->setName("tool");
    const auto classify = [&](const Coord& origin, int&) {
        const double middle = distance(lattice.indexToWorld(origin.asVec3d() + Vec3d((kLeaf - 1) / 2.0)));
        if (std::abs(middle) > reach) return SampledLeaf{nullptr, middle < 0 ? -width : width};
        auto leaf = std::make_unique<Leaf>(origin, width, false);
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const Coord point = origin + Leaf::offsetToLocalCoord(n);
            const auto d = static_cast<float>(distance(lattice.indexToWorld(point)) / voxel);
            leaf->setValueOnly(n, std::clamp(d, -width, width));
            leaf->setActiveState(n, std::abs(d) < width);
        }
        return SampledLeaf{std::move(leaf), 0};
    };
    const double margin =
        (halfWidth + 1) * voxel /
        std::min({lattice.voxelSize().x(), lattice.voxelSize().y(), lattice.voxelSize().z()});
    forEachBlock<SampledLeaf>(
        indexBox(bounds, lattice, margin), progress, "sampling the tool", classify, [] { return 0; },
        [&](const Coord& origin, SampledLeaf& made) {
            if (made.leaf)
                grid->tree().addLeaf(made.leaf.release());
            else if (made.tile < 0)
                grid->tree().addTile(1, origin, made.tile, false);
        });
    return grid;
}

// Of one axis, of a leaf of level 0: which control points of level L matter, and by how much.
struct AxisWeights {
    int first = 0, count = 0;
    std::array<int, kLeaf> begin{};
    std::array<std::array<double, 4>, kLeaf> weights{};

    AxisWeights(int origin, int halvings, int shift) {
        const double scale = std::ldexp(1.0, halvings);
        const auto cellOf = [&](int i) { return static_cast<int>(std::floor(i / scale)); };
        first = cellOf(origin) - 1 + shift;
        for (int n = 0; n < kLeaf; ++n) {
            const int i = origin + n, cell = cellOf(i);
            begin[static_cast<std::size_t>(n)] = cell - 1 + shift - first;
            weights[static_cast<std::size_t>(n)] = cubicWeights((i - cell * scale) / scale);
        }
        count = begin[kLeaf - 1] + 4;
    }
    // sum of weights times values[(begin + k) * stride]
    double at(int n, const double* values, int stride) const {
        const auto& w = weights[static_cast<std::size_t>(n)];
        const double* v = values + begin[static_cast<std::size_t>(n)] * stride;
        return w[0] * v[0] + w[1] * v[stride] + w[2] * v[2 * stride] + w[3] * v[3 * stride];
    }
};

// A coarse field at the 512 lattice points of a leaf of level 0, an axis at a time.
void evaluateLeaf(const BSplineField& field, const Coord& origin, const std::array<int, 3>& halvings,
                  const Coord& shift, LeafValues& out) {
    const AxisWeights x(origin.x(), halvings[0], shift.x()), y(origin.y(), halvings[1], shift.y()),
        z(origin.z(), halvings[2], shift.z());
    constexpr int kMost = kLeaf + 3;
    std::array<double, kMost * kMost * kMost> c;
    std::array<double, kMost * kMost * kLeaf> alongZ;
    std::array<double, kMost * kLeaf * kLeaf> alongY;
    const auto accessor = field.controlPoints->getConstUnsafeAccessor();
    for (int i = 0; i < x.count; ++i)
        for (int j = 0; j < y.count; ++j)
            for (int k = 0; k < z.count; ++k)
                c[static_cast<std::size_t>((i * kMost + j) * kMost + k)] =
                    accessor.getValue(Coord(x.first + i, y.first + j, z.first + k));
    for (int i = 0; i < x.count; ++i)
        for (int j = 0; j < y.count; ++j)
            for (int n = 0; n < kLeaf; ++n)
                alongZ[static_cast<std::size_t>((i * kMost + j) * kLeaf + n)] =
                    z.at(n, &c[static_cast<std::size_t>((i * kMost + j) * kMost)], 1);
    for (int i = 0; i < x.count; ++i)
        for (int m = 0; m < kLeaf; ++m)
            for (int n = 0; n < kLeaf; ++n)
                alongY[static_cast<std::size_t>((i * kLeaf + m) * kLeaf + n)] =
                    y.at(m, &alongZ[static_cast<std::size_t>(i * kMost * kLeaf + n)], kLeaf);
    for (int l = 0; l < kLeaf; ++l)
        for (int mn = 0; mn < kLeaf * kLeaf; ++mn)
            out[static_cast<std::size_t>(l * kLeaf * kLeaf + mn)] =
                x.at(l, &alongY[static_cast<std::size_t>(mn)], kLeaf * kLeaf);
}

}  // namespace

std::string textOf(const EditTool& tool) {
    if (const auto* ball = std::get_if<Ball>(&tool))
        return fmt::format("ball:{},{:g}", textOf(ball->centre), ball->radius);
    if (const auto* box = std::get_if<RegionBox>(&tool)) return textOf(box->low) + ":" + textOf(box->high);
    const auto* path = std::get_if<std::filesystem::path>(&tool);
    return path ? path->string() : "a mesh";
}

openvdb::math::Transform::Ptr latticeOf(const openvdb::math::Transform& finest,
                                        const std::array<int, 3>& halvings) {
    auto lattice = finest.copy();
    const auto [x, y, z] = halvings;
    if (x == y && y == z)
        lattice->preScale(std::ldexp(1.0, x));
    else
        lattice->preScale(Vec3d(std::ldexp(1.0, x), std::ldexp(1.0, y), std::ldexp(1.0, z)));
    return lattice;
}

double voxelOf(const openvdb::math::Transform& lattice) { return std::cbrt(nodeVolume(lattice)); }

ToolFunction::ToolFunction(const EditTool& tool, const std::string& name,
                           const openvdb::math::Transform& lattice, const std::array<int, 3>& halvings,
                           double reach, const Room& room, const Progress& progress)
    : lattice_(lattice.copy()), reach_(reach), halvings_(halvings) {
    if (const auto* ball = std::get_if<Ball>(&tool)) {
        check(*ball, name);
        bounds_ = boundsOf(*ball);
        volume_ = 4.0 / 3 * std::numbers::pi * std::pow(ball->radius, 3);
        area_ = 4 * std::numbers::pi * std::pow(ball->radius, 2);
        analytic_ = [c = Vec3d(ball->centre.data()), r = ball->radius](const Vec3d& p) {
            return (p - c).length() - r;
        };
    } else if (const auto* given = std::get_if<RegionBox>(&tool)) {
        const RegionBox box = sorted(*given, name);
        bounds_.add(box.low), bounds_.add(box.high);
        volume_ = bounds_.extent(0) * bounds_.extent(1) * bounds_.extent(2);
        area_ = areaOf(bounds_);
        analytic_ = [box](const Vec3d& p) { return distanceTo(box, p); };
    } else {
        const auto* path = std::get_if<std::filesystem::path>(&tool);
        mesh_ = path ? closedMesh(*path, "tool", progress)
                     : closedMesh(std::get<TriangleMesh>(tool), "tool", progress);
        bounds_ = boxAround(mesh_->mesh);
        const MeshTopology topology = topologyOf(mesh_->mesh);
        volume_ = std::abs(topology.volume);
        area_ = topology.area;
    }
    requireExtent(bounds_, lattice, name);
    const auto ofLevel = latticeOf(lattice, halvings);
    // Cubes as large as voxels of both, and their longest edges.
    const double scale = std::exp2((halvings[0] + halvings[1] + halvings[2]) / 3.0),
                 longest = largestSpacing(*ofLevel) / largestSpacing(lattice);
    const double halfWidth = std::max(kLeastHalfWidth, std::ceil((reach + 2) / scale) + 1);
    refuseTooLarge(name, bytesFor(room, halfWidth), room.bytes, "give a smaller one");
    const openvdb::FloatGrid::Ptr distances =
        mesh_ ? distanceFromMesh(mesh_->mesh, *ofLevel, halfWidth, mesh_->evenOdd, progress)
              : sampled(analytic_, bounds_, *ofLevel, halfWidth, progress);
    sampled_ = fitDistance(*distances, {.halfWidth = halfWidth, .band = halfWidth, .K = halfWidth * scale},
                           nullptr, progress);
    shift_ = Coord::round(sampled_.transform().worldToIndex(ofLevel->indexToWorld(Vec3d(0))));
    margin_ = (reach + 2 * longest) * largestSpacing(lattice);
}

// One after the other: sampling holds the band of level L; uniting what is inside, too; the new field and its pyramid the band of level 0.
double ToolFunction::bytesFor(const Room& room, double halfWidth) const {
    const double finest = voxelOf(*lattice_), ofLevel = voxelOf(*latticeOf(*lattice_, halvings_));
    double area = area_, volume = volume_;
    if (room.solid) {
        PointBox both;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            both.low[axis] = std::max(bounds_.low[axis], room.solid->low[axis]);
            both.high[axis] = std::max(both.low[axis], std::min(bounds_.high[axis], room.solid->high[axis]));
        }
        volume = std::min(volume, both.extent(0) * both.extent(1) * both.extent(2));
        if (!mesh_) area = std::min(area, areaOf(both));  // convex
    }
    const double sampled = kBytesPerToolSample * 2 * halfWidth * area_ / (ofLevel * ofLevel),
                 near = kBytesPerToolPoint * 2 * reach_ * area / (finest * finest),
                 inside = kBytesPerPointInTool * volume / (finest * finest * finest);
    return std::max({sampled, near, inside});
}

double ToolFunction::distance(const Vec3d& world, double most) const {
    if (!mesh_) return std::abs(analytic_(world));
    const double bound = 1.0001 * most;
    return std::sqrt(mesh_->nearest->nearest(world, {bound * bound, -1}).squared);
}

// Of a cube of lattice points: where its middle is farther from the surface than its corners are from it, all of it is on one side.
Operand::Side ToolFunction::sideOf(const Coord& origin, int size) const {
    const Vec3d middle = origin.asVec3d() + Vec3d((size - 1) / 2.0);
    const double far = size / 2.0 * std::sqrt(3.0) * largestSpacing(*lattice_) + margin_;
    if (distance(lattice_->indexToWorld(middle), far) <= far) return Side::mixed;
    const Vec3d level(std::ldexp(1.0, -halvings_[0]), std::ldexp(1.0, -halvings_[1]),
                      std::ldexp(1.0, -halvings_[2]));
    const Vec3d coarse = middle * level + shift_.asVec3d();
    return evaluate(sampled_, coarse) < 0 ? Side::inside : Side::outside;
}

std::vector<Coord> ToolFunction::leaves(const Progress& progress) const {
    constexpr int kCube = 8 * kLeaf;
    const double margin = margin_ / shortestVoxel(*lattice_);
    const openvdb::CoordBBox box = indexBox(bounds_, *lattice_, margin);
    const Coord low = box.min() & ~(kCube - 1);
    std::vector<Coord> origins;
    for (int x = low.x(); x <= box.max().x(); x += kCube)
        for (int y = low.y(); y <= box.max().y(); y += kCube)
            for (int z = low.z(); z <= box.max().z(); z += kCube) {
                progress.check();
                if (sideOf(Coord(x, y, z), kCube) == Side::outside) continue;
                for (int n = 0; n < 512; ++n)
                    origins.push_back(
                        Coord(x, y, z).offsetBy(kLeaf * (n >> 6), kLeaf * (n >> 3 & 7), kLeaf * (n & 7)));
            }
    return origins;
}

Operand::Side ToolFunction::values(const Coord& origin, LeafValues& values) const {
    const Side side = sideOf(origin, kLeaf);
    if (side != Side::mixed) return side;
    evaluateLeaf(sampled_, origin, halvings_, shift_, values);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (*least >= reach_) return Side::outside;
    return *most <= -reach_ ? Side::inside : Side::mixed;
}

}  // namespace isowave::lod
