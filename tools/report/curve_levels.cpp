#include "tools/report/curve_levels.h"

#include <fmt/format.h>

#include <algorithm>

#include "subdivision/curves/curve_report.h"

namespace isowave::tools {

using subdivision::CurveReport;
using subdivision::kComparedSchemes;

namespace {

// O, Table 1, row "Coast": 4096 points, 6 levels.
constexpr double kPublishedCoast[] = {382.8, 327.9, 326.0};
constexpr std::size_t kMostShown = 20;  // curves in a text; the JSON has all

std::string levelsText(const CurveReport::Curve& curve, std::size_t number) {
    std::string out =
        fmt::format("\ncurve {}: {}, {}D, round trip {:.1e}\n  level   points    L2 error of P alone\n",
                    number, curve.closed ? "closed" : "open", curve.dimension, curve.roundTrip);
    for (std::size_t k = 0; k < curve.points.size(); ++k)
        out += fmt::format("  {:5} {:8}    {:.6g}\n", k, curve.points[k], curve.error[k]);
    if (curve.detailsLeft != curve.details)
        out += fmt::format("  {} of {} details left, L2 error {:.6g}\n", curve.detailsLeft, curve.details,
                           curve.thresholdError);
    return out;
}

std::string ratiosText(const std::string& label, double trial, double refined, double optimal) {
    return fmt::format("{:<30} {:9.5g} {:9.5g} {:9.5g}   {:13.3f}  {:13.3f}\n", label, trial, refined,
                       optimal, refined / trial, optimal / trial);
}

std::string comparisonText(const CurveReport& report) {
    std::string out =
        "\nL2 error of the coarsest level     trial   refined   optimal   refined/trial  optimal/trial\n";
    double refined = 0, optimal = 0;
    std::size_t counted = 0;
    for (std::size_t c = 0; c < report.curves.size(); ++c) {
        const auto& e = report.curves[c].compared;
        const double trial = e.at(kComparedSchemes[0]);
        if (trial <= 0) continue;
        refined += e.at(kComparedSchemes[1]) / trial;
        optimal += e.at(kComparedSchemes[2]) / trial;
        ++counted;
        if (c >= kMostShown) continue;
        out += ratiosText(fmt::format("curve {:<4} ({:7} points)      ", c + 1, report.curves[c].points[0]),
                          trial, e.at(kComparedSchemes[1]), e.at(kComparedSchemes[2]));
    }
    if (counted > 1) {
        const double n = static_cast<double>(counted);
        out += fmt::format("{:<61}   {:13.3f}  {:13.3f}\n", fmt::format("mean of {} curves", counted),
                           refined / n, optimal / n);
    }
    return out + ratiosText("published: Coast (4096, 6 levels)", kPublishedCoast[0], kPublishedCoast[1],
                            kPublishedCoast[2]);
}

}  // namespace

std::string textOf(const CurveReport& report) {
    std::string out = fmt::format("{}, {} levels, {} curve{}\n", report.scheme, report.levels,
                                  report.curves.size(), report.curves.size() == 1 ? "" : "s");
    if (report.positions == subdivision::Positions::limit)
        out += "points are written at their limit positions\n";
    const std::size_t shown = std::min(report.curves.size(), kMostShown);
    for (std::size_t c = 0; c < shown; ++c) out += levelsText(report.curves[c], c + 1);
    if (shown < report.curves.size())
        out += fmt::format("\n.. and {} more (--json has all)\n", report.curves.size() - shown);
    if (!report.curves.empty() && !report.curves[0].compared.empty()) out += comparisonText(report);
    return out;
}

namespace {

Json treeOf(const CurveReport& report) {
    Json j = {{"version", 1},
              {"scheme", report.scheme},
              {"levels", report.levels},
              {"positions", name(report.positions)}};
    auto curves = Json::array();
    for (const auto& curve : report.curves) {
        Json one = {{"dimension", curve.dimension},     {"closed", curve.closed},
                    {"points", curve.points},           {"l2_error", curve.error},
                    {"round_trip", curve.roundTrip},    {"details", curve.details},
                    {"details_left", curve.detailsLeft}};
        if (curve.detailsLeft != curve.details) one["threshold_l2_error"] = curve.thresholdError;
        if (!curve.compared.empty()) one["compared"] = curve.compared;
        curves.push_back(one);
    }
    j["curves"] = curves;
    return j;
}

}  // namespace

std::string jsonOf(const CurveReport& report) { return dumped(treeOf(report), 1); }

std::vector<std::string> remarks(const CurveReport& report) {
    std::vector<std::string> lines;
    if (report.tooShort > 0)
        lines.push_back(
            fmt::format("{} of {} curves are too short for {} levels and stay at the coarsest they have",
                        report.tooShort, report.curves.size(), report.levels));
    if (report.withoutLimit > 0)
        lines.push_back(
            fmt::format("{} of {} curves have too few points for limit positions and stay as they are",
                        report.withoutLimit, report.curves.size()));
    return lines;
}

}  // namespace isowave::tools
