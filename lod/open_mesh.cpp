#include "lod/open_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/triangle.h"
#include "hold/solid_limits.h"
#include "io/mesh/read.h"
#include "io/mesh/units.h"
#include "isowave/error.h"
#include "isowave/measure.h"
#include "lod/fit_solid.h"
#include "lod/memory.h"
#include "lod/option_checks.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/distance.h"
#include "volume/mesh_repair.h"
#include "volume/walls/wall_fit.h"

namespace isowave::lod {
namespace {

// Voxels along the longest axis of a mesh when nothing is said.
constexpr std::int64_t kDefaultVoxels = 256;

// Of the finer lattice's points along the surface, so many may be inside too many or too few.
constexpr double kCountError = 0.25;

constexpr int kFinestRefine = 4;  // of polygonize()

constexpr const char* kRemedy = "give fewer --voxels or a larger --voxel";

constexpr std::int64_t kFewestVoxels = 4;

// The least thickness of a plate, in voxels: below it is torn by the lattice.
constexpr double kLeastThickness = 2;

void checkOptions(const SolidOptions& options) {
    requireAtLeast("--voxels", options.voxels, kFewestVoxels);
    requirePositive("--voxel", options.voxel);
    requirePositive("--close-holes", options.closeHoles);
    requirePositive("--thicken", options.thicken);
    if (options.voxel && options.voxels)
        throw UsageError("--voxel and --voxels exclude each other; give one of them");
    if (options.closeHoles && options.thicken)
        throw UsageError(
            "--close-holes and --thicken exclude each other: what is closed is a solid already; give one");
    if (options.thicken && options.fit.value_or(FitMethod::distance) != FitMethod::distance)
        throw UsageError("--thicken needs the distance fit; leave out --fit");
    if (options.unit && (metresPer(*options.unit) == 0 || *options.unit == "angstrom"))
        throw UsageError("--unit: '" + *options.unit + "' is not one of mm, cm, m, in, ft");
}

double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options, const std::string& name,
                    const Progress& progress) {
    const double voxels = static_cast<double>(options.voxels.value_or(kDefaultVoxels));
    const double voxel = options.voxel ? *options.voxel : voxelForCount(mesh, voxels);
    const bool isChosen = options.voxel || options.voxels;
    const double largest = options.thicken ? *options.thicken / kLeastThickness : HUGE_VAL;
    if (isChosen && voxel > largest)
        throw UsageError(fmt::format(
            "--thicken {:g} is {:.2g} voxels of {:.4g}, fewer than {:g}; give --voxel {:.3g} or less",
            *options.thicken, *options.thicken / voxel, voxel, kLeastThickness, 0.999 * largest));
    if (!isChosen && voxel > largest / 1.5) {
        progress.say(fmt::format("{}: --voxel {:.4g}, a third of the thickness", name, largest / 1.5));
        return largest / 1.5;
    }
    if (!isChosen) progress.say(fmt::format("{}: --voxels {} along the longest axis", name, kDefaultVoxels));
    return voxel;
}

std::array<double, 3> extentOf(const TriangleMesh& mesh) {
    std::array<double, 3> extent{};
    if (mesh.points.empty()) return extent;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] =
            std::minmax_element(mesh.points.begin(), mesh.points.end(),
                                [axis](const Point& a, const Point& b) { return a[axis] < b[axis]; });
        extent[axis] = (*high)[axis] - (*low)[axis];
    }
    return extent;
}

struct ClosedMesh {
    LoadedMesh loaded;
    MeshRepairReport repair;
};

// With --thicken it may stay open.
ClosedMesh closed(LoadedMesh loaded, const std::string& name, const SolidOptions& options,
                  const Progress& progress) {
    ClosedMesh result{std::move(loaded), {}};
    RepairOptions repair;
    repair.closeHoles = options.closeHoles;
    repair.step = result.loaded.step;
    repair.mayStayOpen = options.thicken.has_value();
    result.loaded.mesh = repairMesh(std::move(result.loaded.mesh), name, &result.repair, repair, progress);
    std::vector<std::string>& notes = result.repair.notes;
    if (!result.loaded.droppedNote.empty()) notes.insert(notes.begin(), result.loaded.droppedNote);
    if (options.thicken)
        notes.push_back(fmt::format("thickened: the solid is all within {:g} of the {} triangles",
                                    *options.thicken / 2, result.loaded.mesh.triangles.size()));
    return result;
}

