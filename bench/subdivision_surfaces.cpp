// Errors and times of multiresolution on meshes, beside Bertram's lifting and the numbers of O-T2, O-T3.
//
//     subdivision_surfaces errors MESH ...     L2 error when k = 2, 3 levels are taken off and subdivided back
//     subdivision_surfaces times               one step apart and together, by size
//
// Errors: L = |V - P^k V0| over all vertices (O section 6.3), and the same as an rms in units of 1e-4 of the diagonal,
// which compares between models. Each scheme of the table that finds its connectivity in MESH, all its variants; for
// Catmull-Clark also lifting, whose P is not quite the same (lifting.h).
// Times: processor time of this thread, the least of several runs, connectivity made before (its time stands beside).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <random>

#include "bench/lifting.h"
#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"

namespace {

using namespace isowave::subdivision;
using isowave::InputError;
using isowave::bench::LiftingStep;

double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double squares = 0;
    for (std::size_t k = 0; k < a.size(); ++k) squares += dot(a[k] - b[k], a[k] - b[k]);
    return std::sqrt(squares);
}

// --- errors

// The meshes from `levels` below the finest up to it, the finest in canonical order.
std::vector<PolygonMesh> ladder(const PolygonMesh& mesh, const MeshScheme& scheme, int levels) {
    Hierarchy hierarchy = decompose(mesh, scheme, "", levels);
    hierarchy.order = {};
    std::vector<PolygonMesh> meshes{hierarchy.base};
    for (int k = 0; k < levels; ++k) meshes.push_back(scheme.step(meshes.back(), "")->fineMesh());
    meshes.back().points = reconstruct(hierarchy).points;
    return meshes;
}

std::vector<Vec3> approximation(const std::vector<PolygonMesh>& meshes, const MeshScheme& scheme,
                                std::string_view variant) {
    std::vector<std::unique_ptr<SubdivisionStep>> steps;
    for (std::size_t k = 0; k + 1 < meshes.size(); ++k) steps.push_back(scheme.step(meshes[k], variant));
    auto points = meshes.back().points;
    for (std::size_t k = steps.size(); k-- > 0;) points = steps[k]->decompose(points).coarse;
    for (const auto& step : steps) points = step->subdivide(points);
    return points;
}

std::vector<Vec3> liftingApproximation(const std::vector<PolygonMesh>& meshes) {
    std::vector<LiftingStep> steps;
    for (std::size_t k = 0; k + 1 < meshes.size(); ++k) steps.emplace_back(meshes[k]);
    auto points = meshes.back().points;
    for (std::size_t k = steps.size(); k-- > 0;) {
        steps[k].apart(points);
        points.resize(steps[k].coarseSize());
    }
    for (const auto& step : steps) {
        points.resize(step.fineSize());  // details 0
        step.together(points);
    }
    return points;
}

void printErrors(const std::string& path) {
    const PolygonMesh mesh = readPolygonMesh(path);
    requireManifold(mesh, path);
    const double size = diagonal(mesh.points);
    const auto line = [&](int k, std::string_view scheme, std::string_view variant,
                          const std::vector<Vec3>& original, const std::vector<Vec3>& points) {
        const double error = distance(points, original);
        fmt::print("{:28} {:8} {:2}  {:13} {:9} {:12.5g} {:9.3f}\n", path.substr(path.find_last_of('/') + 1),
                   mesh.vertexCount(), k, scheme, variant, error,
                   1e4 * error / size / std::sqrt(double(mesh.vertexCount())));
    };
    for (const int k : {2, 3}) {
        for (const MeshScheme& scheme : meshSchemes()) {
            std::vector<PolygonMesh> meshes;
            try {
                meshes = ladder(mesh, scheme, k);
            } catch (const InputError&) {
                continue;  // another connectivity, or fewer levels
            }
            for (const auto variant : scheme.variants) {
                line(k, scheme.name, variant, meshes.back().points, approximation(meshes, scheme, variant));
            }
            if (scheme.name == "catmull-clark")
                line(k, scheme.name, "lifting", meshes.back().points, liftingApproximation(meshes));
        }
    }
}

// --- times

