// How far levels and budgets are from what they stand for, beside what users have today, as two markdown tables.
//
//     fidelity SOLID [--voxels N] [--only levels|budgets|volume] [--half-width W --band B] [--meshes FOLDER]
//
//   SOLID     plate, plate-turned, gyroid, trabecular, a closed mesh, or an image followed by @ISO (solids.h)
//   --voxels  128 by default, along the longest axis; an image is taken as it is
//   --only volume  what the volume errors of levels 1 and 2 consist of: of polygonizing, of thinning, and of the field by
//             the thickness of the solid (volume_error.h); what --refit makes of them. Beside volumes, rms to the surface from
//             30,000 triangles of the mesh
//   --half-width, --band   of the fit, 4 and 2 voxels by default
//   --meshes  where to put the meshes, for scripts/render
//
// Equal resolution: levels 1, 2, 3, voxels of 2, 4, 8; measured against the solid's surface.
//   isowave     fitDistance -> analyse -> lod::LevelMesher, which makes the meshes of `isowave lod`
//   refined and thinned   the same with refine = 2, then decimate() to a quarter: about as many triangles
//   volume kept   refined and thinned at the iso-value that gives the level the volume of level 0 (--preserve-volume)
//   mean-pool   means of 2x2x2 distances, level by level, marching cubes; clamped to 4 voxels, as isowave's are, and to 16
//   multires    openvdb::tools::MultiResGrid of the distances clamped to 4, volumeToMesh
// Equal triangles: 1 % and 0.2 % of level 0's mesh, which all of them get, and are measured against.
//   isowave     BudgetChooser over all steps, as `isowave lod --ratio` does
//
// After them: rms over mean-pool's; "near" is from the middles of the surface's triangles that none of the meshes is farther
// from than a voxel of the level; "left out" is the share of the surface that one mesh is farther from than that.
//
// Columns: genus and components of the mesh; volume against the surface's; distances in voxels of level 0, to the surface and
// back from it; defects: edges without exactly two triangles that run through them in opposite directions, vertices whose
// triangles are no single fan; pairs of triangles that cut each other; seconds of wall time from the distances, or level
// 0's mesh, on, counting parts and handles included.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>

#include "base/heap.h"
#include "io/mesh/write.h"
#include "isowave/error.h"
#include "lod/level_mesher.h"
#include "marching.h"
#include "multires.h"
#include "polygonize/level_iso.h"
#include "polygonize/polygonize.h"
#include "polygonize/refit.h"
#include "polygonize/specks.h"
#include "rivals.h"
#include "simplify/budget_chooser.h"
#include "simplify/self_intersections.h"
#include "simplify/triangle_subset.h"
#include "solids.h"
#include "volume/fit.h"
#include "volume_error.h"
#include "wavelets/pyramid.h"

namespace {

using namespace isowave;
constexpr int kLevels = 3;
constexpr int kUsualVoxels = 128;
constexpr std::size_t kFew = 30'000;  // triangles, for an rms
constexpr std::size_t kOwn = 3;       // rows of isowave among those of a level, the first

class Clock {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// A surface and what is asked about it again and again.
struct Reference {
    explicit Reference(const TriangleMesh& of) : mesh(of), target(of), volume(topologyOf(of).volume) {}
    const TriangleMesh& mesh;
    DistanceTarget target;
    double volume;
};

struct Row {
    std::string name;
    MeshTopology topology;
    OneSidedDistance to, from;
    std::int64_t intersections = 0;
    double volumeError = 0, seconds = 0;

    std::int64_t defects() const {
        return topology.boundaryEdges + topology.nonManifoldEdges + topology.misorientedEdges +
               topology.nonManifoldVertices + topology.degenerateTriangles;
    }
};

constexpr const char* kHeader =
    "| | | triangles | genus | components | volume | rms to, from | max to, from | defects | cuts | seconds "
    "|\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string text(const std::string& group, const Row& row) {
    const MeshTopology& t = row.topology;
    return fmt::format(
        "| {} | {} | {} | {} | {} | {:+.2f} % | {:.3f}, {:.3f} | {:.2f}, {:.2f} | {} | {} | {:.2f} |\n",
        group, row.name, t.triangles, row.defects() > 0 ? "-" : std::to_string(t.genus), t.components,
        100 * row.volumeError, row.to.rms, row.from.rms, row.to.max, row.from.max, row.defects(),
        row.intersections, row.seconds);
}

class Bench {
  public:
    Bench(bench::FidelitySolid solid, const DistanceFitOptions& fit, std::filesystem::path meshes)
        : solid_(std::move(solid)),
          fit_(fit),
          narrow_(bench::clamped(*solid_.distance, fit.halfWidth)),
          meshes_(std::move(meshes)) {}