// The mesh's own volume: the integral of its winding number, where all of its parts are apart from each other and it agrees
// with the finer lattice's points inside, whose number errs by far less than a point along the surface; else that number,
// which counts what lies in two parts once.
double volumeOf(const ClosedMesh& input, double voxel, const FineSigns& signs) {
    const TriangleMesh& mesh = input.loaded.mesh;
    const Vec3 from = toVec3(mesh.points.front());
    double six = 0, twiceArea = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 normal = areaNormal(mesh, t);
        six += dot(toVec3(mesh.points[t[0]]) - from, normal);
        twiceArea += length(normal);
    }
    const double exact = std::abs(six) / 6, counted = signs.volume() * voxel * voxel * voxel;
    const double allowed = kCountError * voxel / signs.perVoxel() * twiceArea / 2;
    const bool agree =
        !input.repair.evenOdd && !signs.lines().hasOverlap() && std::abs(counted - exact) <= allowed;
    return agree ? exact : counted;
}

// What level 0 should have. What is missing is said: silence would mean that level 0 is the input.
void putTruth(InputReport& report, const ClosedMesh& input, double voxel,
              const std::vector<openvdb::Vec3d>& points, const FineSigns& signs, const Progress& progress) {
    report.volume = volumeOf(input, voxel, signs);
    const auto unknown = [&](const char* why) {
        progress.say(
            fmt::format("how many parts, handles and cavities it has is not known: {}; level 0 is compared "
                        "by volume alone",
                        why));
    };
    const TriangleMesh& mesh = input.loaded.mesh;
    const MeshTopology topology = topologyOf(mesh);
    if (input.repair.evenOdd || !topology.closed() || !topology.oriented())
        return unknown("its triangles do not say what is inside");
    if (!topology.manifold()) return unknown("its surface touches itself along edges or at points");
    const MeshComponents components = componentsOf(mesh);
    if (componentsTouch(points, mesh.triangles, components.of, components.count(), signs))
        return unknown(components.count() > 1 ? "parts of it overlap, or lie nearer than a quarter of a voxel"
                                              : "it overlaps itself");
    report.parts = topology.parts;
    report.handles = topology.genus;
    report.cavities = topology.cavities;
}

InputReport reportOf(const ClosedMesh& input, const std::string& name, double voxel) {
    InputReport report;
    report.path = name;
    report.kind = InputReport::Kind::mesh;
    report.format = input.loaded.format;
    report.dimensions.emplace();
    const auto extent = extentOf(input.loaded.mesh);
    for (std::size_t axis = 0; axis < 3; ++axis)
        (*report.dimensions)[axis] = static_cast<std::int64_t>(std::ceil(extent[axis] / voxel));
    report.spacing = {voxel, voxel, voxel};
    report.triangles = input.repair.facesRead;
    report.repairNotes = input.repair.notes;
    report.space = input.loaded.space;
    report.unit = input.loaded.unit;
    return report;
}

std::vector<openvdb::Vec3d> inIndexSpace(const TriangleMesh& mesh,
                                         const openvdb::math::Transform& transform) {
    std::vector<openvdb::Vec3d> points;
    points.reserve(mesh.points.size());
    for (const Point& p : mesh.points) points.push_back(transform.worldToIndex(openvdb::Vec3d(p.data())));
    return points;
}

WallSummary summaryOf(const WallFitReport& report) {
    return {report.rows,    report.sweeps,    report.unmet,    report.between,
            report.changed, report.thickened, report.thinnest, report.leastRefine};
}

// By how much the counts of the input and of the field's mesh differ.
std::int64_t missed(const Solid::State& solid, int refine, const Progress& progress) {
    const SolidCounts counts = meshedCounts(*solid.field, refine, 0, progress);
    return std::abs(counts.parts - *solid.input.parts) + std::abs(counts.handles - *solid.input.handles) +
           std::abs(counts.cavities - *solid.input.cavities);
}

