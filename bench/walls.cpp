// walls [plates|tubes|balls|FILE [VOXELS]]: what a field fitted to a mesh makes of thin walls, as markdown tables;
// without an argument plates, tubes and balls. FILE: a closed mesh.
//   plain   quasi-interpolated distances alone
//   walls   with fitWalls() (volume/walls/wall_fit.h)
// volume: of the mesh at the given refine, against the input mesh's own.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>

#include "io/mesh/read.h"
#include "isowave/measure.h"
#include "polygonize/polygonize.h"
#include "volume/distance_mesh.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"
#include "volume/walls/wall_fit.h"

namespace {

using namespace isowave;
using openvdb::Vec3d;

struct Fitted {
    BSplineField field;
    WallFitReport walls;
    FitReport fit;
    double seconds = 0;  // of fitWalls
};

double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Distances {
    openvdb::FloatGrid::Ptr grid;
    std::vector<Vec3d> points;  // in its index space
    double seconds = 0;
};

Distances distancesOf(const TriangleMesh& mesh, const openvdb::math::Transform& transform,
                      bool evenOdd = false) {
    Distances distances;
    const auto start = std::chrono::steady_clock::now();
    distances.grid = distanceFromMesh(mesh, transform, 4, evenOdd);
    distances.seconds = secondsSince(start);
    for (const Point& p : mesh.points) distances.points.push_back(transform.worldToIndex(Vec3d(p.data())));
    return distances;
}

Fitted fitted(const TriangleMesh& mesh, const Distances& distances, bool walls, int refine) {
    Fitted result;
    DistanceFitOptions options;
    if (walls)
        options.adjust = [&](BSplineField& field, const openvdb::Coord& shift) {
            const auto start = std::chrono::steady_clock::now();
            result.walls = fitWalls(field, distances.grid->tree(), shift, distances.points, mesh.triangles,
                                    {.refine = refine});
            result.seconds = secondsSince(start);
        };
    result.field = fitDistance(*distances.grid, options, &result.fit);
    return result;
}

MeshTopology meshOf(const BSplineField& field, int refine) {
    return topologyOf(polygonize(field, {.refine = refine}));
}

std::string textOf(const MeshTopology& mesh, double volume) {
    if (mesh.triangles == 0) return "gone";
    return fmt::format("{:+.1f} {}/{}/{}", 100 * (mesh.volume / volume - 1), mesh.parts, mesh.genus,
                       mesh.cavities);
}

// ---- plates

// Twelve triangles; corners turned by columns.
TriangleMesh boxOf(const Vec3d& half, const openvdb::math::Mat3d& turn, const Vec3d& middle) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner(i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                           i & 4 ? half[2] : -half[2]);
        const Vec3d p = turn * corner + middle;
        mesh.points.push_back({p[0], p[1], p[2]});
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

// A turn by `degrees` about an axis that lies along no lattice direction in the plane of the plate.
openvdb::math::Mat3d tilted(double degrees) {
    return openvdb::math::rotation<openvdb::math::Mat3d>(Vec3d(0.958, -0.287, 0).unit(),
                                                         degrees * std::numbers::pi / 180);
}

// Volume of the plate where its rim has no say, by F's sign along normals 0.005 apart from M places: %.
double thicknessError(const BSplineField& field, const openvdb::math::Mat3d& turn, const Vec3d& middle,
                      double t) {
    constexpr double kStep = 0.005;
    double inside = 0, places = 0;
    for (double x = -4; x <= 4; x += 0.73)
        for (double y = -4; y <= 4; y += 0.73, ++places)
            for (double z = -t / 2 - 1.2; z < t / 2 + 1.2; z += kStep)
                inside += evaluate(field, field.transform().worldToIndex(turn * Vec3d(x, y, z) + middle)) < 0;
    return 100 * (inside * kStep / places / t - 1);
}

struct Errors {
    double sum = 0, worst = 0;
    int count = 0;
    void add(double e) {
        sum += e;
        ++count;
        if (std::abs(e) > std::abs(worst)) worst = e;
    }
    std::string text() const { return fmt::format("{:+.1f} ({:+.1f})", sum / count, worst); }
};

void plates() {
    std::cout << "| t | tilt | plain: thickness %, mean (worst) of 6 places | walls | sweeps | wrong signs | "
                 "whole plate 28 x 28 "
                 "at refine 4: plain | walls | least refine |\n|---|---|---|---|---|---|---|---|---|\n";
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    for (const double t : {0.3, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0})
        for (const double tilt : {0.0, 10.0, 30.0, 45.0}) {
            Errors errors[2], whole[2];
            int sweeps = 0, refine = 1;
            std::int64_t wrong = 0;
            for (int place = 0; place < 6; ++place) {
                const Vec3d middle(30.31, 30.77, 30 + 0.07 + place / 6.0);
                const auto turn = tilted(tilt);
                const TriangleMesh mesh = boxOf({14, 14, t / 2}, turn, middle);
                const Distances distances = distancesOf(mesh, *transform);
                for (int walls = 0; walls < 2; ++walls) {
                    const Fitted fit = fitted(mesh, distances, walls, 4);
                    errors[walls].add(thicknessError(fit.field, turn, middle, t));
                    whole[walls].add(100 * (meshOf(fit.field, 4).volume / (28 * 28 * t) - 1));
                    sweeps = std::max(sweeps, fit.walls.sweeps);
                    refine = std::max(refine, fit.walls.leastRefine);
                    wrong = std::max(wrong, fit.fit.disagreeing + fit.walls.unmet);
                }
            }
            std::cout << fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", t, tilt,
                                     errors[0].text(), errors[1].text(), sweeps, wrong, whole[0].text(),
                                     whole[1].text(), refine)
                      << std::flush;
        }
}

