#include "tools/report/hierarchy.h"

#include <fmt/format.h>

namespace isowave::tools {

using subdivision::DecompositionReport;
using subdivision::LevelsRebuildReport;
using subdivision::PointError;
using subdivision::Positions;
using subdivision::RebuildReport;

namespace {

Json errorJson(const PointError& error) { return {{"rms", error.rms}, {"largest", error.largest}}; }

// In units of the mesh, and in percent of its diagonal.
std::string relative(double value, double diagonal) {
    return diagonal > 0 ? fmt::format("{:.3g} ({:.2g} %)", value, 100 * value / diagonal)
                        : fmt::format("{:.3g}", value);
}

// What leaving details out has cost.
std::string withoutOthers(const PointError& error, double extent) {
    return fmt::format("without the others rms {}, largest {}", relative(error.rms, extent),
                       relative(error.largest, extent));
}

std::string atPositions(Positions positions) {
    return positions == Positions::limit ? ", at limit positions" : "";
}

}  // namespace

std::string textOf(const DecompositionReport& report) {
    std::string out = fmt::format(
        "{}, {}; creases {}, marked corners {}; round trip {:.1e} of the diagonal {:.6g}\n\n", report.scheme,
        report.variant, report.creases, report.pinned,
        report.diagonal > 0 ? report.roundTrip / report.diagonal : report.roundTrip, report.diagonal);
    if (report.positions == Positions::limit) out += "the base is written at its limit positions\n\n";
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
    if (report.kept < report.details && report.dropped.largest > 0)
        out += fmt::format("\n{} of {} details are kept; {}\n", report.kept, report.details,
                           withoutOthers(report.dropped, report.diagonal));
    return out;
}

namespace {

Json treeOf(const DecompositionReport& report) {
    Json j = {{"version", 1},
              {"scheme", report.scheme},
              {"variant", report.variant},
              {"creases", report.creases},
              {"pinned", report.pinned},
              {"diagonal", report.diagonal},
              {"round_trip", report.roundTrip},
              {"positions", name(report.positions)}};
    auto levels = Json::array();
    for (const auto& level : report.levels) {
        levels.push_back({{"vertices", level.vertices},
                          {"faces", level.faces},
                          {"detail_rms", level.detailRms},
                          {"detail_largest", level.detailLargest},
                          {"without_details", errorJson(level.withoutDetails)}});
    }
    j["levels"] = levels;
    j["details"] = report.details;
    j["kept"] = report.kept;
    j["dropped"] = errorJson(report.dropped);
    return j;
}

}  // namespace

std::string jsonOf(const DecompositionReport& report) { return dumped(treeOf(report), 1); }

std::string textOf(const RebuildReport& report) {
    std::string out =
        fmt::format("{} vertices, {} faces after {} subdivision{}; {} of {} details", report.vertices,
                    report.faces, report.levels, report.levels == 1 ? "" : "s", report.kept, report.details);
    if (report.error.largest > 0) out += "; " + withoutOthers(report.error, report.diagonal);
    out += atPositions(report.positions) + "\n";
    if (report.shares.empty()) return out;
    out += "\nlongest details      kept   error: rms              largest\n";
    for (const auto& share : report.shares) {
        out += fmt::format("{:>13.0f} % {:>9}   {:<22}  {}\n", 100 * share.share, share.kept,
                           relative(share.error.rms, report.diagonal),
                           relative(share.error.largest, report.diagonal));
    }
    return out;
}

namespace {

Json treeOf(const RebuildReport& report) {
    Json j = {{"version", 1},
              {"levels", report.levels},
              {"vertices", report.vertices},
              {"faces", report.faces},
              {"details", report.details},
              {"kept", report.kept},
              {"diagonal", report.diagonal},
              {"positions", name(report.positions)},
              {"error", errorJson(report.error)}};
    if (!report.shares.empty()) {
        auto shares = Json::array();
        for (const auto& share : report.shares)
            shares.push_back(
                {{"share", share.share}, {"kept", share.kept}, {"error", errorJson(share.error)}});
        j["shares"] = shares;
    }
    return j;
}

}  // namespace

std::string jsonOf(const RebuildReport& report) { return dumped(treeOf(report), 1); }

std::string textOf(const LevelsRebuildReport& report) {
    std::string out = fmt::format("{} points after {} subdivision{}; {} of {} details", report.points,
                                  report.levels, report.levels == 1 ? "" : "s", report.kept, report.details);
    if (report.error.largest > 0) out += "; " + withoutOthers(report.error, report.extent);
    return out + atPositions(report.positions) + "\n";
}

std::string jsonOf(const LevelsRebuildReport& report) {
    const Json tree = {{"version", 1},
                       {"levels", report.levels},
                       {"pieces", report.pieces},
                       {"points", report.points},
                       {"details", report.details},
                       {"kept", report.kept},
                       {"extent", report.extent},
                       {"positions", name(report.positions)},
                       {"error", errorJson(report.error)}};
    return dumped(tree, 1);
}

std::string textOf(const SubdivisionReport& report) {
    return fmt::format("{}, {} level{}: {} vertices, {} faces{}\n", report.scheme, report.levels,
                       report.levels == 1 ? "" : "s", report.vertices, report.faces,
                       atPositions(report.positions));
}

namespace {

Json treeOf(const SubdivisionReport& report) {
    return {{"version", 1},
            {"scheme", report.scheme},
            {"levels", report.levels},
            {"creases", report.creases},
            {"positions", name(report.positions)},
            {"vertices", report.vertices},
            {"faces", report.faces}};
}

}  // namespace

std::string jsonOf(const SubdivisionReport& report) { return dumped(treeOf(report), 1); }

}  // namespace isowave::tools