    void levels() {
        const Reference truth(solid_.truth);
        fmt::print("### {}, equal resolution\n\nthe surface: {} triangles, volume {:.0f}\n\n{}", solid_.name,
                   solid_.truth.triangles.size(), truth.volume, kHeader);
        makeSteps(Lean::yes);
        print("level 0", {measured("isowave", steps_.front().mesh, truth, stepSeconds_.front())});
        bench::DenseField pooled = bench::denseField(*narrow_), wide = bench::denseField(*solid_.distance);
        const Clock restricting;
        const bench::MultiRes grids(kLevels + 1, *narrow_);
        const double restricted = restricting.seconds();
        std::string ratios;
        double pooling = 0;
        for (int level = 1; level <= kLevels; ++level) {
            const auto at = static_cast<std::size_t>(level * kStepsPerLevel);
            if (at >= steps_.size()) break;  // vanished
            const TriangleMesh& plain = steps_[at].mesh;
            const TimedMesh& lean = lean_[std::size_t(level - 1)];
            const TimedMesh& kept = volumeKept_[std::size_t(level - 1)];
            group_ = fmt::format("level {}", level);
            const Clock clock;
            pooled = bench::meanPooled(pooled);
            const TriangleMesh mean = bench::marchingCubes(pooled);
            pooling += clock.seconds();
            wide = bench::meanPooled(wide);
            const Clock meshing;
            const TriangleMesh multires = bench::multiresMesh(grids, level);
            const double multiresSeconds = restricted + meshing.seconds();
            const std::vector<Row> rows{
                measured("isowave", plain, truth, stepSeconds_[std::size_t(level)]),
                measured("isowave, refined and thinned", lean.mesh, truth, lean.seconds),
                measured("isowave, volume kept", kept.mesh, truth, kept.seconds),
                measured("mean-pool", mean, truth, pooling),
                measured("mean-pool, clamped to 16", bench::marchingCubes(wide), truth, pooling),
                measured("multires", multires, truth, multiresSeconds)};
            print(group_, rows);
            const Row& pool = rows[kOwn];
            const Nearness near = nearness(truth.mesh, {&plain, &lean.mesh, &kept.mesh, &mean}, 1 << level);
            for (std::size_t own = 0; own < kOwn; ++own)
                ratios += fmt::format(
                    "| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f}, {:.2f} % | {:+.2f}, {:+.2f} % |\n",
                    solid_.name, level, rows[own].name, rows[own].to.rms / pool.to.rms,
                    rows[own].from.rms / pool.from.rms, near.rms[own] / near.rms[kOwn],
                    100 * near.leftOut[own], 100 * near.leftOut[kOwn], 100 * rows[own].volumeError,
                    100 * pool.volumeError);
        }
        fmt::print(
            "\nrms over mean-pool's; of both meshes what they leave out, and the volume:\n\n| solid | level "
            "| "
            "mesh | to | from | near | left out | volume |\n|---|---|---|---|---|---|---|---|\n{}\n",
            ratios);
    }

    void budgets() {
        if (steps_.empty()) makeSteps(Lean::no);
        const Reference level0(steps_.front().mesh);
        const auto all = static_cast<std::int64_t>(level0.mesh.triangles.size());
        fmt::print("### {}, equal triangles\n\nlevel 0: {} triangles\n\n{}", solid_.name, all, kHeader);
        BudgetChooser chooser(steps_, {}, solid_.name);
        for (const double share : {0.01, 0.002}) {
            const auto wanted = static_cast<std::int64_t>(std::round(share * double(all)));
            group_ = fmt::format("{:g} %", 100 * share);
            std::vector<Row> rows;
            try {
                Clock clock;
                const BudgetMesh own = chooser.choose({Budget::Kind::triangles, double(wanted)});
                rows.push_back(measured("isowave", own.mesh, level0, clock.seconds()));
                std::cerr << solid_.name << ", " << group_ << ": step " << own.step << ", " << own.why
                          << '\n';
            } catch (const std::exception& error) {
                std::cerr << error.what() << '\n';
            }
            for (const bench::Rival& rival : bench::decimators()) {
                Clock clock;
                const TriangleMesh mesh = rival.decimate(level0.mesh, wanted);
                const double seconds = clock.seconds();
                if (!mesh.triangles.empty()) rows.push_back(measured(rival.name, mesh, level0, seconds));
            }
            print(group_, rows);
        }
        fmt::print("\n");
    }