PolygonMesh octahedron() {
    PolygonMesh mesh;
    mesh.points = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    for (Index k = 0; k < 4; ++k) {
        const Index a = 2 + k, b = 2 + (k + 1) % 4;
        mesh.addFace({0, a, b});
        mesh.addFace({1, b, a});
    }
    return mesh;
}

double least(const std::function<void()>& work) {
    double best = 1e9;
    for (int run = 0; run < 3; ++run) {
        const double start = now();
        work();
        best = std::min(best, now() - start);
    }
    return best;
}

struct Times {
    std::vector<double> sizes, apart, together;
};

// The exponent e of time ~ size^e: the slope of the logarithms' least-squares line.
double slope(const std::vector<double>& sizes, const std::vector<double>& times) {
    const auto n = static_cast<double>(sizes.size());
    double x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        const double u = std::log(sizes[k]), v = std::log(times[k]);
        x += u, y += v, xx += u * u, xy += u * v;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

void addLine(Times& times, std::string_view name, std::size_t vertices, double connect, double apart,
             double together) {
    const auto n = static_cast<double>(vertices);
    fmt::print("{:24} {:9} {:9.4f} {:9.4f} {:9.4f} {:8.2f} {:8.2f}\n", name, vertices, connect, apart,
               together, 1e-6 * n / apart, 1e-6 * n / together);
    times.sizes.push_back(n);
    times.apart.push_back(apart);
    times.together.push_back(together);
}

std::vector<Vec3> noise(std::size_t count) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = {normal(generator), normal(generator), normal(generator)};
    return points;
}

void printTimes(const MeshScheme& scheme, std::string_view variant, int levels) {
    Times times, lifting;
    PolygonMesh mesh = octahedron();
    for (int k = 0; k < levels; ++k) {
        std::unique_ptr<SubdivisionStep> step;
        const auto connect = least([&] { step = scheme.step(mesh, variant); });
        const auto fine = noise(step->fineSize());
        SubdivisionStep::Parts parts;
        std::vector<Vec3> again;
        const double apart = least([&] { parts = step->decompose(fine); });
        const double together = least([&] { again = step->reconstruct(parts.coarse, parts.stored); });
        if (distance(again, fine) > kMeshRoundTrip * std::sqrt(double(fine.size())) * diagonal(fine))
            throw std::logic_error("the round trip is wrong");
        const std::string name = std::string(scheme.name) + " " + std::string(variant);
        if (fine.size() > 60000) {  // below it all fits into the first caches
            addLine(times, name, fine.size(), connect, apart, together);
            if (scheme.name == "catmull-clark") {
                const LiftingStep lift(mesh);
                auto points = fine;
                const double down = least([&] { lift.apart(points = fine); });
                const auto separate = points;
                const double up = least([&] { lift.together(points = separate); });
                addLine(lifting, "lifting", fine.size(), 0, down, up);
            }
        }
        mesh = step->fineMesh();
    }
    for (const auto* each : {&times, &lifting}) {
        if (each->sizes.empty()) continue;
        fmt::print("    time ~ vertices^{:.2f} apart, ^{:.2f} together{}\n", slope(each->sizes, each->apart),
                   slope(each->sizes, each->together), each == &lifting ? " (lifting)" : "");
    }
}

}  // namespace

int main(int count, char** words) {
    try {
        const std::string what = count > 1 ? words[1] : "";
        if (what == "times") {
            fmt::print("{:24} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8}\n", "scheme", "vertices", "connect s",
                       "apart s", "together s", "Mv/s", "Mv/s");
            for (const MeshScheme& scheme : meshSchemes()) {
                const int levels =
                    scheme.name == "catmull-clark" ? 9 : 10;  // its first step makes 3 quads a triangle
                for (const auto variant : scheme.variants) printTimes(scheme, variant, levels);
            }
        } else if (what == "errors" && count > 2) {
            fmt::print("{:28} {:>8} {:>2}  {:13} {:9} {:>12} {:>9}\n", "mesh", "vertices", "k", "scheme",
                       "variant", "L2", "rms e-4");
            for (int k = 2; k < count; ++k) printErrors(words[k]);
        } else {
            throw InputError("subdivision_surfaces errors MESH ... | times");
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "subdivision_surfaces: {}\n", error.what());
        return 1;
    }
}