// ---- tubes and hollow balls

// Rings of a profile (radius, height), closed: around the z axis.
TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, int around, bool closedProfile) {
    TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(profile.size()), m = static_cast<std::uint32_t>(around);
    for (std::uint32_t j = 0; j < m; ++j)
        for (const auto& [r, z] : profile) {
            const double a = 2 * std::numbers::pi * j / m;
            mesh.points.push_back({r * std::cos(a), r * std::sin(a), z});
        }
    for (std::uint32_t j = 0; j < m; ++j)
        for (std::uint32_t i = 0; i + (closedProfile ? 0 : 1) < n; ++i) {
            const std::uint32_t a = j * n + i, b = j * n + (i + 1) % n, c = (j + 1) % m * n + i,
                                d = (j + 1) % m * n + (i + 1) % n;
            mesh.triangles.push_back({a, c, d});
            mesh.triangles.push_back({a, d, b});
        }
    return mesh;
}

TriangleMesh placed(TriangleMesh mesh, const openvdb::math::Mat3d& turn, const Vec3d& middle) {
    for (Point& p : mesh.points) {
        const Vec3d q = turn * Vec3d(p[0], p[1], p[2]) + middle;
        p = {q[0], q[1], q[2]};
    }
    return mesh;
}

// Outer radius 8, length 40: profile counter-clockwise seen with the axis on the left.
TriangleMesh tube(double wall) {
    const double R = 8, r = R - wall, h = 20;
    return revolved({{r, -h}, {R, -h}, {R, h}, {r, h}}, 96, true);
}

TriangleMesh sphere(double radius, bool inwards) {
    std::vector<std::array<double, 2>> profile;
    constexpr int kRows = 64;
    for (int i = 0; i <= kRows; ++i) {
        const double a = std::numbers::pi * (double(i) / kRows - 0.5);
        profile.push_back({radius * std::cos(a), radius * std::sin(a)});
    }
    TriangleMesh mesh = revolved(profile, 128, false);
    if (inwards)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

TriangleMesh hollowBall(double wall) {
    TriangleMesh mesh = sphere(9 + wall / 2, false), inner = sphere(9 - wall / 2, true);
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), inner.points.begin(), inner.points.end());
    for (const Triangle& t : inner.triangles)
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return repairMesh(std::move(mesh), "ball");
}

void table(const std::string& what, const std::vector<double>& thicknesses, TriangleMesh (*make)(double)) {
    std::cout << fmt::format(
        "\n{}: volume %, parts/handles/cavities\n\n| wall | refine | plain | walls | least refine | "
        "sweeps | unmet |\n|---|---|---|---|---|---|---|\n",
        what);
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    for (const double t : thicknesses) {
        const TriangleMesh mesh = placed(make(t), tilted(25), Vec3d(40.13, 40.31, 39.78));
        const double volume = topologyOf(mesh).volume;
        const Distances distances = distancesOf(mesh, *transform);
        for (const int refine : {1, 2, 4}) {
            const Fitted plain = fitted(mesh, distances, false, refine),
                         walls = fitted(mesh, distances, true, refine);
            std::cout << fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", t, refine,
                                     textOf(meshOf(plain.field, refine), volume),
                                     textOf(meshOf(walls.field, refine), volume), walls.walls.leastRefine,
                                     walls.walls.sweeps, walls.walls.unmet)
                      << std::flush;
        }
    }
}

// ---- a file

void file(const std::string& path, double voxels) {
    MeshRepairReport repair;
    const TriangleMesh mesh = repairMesh(readMesh(path), path, &repair);
    const MeshTopology input = topologyOf(mesh);
    const auto transform = transformForMesh(mesh, voxelForCount(mesh, voxels));
    const Distances distances = distancesOf(mesh, *transform, repair.evenOdd);
    const Fitted plain = fitted(mesh, distances, false, 4), walls = fitted(mesh, distances, true, 4);
    std::cout << fmt::format(
        "{} {}: input {}/{}/{}; distance {:.2f} s, walls {:.2f} s; {} rows, {} sweeps, {} unmet, {} of {} "
        "changed, {} "
        "thickened, {} disagree; thinnest {:.2f} voxel, refine {}\n",
        path, voxels, input.parts, input.genus, input.cavities, distances.seconds, walls.seconds,
        walls.walls.rows, walls.walls.sweeps, walls.walls.unmet, walls.walls.changed,
        walls.field.controlPointCount(), walls.walls.thickened, walls.fit.disagreeing, walls.walls.thinnest,
        walls.walls.leastRefine);
    for (const int refine : {1, 2, 4})
        std::cout << fmt::format("  refine {}: plain {}; walls {}\n", refine,
                                 textOf(meshOf(plain.field, refine), input.volume),
                                 textOf(meshOf(walls.field, refine), input.volume))
                  << std::flush;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 1 ? argv[1] : "all";
    const bool all = what == "all";
    if (all || what == "plates") plates();
    if (all || what == "tubes") table("tubes of radius 8, length 40", {0.23, 0.35, 0.5, 0.8, 1.3}, tube);
    if (all || what == "balls") table("hollow balls of radius 9", {0.3, 0.5, 0.7, 0.85, 1.0}, hollowBall);
    if (!all && what != "plates" && what != "tubes" && what != "balls")
        file(what, argc > 2 ? std::atof(argv[2]) : 256);
}