// A field of more control points is looked at as it is meshed: finer, its mesh would take gigabytes.
constexpr std::int64_t kMostForFiner = 2'000'000;
bool isLarge(const Solid::State& solid) { return solid.field->controlPointCount() > kMostForFiner; }

// How much rows between lattice points have left that the input does not have: where they contradict each other (a pocket
// whose walls come nearer and nearer) they may tear what was whole without them.
std::int64_t missedBetween(const Solid::State& solid, const Progress& progress) {
    const bool may = solid.fit->walls && solid.fit->walls->between > 0 && solid.input.parts;
    return may ? missed(solid, isLarge(solid) ? 1 : 2, progress) : 0;
}

bool isHeldBetween(const Solid::State& solid, const Progress& progress) {
    return solid.fit->walls && solid.fit->walls->rows > 0 &&
           !polygonize(*solid.field, {.refine = kFinestRefine}, progress).triangles.empty();
}

double bandPointsOf(const TriangleMesh& mesh, double voxel, const Fitting& fitting,
                    const SolidOptions& options) {
    const double reach = fitting.distance.halfWidth + options.thicken.value_or(0) / 2 / voxel;
    return estimateBandVoxels(mesh, voxel, reach);
}

Solid::State fitted(const ClosedMesh& input, const std::string& name, const SolidOptions& options,
                    const Progress& progress, StageClock& clock) {
    const TriangleMesh& mesh = input.loaded.mesh;
    for (const std::string& note : input.repair.notes) progress.say(note);

    const Fitting fitting = fittingOf(options, FitMethod::distance);
    const double voxel = voxelSizeFor(mesh, options, name, progress), limit = memoryLimit(options.maxMemory);
    refuseTooLarge(
        name, bytesFor(options.fieldOnly, kBytesPerBandPoint * bandPointsOf(mesh, voxel, fitting, options)),
        limit, kRemedy);
    const auto transform = transformForMesh(mesh, voxel);
    Solid::State solid;
    solid.input = reportOf(input, name, voxel);
    solid.space = input.loaded.space;
    const auto& dimensions = *solid.input.dimensions;
    progress.say(fmt::format("{}: {}, {}x{}x{} voxels of {:.4g}, {} fit", name,
                             counted(static_cast<std::int64_t>(mesh.triangles.size()), "triangle"),
                             dimensions[0], dimensions[1], dimensions[2], voxel, nameOf(fitting.method)));

    const auto distance = [&] {
        if (options.thicken)
            return distanceAroundMesh(mesh, *transform, fitting.distance.halfWidth, *options.thicken,
                                      progress);
        return distanceFromMesh(mesh, *transform, fitting.distance.halfWidth, input.repair.evenOdd, progress);
    };
    Samples samples{[&] { return nodesOfDistance(*distance()); }, distance};
    samples.fieldOnly = options.fieldOnly;
    std::vector<openvdb::Vec3d> points;
    std::optional<FineSigns> signs;  // a sheet has none
    if (!options.thicken) {
        points = inIndexSpace(mesh, *transform);
        signs.emplace(points, mesh.triangles, finestSigns(points, mesh.triangles), input.repair.evenOdd,
                      progress);
        putTruth(solid.input, input, voxel, points, *signs, progress);
        if (!input.repair.evenOdd && !signs->lines().hasOverlap())
            solid.surface = std::make_shared<TriangleMesh>(TriangleMesh{mesh.points, mesh.triangles, {}});
    }
    const auto fitAll = [&](Solid::State& made, const FineSigns* between) {
        if (options.walls && signs)
            samples.walls = [&, between](BSplineField& field, const openvdb::FloatGrid& grid,
                                         const openvdb::Coord& shift) {
                const double halfWidth = fitting.distance.halfWidth;
                return summaryOf(
                    fitWalls(field, grid.constTree(), shift, points, mesh.triangles,
                             {.halfWidth = halfWidth, .widest = std::min(4.0, halfWidth), .between = between},
                             progress));
            };
        fit(made, fitting, samples, limit, kRemedy, progress, clock);
    };
    fitAll(solid, signs ? &*signs : nullptr);
    if (const std::int64_t roughly = missedBetween(solid, progress)) {
        Solid::State plain = solid;
        fitAll(plain, nullptr);
        const std::int64_t now = isLarge(solid) ? roughly : missed(solid, kFinestRefine, progress);
        if (missed(plain, isLarge(solid) ? 1 : kFinestRefine, progress) < now) solid = plain;
    }
    // A sheet between two layers of lattice points has none inside; the wall fit holds it nevertheless.
    if (!hasSurface(*solid.field) && !isHeldBetween(solid, progress))
        requireSurface(*solid.field, name,
                       "no lattice point lies inside the solid; give more --voxels or a smaller --voxel");
    return solid;
}

}  // namespace