    void volumes() {
        constexpr int kCoarsest = 2, kFinest = 4;
        const DistanceTarget surface(solid_.truth);
        const double truth = topologyOf(solid_.truth).volume;
        const std::vector<double> half = bench::halfThickness(solid_);
        std::vector<SurfaceSample> level0;
        std::string meshes, places;
        const auto look = [&](int step, const BSplineField& field) {
            if (step == 0) level0 = surfaceSamples(fine(field, 0));
            if (step == 0 || step % kStepsPerLevel != 0) return;
            const int level = step / kStepsPerLevel;
            const auto at = [&](const BSplineField& of, int refine) {
                TriangleMesh mesh = polygonize(of, {.refine = refine});
                removeSpecks(mesh, nodeVolume(field.transform()));
                return mesh;
            };
            const auto told = [&](const TriangleMesh& mesh) {
                return fmt::format(" {:+.2f} %, {:.3f} |", 100 * (topologyOf(mesh).volume / truth - 1),
                                   surface.sampledDistanceFrom(evenSubset(mesh, kFew)).rms);
            };
            const BSplineField refit = refitted(field, level0);
            const TriangleMesh finest = at(field, kFinest);
            meshes += fmt::format("| {} | {} |{}{}{}{}{}{}\n", solid_.name, level, told(at(field, 1)),
                                  told(at(field, kRefine)), told(refinedAndThinned(field, 0, 0).mesh),
                                  told(finest), told(at(refit, kRefine)), told(at(refit, kFinest)));
            const bench::VolumeByThickness parts = bench::volumeByThickness(solid_, half, field, finest);
            places += fmt::format("| {} | {} |", solid_.name, level);
            for (std::size_t i = 0; i < parts.gain.size(); ++i)
                places += fmt::format(" {:+.2f} of {:.0f} |", 100 * parts.gain[i], 100 * parts.area[i]);
            places += fmt::format(" {:.2f} |\n", 100 * parts.leftOut);
        };
        wavelets::descend(fitDistance(*narrow_, fit_), {.maxSteps = kCoarsest * kStepsPerLevel}, {}, look);
        fmt::print(
            "### {}, volume\n\n| solid | level | as it is | refined | refined and thinned | refined 4 times "
            "| "
            "refit, refined | refit, refined 4 times |\n|---|---|---|---|---|---|---|---|\n{}\n"
            "| solid | level | thinner than 0.5 | 0.5 to 1 | 1 to 2 | 2 voxels and more | left out |\n"
            "|---|---|---|---|---|---|---|\n{}\n",
            solid_.name, meshes, places);
    }

  private:
    enum class Lean { no, yes };
    void makeSteps(Lean lean) {
        Clock clock;
        double others = 0;  // all but levels
        const Progress silent;
        StageClock stages;
        lod::LevelMesher mesher({}, std::nullopt, lod::LevelMesher::Facts::few, silent, stages);
        wavelets::descend(fitDistance(*narrow_, fit_), {}, {}, [&](int step, const BSplineField& field) {
            lod::LevelMesh level = mesher.make(step, field);
            if (step % kStepsPerLevel == 0) stepSeconds_.push_back(clock.seconds() - others);
            const Clock counting;
            if (level.mesh.triangles.empty()) return;
            if (step == 0) volume0_ = topologyOf(fine(field, 0)).volume;
            if (lean == Lean::yes && step % kStepsPerLevel == 0 && step > 0 &&
                step <= kLevels * kStepsPerLevel) {
                lean_.push_back(refinedAndThinned(field, 0, stepSeconds_.back()));
                const Clock choosing;
                const double iso =
                    isoOfVolume(
                        [&](double at) {
                            return volumeWithoutSpecks(fine(field, at), nodeVolume(field.transform()));
                        },
                        volume0_, kIsoLimit * field.K)
                        .iso;
                volumeKept_.push_back(
                    refinedAndThinned(field, iso, stepSeconds_.back() + choosing.seconds()));
            }
            steps_.push_back({step, std::move(level.mesh), std::move(level.report.topology),
                              field.transform().voxelSize().length(), step % kStepsPerLevel == 0});
            others += counting.seconds();
        });
    }

    struct TimedMesh {
        TriangleMesh mesh;
        double seconds;
    };
    static constexpr int kRefine = 2;
    static TriangleMesh fine(const BSplineField& field, double iso) {
        return polygonize(field, {.refine = kRefine, .iso = iso});
    }
    // Polygonized on half the spacing, then collapsed down to the triangles of the whole one.
    static TimedMesh refinedAndThinned(const BSplineField& field, double iso, double secondsBefore) {
        const Clock clock;
        TriangleMesh mesh = fine(field, iso);
        removeSpecks(mesh, nodeVolume(field.transform()));
        mesh = decimate(mesh, static_cast<std::int64_t>(mesh.triangles.size()) / (kRefine * kRefine));
        return {std::move(mesh), secondsBefore + clock.seconds()};
    }

