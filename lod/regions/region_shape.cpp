#include "lod/regions/region_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"
#include "lod/open_mesh.h"
#include "lod/option_checks.h"
#include "volume/mesh_repair.h"

namespace isowave::lod {
namespace {

std::string optionOf(const FineRegion& region) { return "--fine " + lod::textOf(region); }

void checkBox(const FineRegion& region, const FineRegion::Box& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double extent = box.high[axis] - box.low[axis];
        if (!std::isfinite(box.low[axis]) || !std::isfinite(box.high[axis]) || !std::isfinite(extent))
            throw UsageError(optionOf(region) + ": a box has finite corners");
        if (extent == 0)
            throw UsageError(
                fmt::format("{}: the box is empty, it has no extent along {}; give two opposite "
                            "corners",
                            optionOf(region), "xyz"[axis]));
    }
}

void checkRegion(const FineRegion& region, const std::optional<StepRange>& levels) {
    if (const auto* box = std::get_if<FineRegion::Box>(&region.where)) checkBox(region, *box);
    if (!(region.within >= 0) || !std::isfinite(region.within))
        throw UsageError(fmt::format("--fine-within: {:g} is not a number from 0 on", region.within));
    if (region.level < 0)
        throw UsageError(fmt::format("{}: level {} is less than 0", optionOf(region), region.level));
    if (levels && levels->last && region.level >= *levels->last)
        throw UsageError(
            fmt::format("{}: no level is coarser than {}, --levels ends at {}; give more levels or a "
                        "finer one to the region",
                        optionOf(region), region.level, *levels->last));
}

std::shared_ptr<const TriangleHierarchy> hierarchyOf(const TriangleMesh& mesh) {
    std::vector<openvdb::Vec3d> points;
    points.reserve(mesh.points.size());
    for (const Point& p : mesh.points) points.emplace_back(p[0], p[1], p[2]);
    return std::make_shared<const TriangleHierarchy>(points, mesh.triangles);
}

// A region has no holes that could be closed by a guess: the guess would say where details stay.
RegionShape::Closed closed(TriangleMesh mesh, const std::string& name, const std::string& what,
                           const std::optional<double>& step, const Progress& progress) {
    MeshRepairReport report;
    RepairOptions asIs;
    asIs.mayStayOpen = true;
    asIs.step = step;
    RegionShape::Closed result;
    result.mesh = repairMesh(std::move(mesh), name, &report, asIs, progress);
    if (report.boundaryEdges > 0)
        throw InputError(name, fmt::format("is open ({} edges have one triangle, the first of {} loops); "
                                           "close the mesh of the {}, or give a box",
                                           report.boundaryEdges, report.boundaryLoops, what));
    result.evenOdd = report.evenOdd;
    result.nearest = hierarchyOf(result.mesh);
    return result;
}

}  // namespace

RegionShape::Closed closedMesh(TriangleMesh mesh, const std::string& what, const Progress& progress) {
    return closed(std::move(mesh), "the mesh of a " + what, what, {}, progress);
}

RegionShape::Closed closedMesh(const std::filesystem::path& path, const std::string& what,
                               const Progress& progress) {
    LoadedMesh loaded = loadMesh(path, progress);
    return closed(std::move(loaded.mesh), path.string(), what, loaded.step, progress);
}

std::string textOf(const Point& point) { return fmt::format("{:g},{:g},{:g}", point[0], point[1], point[2]); }

std::string textOf(const FineRegion& region) {
    if (const auto* box = std::get_if<FineRegion::Box>(&region.where))
        return textOf(box->low) + ":" + textOf(box->high);
    const auto* path = std::get_if<std::filesystem::path>(&region.where);
    return path ? path->string() : "a mesh";
}

const char* regionOptionOf(const LevelOptions& options) {
    if (!options.fine.empty()) return "--fine";
    return options.adaptive ? "--adaptive" : nullptr;
}

void checkRegions(const LevelOptions& options) {
    const char* option = regionOptionOf(options);
    if (!option) return;
    const auto refuse = [&](bool given, const char* what) {
        if (given) throw UsageError(std::string(option) + " and " + what);
    };
    if (options.adaptive) requirePositive("--adaptive", std::optional<double>(options.adaptive->value));
    refuse(options.steps.has_value(), "--steps exclude each other; a region keeps a level: give --levels");
    refuse(options.preserveVolume,
           "--preserve-volume exclude each other: details are blended at iso-value 0");
    refuse(options.hold == Holding::shift,
           "--hold shift exclude each other: details are blended at iso-value 0");
    refuse(options.compact, "--compact exclude each other: triangles follow the local level already");
    refuse(options.maxGenus || options.maxParts,
           "--max-genus or --max-parts exclude each other: a region brings back what a level has lost");
    for (const FineRegion& region : options.fine) checkRegion(region, options.levels);
}

PointBox RegionShape::bounds() const {
    PointBox bounds;
    if (const auto* box = std::get_if<FineRegion::Box>(&where)) {
        bounds.add(box->low), bounds.add(box->high);
    } else {
        for (const Point& p : std::get<Closed>(where).mesh.points) bounds.add(p);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) bounds.low[axis] -= within, bounds.high[axis] += within;
    return bounds;
}

RegionShape regionShapeOf(const FineRegion& region, const Progress& progress) {
    RegionShape shape{optionOf(region), {}, region.level, region.within};
    if (const auto* box = std::get_if<FineRegion::Box>(&region.where)) {
        FineRegion::Box sorted = *box;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (sorted.low[axis] > sorted.high[axis]) std::swap(sorted.low[axis], sorted.high[axis]);
        shape.where = sorted;
    } else {
        const auto* mesh = std::get_if<TriangleMesh>(&region.where);
        shape.where = mesh ? closedMesh(*mesh, "region", progress)
                           : closedMesh(std::get<std::filesystem::path>(region.where), "region", progress);
    }
    return shape;
}

}  // namespace isowave::lod