LoadedMesh loadMesh(const std::filesystem::path& path, const Progress& progress,
                    const std::optional<std::string>& unit, const std::optional<double>& maxMemory) {
    MeshFile file = readMeshFile(path, progress, memoryLimit(maxMemory));
    LoadedMesh loaded;
    loaded.mesh = std::move(file.mesh);
    loaded.format = file.info.format;
    loaded.step = file.step;
    loaded.droppedNote = file.droppedNote;
    loaded.unit = unit.value_or("");
    if (loaded.format == "GLB" || loaded.format == "3MF") {  // they come in mm
        loaded.unit = unit.value_or("mm");
        const double scale = 0.001 / metresPer(loaded.unit);
        for (Point& p : loaded.mesh.points)
            for (double& x : p) x *= scale;
        *loaded.step *= scale;
    }
    if (file.info.space == "LPS") loaded.space = Space::lps;
    if (file.info.space == "RAS") {
        // Inside the program everything is LPS. Half a turn about z: orientation stays.
        loaded.space = Space::ras;
        for (Point& p : loaded.mesh.points) p[0] = -p[0], p[1] = -p[1];
        for (auto& n : loaded.mesh.normals) n[0] = -n[0], n[1] = -n[1];
    }
    return loaded;
}

MeshPlan planMesh(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress) {
    checkOptions(options);
    const std::string name = path.string();
    ClosedMesh input =
        closed(loadMesh(path, progress, options.unit, options.maxMemory), name, options, progress);
    for (const std::string& note : input.repair.notes) progress.say(note);
    const double voxel = voxelSizeFor(input.loaded.mesh, options, name, progress);
    MeshPlan plan;
    plan.input = reportOf(input, name, voxel);
    plan.bandPoints =
        bandPointsOf(input.loaded.mesh, voxel, fittingOf(options, FitMethod::distance), options);
    plan.mesh = std::move(input.loaded.mesh);
    return plan;
}

Solid::State openMesh(const std::filesystem::path& path, const SolidOptions& options,
                      const Progress& progress, StageClock& clock) {
    checkOptions(options);
    const std::string name = path.string();
    const ClosedMesh input = [&] {
        const StageClock::Scope scope(clock, "read");
        return closed(loadMesh(path, progress, options.unit, options.maxMemory), name, options, progress);
    }();
    try {
        return fitted(input, name, options, progress, clock);
    } catch (const InputError& error) {
        // Below here nobody knows the file.
        const std::string text = error.what(), nameless = "mesh: ";
        if (!text.starts_with(nameless)) throw;
        throw InputError(name, text.substr(nameless.size()));
    }
}

Solid::State openMesh(const TriangleMesh& mesh, Space space, const SolidOptions& options,
                      const Progress& progress, StageClock& clock) {
    checkOptions(options);
    const ClosedMesh input = [&] {
        const StageClock::Scope scope(clock, "read");
        LoadedMesh loaded{mesh, space, "triangles in memory"};
        loaded.unit = options.unit.value_or("");
        return closed(std::move(loaded), "mesh", options, progress);
    }();
    return fitted(input, "mesh", options, progress, clock);
}

}  // namespace isowave::lod
