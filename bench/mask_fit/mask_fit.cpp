// mask_fit: what is left of known solids whose masks are fitted, as a markdown table: marching cubes of the mask and the
// three fits of volume/.
//
// Each cell: volume against the voxels in %, rms angle between the surface's normals and the solid's in degrees, rms
// distance to the solid in voxels; over triangles by area, at their centroids, of the mesh at refine 4 (marching cubes: of
// its own triangles). Ends of rods and rims of sheets are left out. Then for fitMask: volume of the default mesh (refine 1),
// signs that are wrong before the repair, and below the table the time of one thread for each control point.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <ctime>
#include <iostream>
#include <numbers>
#include <optional>
#include <random>

#include "base/triangle.h"
#include "bench/fidelity/marching.h"
#include "isowave/measure.h"
#include "polygonize/polygonize.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/fit/fit_mask.h"
#include "volume/nodes.h"

namespace {

using namespace isowave;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

struct Truth {
    double distance;
    Vec3d normal;
};

struct MaskOf {
    std::string name;
    CoordBBox box;
    std::function<bool(const Vec3d&)> inside;
    std::function<Truth(const Vec3d&)> truth = {};  // none: volumes alone
    std::function<bool(const Vec3d&)> judged = {};  // where normals and distances count; none: everywhere
    bool closed = true;                             // a mask whose volume means something
};

CoordBBox cube(int half) { return {Coord(-half), Coord(half)}; }

MaskOf ball(double r, const Vec3d& o) {
    return {fmt::format("ball {:g}, off centre", r), cube(static_cast<int>(r) + 3),
            [=](const Vec3d& p) { return (p - o).length() < r; },
            [=](const Vec3d& p) {
                return Truth{(p - o).length() - r, (p - o).unit()};
            }};
}

MaskOf rod(const std::string& name, double r, const Vec3d& direction, const Vec3d& o) {
    const Vec3d a = direction.unit();
    const auto off = [=](const Vec3d& p) { return (p - o) - (p - o).dot(a) * a; };
    const auto along = [=](const Vec3d& p) { return std::abs((p - o).dot(a)); };
    return {name, cube(20 + static_cast<int>(r)),
            [=](const Vec3d& p) { return off(p).length() < r && along(p) < 15; },
            [=](const Vec3d& p) {
                return Truth{off(p).length() - r, off(p).unit()};
            },
            [=](const Vec3d& p) { return along(p) < 11; }};
}

MaskOf shell(const Vec3d& o) {
    return {"shell of 1 voxel, radius 10", cube(13),
            [=](const Vec3d& p) { return std::abs((p - o).length() - 10) < 0.5; },
            [=](const Vec3d& p) {
                const double d = (p - o).length() - 10;
                return Truth{std::abs(d) - 0.5, (d < 0 ? -1.0 : 1.0) * (p - o).unit()};
            }};
}

MaskOf sheet(const std::string& name, double t, const Vec3d& direction) {
    const Vec3d n = direction.unit(), u = n.cross(Vec3d(1, 0, 0)).unit(), w = n.cross(u);
    const auto wide = [=](const Vec3d& p) { return std::max(std::abs(p.dot(u)), std::abs(p.dot(w))); };
    const auto across = [=](const Vec3d& p) { return p.dot(n) - 0.2; };
    return {name, cube(21), [=](const Vec3d& p) { return std::abs(across(p)) < t / 2 && wide(p) < 13; },
            [=](const Vec3d& p) {
                return Truth{std::abs(across(p)) - t / 2, (across(p) < 0 ? -1.0 : 1.0) * n};
            },
            [=](const Vec3d& p) { return wide(p) < 9; }};
}

MaskOf block(const std::string& name, const Coord& size) {
    return {name, CoordBBox(Coord(0), size.offsetBy(-1)), [](const Vec3d&) { return true; }};
}

MaskOf plane(const std::string& name, const Vec3d& direction) {
    const Vec3d n = direction.unit();
    return {name,
            cube(24),
            [=](const Vec3d& p) { return p.dot(n) < 0.3; },
            [=](const Vec3d& p) {
                return Truth{p.dot(n) - 0.3, n};
            },
            [](const Vec3d& p) {
                return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < 12;
            },
            false};
}

MaskOf noise() {
    const auto random = std::make_shared<std::vector<bool>>();
    std::mt19937_64 engine(5);
    for (int i = 0; i < 24 * 24 * 24; ++i) random->push_back(engine() & 1);
    return {"white noise, 50 %", CoordBBox(Coord(0), Coord(23)), [random](const Vec3d& p) {
                return bool((*random)[static_cast<std::size_t>((p[0] * 24 + p[1]) * 24 + p[2])]);
            }};
}

std::vector<MaskOf> masks() {
    const Vec3d o(0.137, -0.231, 0.342), diagonal(1, 2, 5);
    return {ball(3, o),
            ball(5, o),
            ball(10, o),
            rod("rod 1.5 along an axis", 1.5, {0, 0, 1}, Vec3d(0)),
            rod("rod 1.5 along (1,2,5)", 1.5, diagonal, o),
            rod("rod 5 along (0,1,10)", 5, {0, 1, 10}, o),
            block("sheet of 1 voxel, 24 x 24", {24, 24, 1}),
            block("sheet of 2 voxels, 24 x 24", {24, 24, 2}),
            shell(Vec3d(0)),
            shell(o),
            sheet("sheet 1 across (1,2,5)", 1, diagonal),
            sheet("sheet 2.5 across (1,2,5)", 2.5, diagonal),
            block("cube 16", {16, 16, 16}),
            block("one voxel", {1, 1, 1}),
            noise(),
            plane("plane (1,2,5)", diagonal),
            plane("plane (1,3,20)", {1, 3, 20}),
            plane("plane (0,1,10)", {0, 1, 10})};
}

struct Measured {
    std::optional<double> volume, angle, distance;
    std::string text() const {
        const auto or_ = [](const std::optional<double>& v, const char* format) {
            return v ? fmt::format(fmt::runtime(format), *v) : std::string("-");
        };
        return fmt::format("{} {} {}", or_(volume, "{:+.1f}"), or_(angle, "{:.1f}"), or_(distance, "{:.3f}"));
    }
};

// normalAt(centroid, areaNormal): of the surface.
template <class NormalAt>
Measured measured(const TriangleMesh& mesh, const MaskOf& mask, double voxels, const NormalAt& normalAt) {
    Measured result;
    if (mask.closed) result.volume = 100 * (topologyOf(mesh).volume / voxels - 1);
    if (!mask.truth) return result;
    double area = 0, angles = 0, distances = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 normal = areaNormal(mesh, t);
        const Vec3d p = (Vec3d(mesh.points[t[0]].data()) + Vec3d(mesh.points[t[1]].data()) +
                         Vec3d(mesh.points[t[2]].data())) /
                        3.0;
        if (mask.judged && !mask.judged(p)) continue;
        const Truth truth = mask.truth(p);
        const double a = length(normal) / 2;
        const double cosine = normalAt(p, Vec3d(normal.x, normal.y, normal.z)).unit().dot(truth.normal);
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
        area += a, angles += a * angle * angle, distances += a * truth.distance * truth.distance;
    }
    result.angle = std::sqrt(angles / area);
    result.distance = std::sqrt(distances / area);
    return result;
}

