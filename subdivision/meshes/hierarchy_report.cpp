#include "subdivision/meshes/hierarchy_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace isowave::subdivision {
namespace {

nlohmann::ordered_json errorJson(const PointError& error) {
    return {{"rms", error.rms}, {"largest", error.largest}};
}

// In units of the mesh, and in percent of its diagonal.
std::string relative(double value, double diagonal) {
    return diagonal > 0 ? fmt::format("{:.3g} ({:.2g} %)", value, 100 * value / diagonal)
                        : fmt::format("{:.3g}", value);
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
    report.levels.push_back({hierarchy.base.vertexCount(), hierarchy.base.faceCount(), 0, 0, {}});
    for (int k = 0; k <= hierarchy.steps(); ++k) {
        // One climb for each level: with its details up to there, with none behind.
        int at = 0;
        const auto climb = [&](const SubdivisionStep& step, const std::vector<Vec3>& coarse,
                               const std::vector<Vec3>& stored, PolygonMesh& fine) {
            if (k == 0) report.levels.push_back({fine.vertexCount(), fine.faceCount(), 0, 0, {}});
            fine.points = at++ < k ? step.reconstruct(coarse, stored) : step.subdivide(coarse);
        };
        const PointError error =
            pointError(rebuilt(hierarchy, kAllLevels, progress, climb).points, mesh.points);
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

std::string text(const DecompositionReport& report) {
    std::string out = fmt::format(
        "{}, {}; creases {}, marked corners {}; round trip {:.1e} of the diagonal {:.6g}\n\n", report.scheme,
        report.variant, report.creases, report.pinned,
        report.diagonal > 0 ? report.roundTrip / report.diagonal : report.roundTrip, report.diagonal);
    out +=
        "subdivisions   vertices      faces   details to the next: rms   largest   to the finest without "
        "details: rms\n";
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const auto& level = report.levels[k];
        const bool finest = k + 1 == report.levels.size();
        out +=
            fmt::format("{:12} {:10} {:10}   {:>24} {:>9}   {:>34}\n", k == 0 ? "base" : fmt::format("{}", k),
                        level.vertices, level.faces, finest ? "" : fmt::format("{:.3g}", level.detailRms),
                        finest ? "" : fmt::format("{:.3g}", level.detailLargest),
                        finest ? "" : relative(level.withoutDetails.rms, report.diagonal));
    }
    return out;
}

std::string json(const DecompositionReport& report) {
    nlohmann::ordered_json j = {{"version", 1},
                                {"scheme", report.scheme},
                                {"variant", report.variant},
                                {"creases", report.creases},
                                {"pinned", report.pinned},
                                {"diagonal", report.diagonal},
                                {"round_trip", report.roundTrip}};
    auto levels = nlohmann::ordered_json::array();
    for (const auto& level : report.levels) {
        levels.push_back({{"vertices", level.vertices},
                          {"faces", level.faces},
                          {"detail_rms", level.detailRms},
                          {"detail_largest", level.detailLargest},
                          {"without_details", errorJson(level.withoutDetails)}});
    }
    j["levels"] = levels;
    return j.dump(1) + "\n";
}

std::vector<RebuildReport::Share> errorByShare(const Hierarchy& hierarchy, const PolygonMesh& whole,
                                               const Progress& progress) {
    std::vector<RebuildReport::Share> shares;
    const std::size_t all = detailCount(hierarchy);
    for (const double share : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}) {
        Hierarchy part = hierarchy;
        keepLongest(part, static_cast<std::size_t>(share * static_cast<double>(all)));
        shares.push_back({share, nonzeroDetailCount(part),
                          pointError(reconstruct(part, kAllLevels, progress).points, whole.points)});
    }
    return shares;
}

std::string text(const RebuildReport& report) {
    std::string out =
        fmt::format("{} vertices, {} faces after {} subdivision{}; {} of {} details", report.vertices,
                    report.faces, report.levels, report.levels == 1 ? "" : "s", report.kept, report.details);
    if (report.error.largest > 0) {
        out += fmt::format("; without the others rms {}, largest {}",
                           relative(report.error.rms, report.diagonal),
                           relative(report.error.largest, report.diagonal));
    }
    out += "\n";
    if (report.shares.empty()) return out;
    out += "\nlongest details      kept   error: rms              largest\n";
    for (const auto& share : report.shares) {
        out += fmt::format("{:>13.0f} % {:>9}   {:<22}  {}\n", 100 * share.share, share.kept,
                           relative(share.error.rms, report.diagonal),
                           relative(share.error.largest, report.diagonal));
    }
    return out;
}

std::string json(const RebuildReport& report) {
    nlohmann::ordered_json j = {{"version", 1},
                                {"levels", report.levels},
                                {"vertices", report.vertices},
                                {"faces", report.faces},
                                {"details", report.details},
                                {"kept", report.kept},
                                {"diagonal", report.diagonal},
                                {"error", errorJson(report.error)}};
    if (!report.shares.empty()) {
        auto shares = nlohmann::ordered_json::array();
        for (const auto& share : report.shares)
            shares.push_back(
                {{"share", share.share}, {"kept", share.kept}, {"error", errorJson(share.error)}});
        j["shares"] = shares;
    }
    return j.dump(1) + "\n";
}

}  // namespace isowave::subdivision