    Row measured(std::string name, const TriangleMesh& mesh, const Reference& reference, double seconds) {
        Row row{std::move(name), topologyOf(mesh), {}, {}, countSelfIntersections(mesh), 0, seconds};
        row.to = reference.target.distanceFrom(mesh, 1.0);
        row.from = DistanceTarget(mesh).distanceFrom(reference.mesh);
        row.volumeError = row.topology.volume / reference.volume - 1;
        if (!meshes_.empty()) {
            std::string file = fmt::format("{}_{}_{}", solid_.name, group_, row.name);
            for (char& c : file)
                if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
            // Without normals: scripts/render then shades all alike.
            writeMesh(meshes_ / (file + ".ply"), {mesh.points, mesh.triangles, {}}, MeshFormat::ply);
        }
        return row;
    }

    // From the middles of the surface's triangles to each mesh, weighted by area. rms is over those that no mesh is farther
    // from than `limit`: a part that one of them has lost does not drown what they say of the others.
    struct Nearness {
        std::vector<double> rms, leftOut;
    };
    static Nearness nearness(const TriangleMesh& surface, const std::vector<const TriangleMesh*>& meshes,
                             double limit) {
        std::vector<DistanceTarget> targets;
        for (const TriangleMesh* mesh : meshes) targets.emplace_back(*mesh);
        Nearness result{std::vector<double>(meshes.size(), 0.0), std::vector<double>(meshes.size(), 0.0)};
        std::vector<double> distances(meshes.size());
        double whole = 0, near = 0;
        for (const auto& [i, j, k] : surface.triangles) {
            const openvdb::Vec3d a(surface.points[i].data()), b(surface.points[j].data()),
                c(surface.points[k].data());
            const openvdb::Vec3d middle = (a + b + c) / 3;
            const double area = (b - a).cross(c - a).length() / 2;
            for (std::size_t m = 0; m < targets.size(); ++m) {
                distances[m] = targets[m].distance({middle[0], middle[1], middle[2]});
                if (distances[m] > limit) result.leftOut[m] += area;
            }
            whole += area;
            if (*std::max_element(distances.begin(), distances.end()) > limit) continue;
            near += area;
            for (std::size_t m = 0; m < targets.size(); ++m)
                result.rms[m] += area * distances[m] * distances[m];
        }
        for (double& sum : result.rms) sum = std::sqrt(sum / near);
        for (double& area : result.leftOut) area /= whole;
        return result;
    }

    static void print(const std::string& group, const std::vector<Row>& rows) {
        for (const Row& row : rows) fmt::print("{}", text(&row == &rows[0] ? group : "", row));
        std::fflush(stdout);
    }

    bench::FidelitySolid solid_;
    DistanceFitOptions fit_;
    openvdb::FloatGrid::Ptr narrow_;  // clamped to fit_.halfWidth
    std::filesystem::path meshes_;
    std::string group_ = "level 0";  // of the rows that come next
    std::vector<StepMesh> steps_;
    std::vector<TimedMesh> lean_, volumeKept_;  // by level, from 1
    double volume0_ = 0;                        // of level 0
    std::vector<double> stepSeconds_;           // by level
};

}  // namespace

int main(int argc, char** argv) {
    std::string solid, only, meshes;
    int voxels = kUsualVoxels;
    DistanceFitOptions fit;
    bool usage = argc < 2;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (!word.starts_with("--"))
            solid = word;
        else if (i + 1 == argc)
            usage = true;
        else if (word == "--voxels")
            voxels = std::atoi(argv[++i]);
        else if (word == "--only")
            only = argv[++i];
        else if (word == "--half-width")
            fit.halfWidth = std::atof(argv[++i]);
        else if (word == "--band")
            fit.band = std::atof(argv[++i]);
        else if (word == "--meshes")
            meshes = argv[++i];
        else
            usage = true;
    }
    if (usage || solid.empty() || voxels < 16 || !(fit.band > 0 && fit.band <= fit.halfWidth) ||
        fit.halfWidth > bench::kWide) {
        std::cerr << "usage: fidelity plate|plate-turned|gyroid|trabecular|MESH|IMAGE@ISO [--voxels N] "
                     "[--only levels|budgets|volume] [--half-width W] [--band B] [--meshes FOLDER]\n";
        return 2;
    }
    setUpHeap();
    initializeVdb();
    try {
        bench::FidelitySolid made = bench::fidelitySolid(solid, voxels);
        if (voxels != kUsualVoxels) made.name += fmt::format("-{}", voxels);
        Bench bench(std::move(made), fit, meshes);
        if (only.empty() || only == "levels") bench.levels();
        if (only.empty() || only == "budgets") bench.budgets();
        if (only == "volume") bench.volumes();
    } catch (const InputError& error) {
        std::cerr << error.what() << '\n';
        return 3;
    }
    return 0;
}
