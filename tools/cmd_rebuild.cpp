// isowave rebuild BASE --details FILE -o OUT: a base and its details -> the mesh at any level, edited or simplified.
#include <fmt/format.h>

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy_report.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

// Reads a mesh that must have the base's connectivity.
PolygonMesh readLikeBase(const std::filesystem::path& path, const Hierarchy& hierarchy) {
    PolygonMesh mesh = readPolygonMesh(path);
    requireManifold(mesh, path.string());
    try {
        requireSameConnectivity(hierarchy.base, mesh);
    } catch (const InputError& error) {
        throw InputError(path.string(), error.what());
    }
    return mesh;
}

// BASE is the base that the details were made for. A base that went through single precision is one still.
constexpr double kSameBase = 1e-6;

void requireBase(const std::filesystem::path& path, const std::filesystem::path& details,
                 const Hierarchy& hierarchy) {
    const PolygonMesh mesh = readLikeBase(path, hierarchy);
    const double allowed = kSameBase * diagonal(hierarchy.base.points);
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
        const double distance = length(mesh.points[v] - hierarchy.base.points[v]);
        if (distance <= allowed) continue;
        throw InputError(
            path.string(),
            fmt::format("its vertex {} lies {:.3g} away from that of the base in {}; give a base with moved "
                        "vertices as --edited",
                        v, distance, details.string()));
    }
}

}  // namespace

int runRebuild(const Settings& settings, Console& console) {
    if (!settings.details) throw UsageError("--details: is needed; isowave reverse --details FILE writes it");
    if (settings.frames && !settings.edited) throw UsageError("--frames: belongs to --edited");
    if (settings.threshold && settings.keep) throw UsageError("--threshold and --keep: give one of them");
    polygonFormatOf(*settings.output);  // a wrong name is found before the work
    Inputs({*settings.details, settings.edited.value_or(*settings.details)}).refuse(*settings.output);
    const Progress progress = console.progress();
    Hierarchy hierarchy = loadHierarchy(*settings.details, settings.depth.value_or(kAllLevels));
    requireBase(settings.files[0], *settings.details, hierarchy);
    const std::vector<Vec3> moved =
        settings.edited ? readLikeBase(*settings.edited, hierarchy).points : hierarchy.base.points;
    const auto build = [&](const Hierarchy& part) {
        try {
            return reconstructEdited(part, moved, kAllLevels, settings.frames.value_or(Frames::global),
                                     progress);
        } catch (const InputError& error) {
            throw InputError(settings.details->string(), error.what());
        }
    };

    RebuildReport report;
    report.levels = hierarchy.steps();
    report.details = detailCount(hierarchy);
    PolygonMesh mesh = build(hierarchy);
    report.diagonal = diagonal(mesh.points);
    if (settings.table) {
        Hierarchy edited = hierarchy;
        edited.base.points = moved;
        report.shares = errorByShare(edited, reconstruct(edited, kAllLevels, progress), progress);
    }
    if (settings.threshold || settings.keep) {
        if (settings.threshold) threshold(hierarchy, *settings.threshold);
        if (settings.keep) keepLongest(hierarchy, *settings.keep);
        PolygonMesh part = build(hierarchy);
        report.error = pointError(part.points, mesh.points);
        mesh = std::move(part);
    }
    report.kept = nonzeroDetailCount(hierarchy);
    report.vertices = mesh.vertexCount();
    report.faces = mesh.faceCount();

    OutputFile out(*settings.output);
    writePolygonMesh(*settings.output, mesh);
    out.commit();
    console.print(settings.json ? json(report) : text(report));
    return 0;
}

}  // namespace isowave::tools
