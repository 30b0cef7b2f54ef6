#include "subdivision/meshes/hierarchy_report.h"

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"

namespace isowave::subdivision {
namespace {

constexpr double kShares[] = {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5};

// The errors of an edited mesh are those of its moved base with the details as they stand.
std::vector<RebuildReport::Share> errorsAfterEdit(Hierarchy hierarchy, const std::vector<Vec3>& moved,
                                                  const Progress& progress) {
    hierarchy.base.points = moved;
    return errorByShare(hierarchy, reconstruct(hierarchy, kAllLevels, progress), progress);
}

void refuseLimit(const Hierarchy& hierarchy, const std::vector<Vec3>& moved) {
    PolygonMesh mesh = hierarchy.base;
    mesh.points = moved;
    if (isBaseAtLimit(hierarchy, mesh))
        throw InputError(
            "the moved base is at the limit positions, which are for looking at; give control positions");
}

}  // namespace

DecompositionReport reportDecomposition(const Hierarchy& hierarchy, const PolygonMesh& mesh,
                                        const Progress& progress) {
    DecompositionReport report;
    report.scheme = hierarchy.scheme;
    report.variant = hierarchy.variant;
    report.creases = hierarchy.base.creases.size();
    report.pinned = hierarchy.base.pinned.size();
    report.diagonal = diagonal(mesh.points);
    report.details = detailCount(hierarchy);
    report.kept = nonzeroDetailCount(hierarchy);
    report.levels.push_back({hierarchy.base.vertexCount(), hierarchy.base.faceCount(), 0, 0, {}});
    for (int k = 0; k <= hierarchy.steps(); ++k) {
        // One reconstruction for each level: with its details up to there, with none behind.
        int at = 0;
        const auto takeStep = [&](const SubdivisionStep& step, const std::vector<Vec3>& coarse,
                                  const std::vector<Vec3>& stored, PolygonMesh& fine) {
            if (k == 0) report.levels.push_back({fine.vertexCount(), fine.faceCount(), 0, 0, {}});
            fine.points = at++ < k ? step.reconstruct(coarse, stored) : step.subdivide(coarse);
        };
        const PointError error =
            pointError(rebuilt(hierarchy, kAllLevels, progress, takeStep).points, mesh.points);
        if (k == hierarchy.steps()) {
            report.roundTrip = error.largest;
            break;
        }
        const PointError size =
            pointError(hierarchy.details[k], std::vector<Vec3>(hierarchy.details[k].size()));
        report.levels[k].withoutDetails = error;
        report.levels[k].detailRms = size.rms;
        report.levels[k].detailLargest = size.largest;
    }
    return report;
}

void dropDetails(Hierarchy& hierarchy, const PolygonMesh& mesh, std::optional<double> shortest,
                 std::optional<std::size_t> count, DecompositionReport& report, const Progress& progress) {
    if (shortest) threshold(hierarchy, *shortest);
    if (count) keepLongest(hierarchy, *count);
    report.kept = nonzeroDetailCount(hierarchy);
    report.dropped = pointError(reconstruct(hierarchy, kAllLevels, progress).points, mesh.points);
}

std::vector<RebuildReport::Share> errorByShare(const Hierarchy& hierarchy, const PolygonMesh& whole,
                                               const Progress& progress) {
    std::vector<RebuildReport::Share> shares;
    const std::size_t all = detailCount(hierarchy);
    for (const double share : kShares) {
        Hierarchy part = hierarchy;
        keepLongest(part, static_cast<std::size_t>(share * static_cast<double>(all)));
        shares.push_back({share, nonzeroDetailCount(part),
                          pointError(reconstruct(part, kAllLevels, progress).points, whole.points)});
    }
    return shares;
}

Rebuilt rebuild(Hierarchy hierarchy, const RebuildOptions& options, const Progress& progress) {
    const std::vector<Vec3> moved = options.moved.empty() ? hierarchy.base.points : options.moved;
    refuseLimit(hierarchy, moved);
    const auto build = [&](const Hierarchy& part) {
        return reconstructEdited(part, moved, kAllLevels, options.frames, progress);
    };
    Rebuilt result{build(hierarchy), {}};
    RebuildReport& report = result.report;
    report.levels = hierarchy.steps();
    report.details = detailCount(hierarchy);
    report.diagonal = diagonal(result.mesh.points);
    if (options.shares) report.shares = errorsAfterEdit(hierarchy, moved, progress);
    if (options.threshold || options.keep) {
        if (options.threshold) threshold(hierarchy, *options.threshold);
        if (options.keep) keepLongest(hierarchy, *options.keep);
        PolygonMesh part = build(hierarchy);
        report.error = pointError(part.points, result.mesh.points);
        result.mesh = std::move(part);
    }
    report.positions = options.positions;
    if (options.positions == Positions::limit)
        result.mesh.points = limitPoints(result.mesh, hierarchy.scheme);
    report.kept = nonzeroDetailCount(hierarchy);
    report.vertices = result.mesh.vertexCount();
    report.faces = result.mesh.faceCount();
    return result;
}

std::optional<MovedVertex> firstMovedVertex(const PolygonMesh& base, const PolygonMesh& mesh) {
    const double allowed = kSameBase * diagonal(base.points);
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
        const double distance = length(mesh.points[v] - base.points[v]);
        if (distance > allowed) return MovedVertex{v, distance};
    }
    return std::nullopt;
}

bool isBaseAtLimit(const Hierarchy& hierarchy, const PolygonMesh& mesh) {
    if (!firstMovedVertex(hierarchy.base, mesh)) return false;
    PolygonMesh limit = hierarchy.base;
    limit.points = limitPoints(hierarchy.base, hierarchy.scheme);
    return !firstMovedVertex(limit, mesh);
}

}  // namespace isowave::subdivision
