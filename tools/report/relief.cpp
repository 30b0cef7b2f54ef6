#include "tools/report/relief.h"

#include <fmt/format.h>

namespace isowave::tools {

using subdivision::ReliefReport;

std::string textOf(const ReliefReport& report) {
    std::string out = fmt::format("{}, values {:.6g} to {:.6g}, round trip {:.1e}\n\n", report.scheme,
                                  report.range[0], report.range[1], report.roundTrip);
    if (report.positions == subdivision::Positions::limit)
        out += "levels are written at their limit positions\n\n";
    out += "level      nodes   details: rms    largest   without finer details: rms   patch\n";
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const auto& level = report.levels[k];
        const bool coarsest = k + 1 == report.levels.size();
        out += fmt::format("{:5} {:10}   {:>12} {:>10}   {:26.6g}   {}\n", k, level.nodes,
                           coarsest ? "" : fmt::format("{:.4g}", level.detailRms),
                           coarsest ? "" : fmt::format("{:.4g}", level.detailLargest), level.suppressedRms,
                           level.patch);
    }
    if (!report.compared.empty()) {
        out += "\nwithout any details, rms by scheme\n";
        for (const auto& [name, error] : report.compared)
            out += fmt::format("  {:<20} {:.6g}\n", name, error);
    }
    return out;
}

namespace {

Json treeOf(const ReliefReport& report) {
    Json j = {{"version", 1},
              {"scheme", report.scheme},
              {"range", {report.range[0], report.range[1]}},
              {"round_trip", report.roundTrip},
              {"positions", name(report.positions)}};
    auto levels = Json::array();
    for (const auto& level : report.levels) {
        levels.push_back({{"patch", level.patch},
                          {"nodes", level.nodes},
                          {"detail_rms", level.detailRms},
                          {"detail_largest", level.detailLargest},
                          {"suppressed_rms", level.suppressedRms}});
    }
    j["levels"] = levels;
    if (!report.compared.empty()) j["compared"] = report.compared;
    return j;
}

}  // namespace

std::string jsonOf(const ReliefReport& report) { return dumped(treeOf(report), 1); }

}  // namespace isowave::tools