Measured measured(const BSplineField& field, const MaskOf& mask, double voxels) {
    return measured(polygonize(field, {.refine = 4}), mask, voxels, [&](const Vec3d& p, const Vec3d&) {
        return evaluateGradient(field, field.transform().worldToIndex(p));
    });
}

openvdb::FloatGrid::Ptr distanceOf(const MaskOf& mask) {
    Image image;
    const Coord size = mask.box.dim(), low = mask.box.min();
    image.size = {size[0], size[1], size[2]};
    image.indexToWorld.origin = {double(low[0]), double(low[1]), double(low[2])};
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x)
                image.values.push_back(mask.inside(low.offsetBy(x, y, z).asVec3d()) ? 1.0f : 0.0f);
    return distanceFromImage(image, {.iso = 0.5}, 4);
}

TriangleMesh marchingCubesOf(const MaskOf& mask) {
    bench::DenseField field{mask.box, {}};
    field.box.expand(1);
    for (auto c = field.box.begin(); c; ++c)
        field.values.push_back(mask.box.isInside(*c) && mask.inside((*c).asVec3d()) ? -1.0f : 1.0f);
    return bench::marchingCubes(field);
}

void printRow(const MaskOf& mask) {
    const NodeCollection nodes =
        nodesFromFunction([&](const Coord& c) { return mask.inside(c.asVec3d()); }, mask.box);
    double voxels = 0;
    for (auto c = mask.box.begin(); c; ++c) voxels += mask.inside((*c).asVec3d());
    FitReport before;
    fitMask(nodes, {.mostRepairPasses = 0}, &before);
    const BSplineField field = fitMask(nodes);
    const auto own = [](const Vec3d&, const Vec3d& normal) { return normal; };
    const Measured coarse = measured(polygonize(field), mask, voxels, own);
    std::cout << fmt::format("| {} | {} | {} | {} | **{}** | {} | {} |", mask.name,
                             measured(marchingCubesOf(mask), mask, voxels, own).text(),
                             measured(fitBinary(nodes), mask, voxels).text(),
                             measured(fitDistance(*distanceOf(mask)), mask, voxels).text(),
                             measured(field, mask, voxels).text(),
                             coarse.volume ? fmt::format("{:+.1f}", *coarse.volume) : "-", before.disagreeing)
              << std::endl;
}

template <class Fit>
double microseconds(const Fit& fit) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    double best = 1e9;
    for (int i = 0; i < 2; ++i) {
        const std::clock_t begin = std::clock();  // of this process alone
        const BSplineField field = fit();
        const double taken = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        best = std::min(best, 1e6 * taken / static_cast<double>(field.controlPointCount()));
    }
    return best;
}

void printTime(const MaskOf& mask) {
    const NodeCollection nodes =
        nodesFromFunction([&](const Coord& c) { return mask.inside(c.asVec3d()); }, mask.box);
    std::cout << fmt::format("{}: {:.2f} (binary {:.2f})\n", mask.name,
                             microseconds([&] { return fitMask(nodes); }),
                             microseconds([&] { return fitBinary(nodes); }))
              << std::flush;
}

}  // namespace

int main(int argc, char** argv) {
    initializeVdb();
    const bool timesAlone = argc > 1 && std::string(argv[1]) == "--times";
    if (!timesAlone) {
        std::cout << "| | marching cubes | `binary` | `distance` | `mask` | refine 1 | wrong signs |\n"
                     "|---|---|---|---|---|---|---|\n";
        for (const MaskOf& mask : masks()) printRow(mask);
    }
    std::cout << "\nMicroseconds a control point, one thread:\n";
    for (const MaskOf& mask :
         {ball(60, Vec3d(0.137, -0.231, 0.342)), plane("plane (1,3,20)", {1, 3, 20}), noise()})
        printTime(mask);
    return 0;
}
