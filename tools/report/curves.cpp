#include "tools/report/curves.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/report/text.h"

namespace isowave::tools {

using curves2d::Fit;
using curves2d::Ladder;
using curves2d::StepFacts;

namespace {

Json fitJson(const Ladder& ladder) {
    Json json;
    json["method"] = ladder.fit == Fit::binary ? "binary" : "distance";
    if (ladder.fit == Fit::distance) {
        json["half_width"] = ladder.halfWidth;
        json["band"] = ladder.band;
    }
    const curves2d::FitReport& report = ladder.fitReport;
    json["lattice_points"] = report.latticePoints;
    json["disagreeing"] = report.disagreeing;
    json["repair_passes"] = report.repairPasses;
    json["repaired"] = report.repaired;
    json["repair_floor"] = report.repairFloor;
    json["stopped"] = report.repairAgreed ? "agreed" : "pass_limit";
    return json;
}

Json holdJson(const curves2d::HoldFacts& hold) {
    return {{"samples", hold.samples}, {"kept", hold.kept},       {"sampling", hold.sampling},
            {"changed", hold.changed}, {"islands", hold.islands}, {"joined", hold.joined},
            {"opened", hold.opened},   {"dropped", hold.dropped}, {"filled", hold.filled},
            {"area", hold.area}};
}

void putFacts(Json& json, const StepFacts& f) {
    json["domain"] = f.domain;
    json["control_points"] = f.controlPoints;
    json["nodes"] = f.nodes;
    json["rings"] = f.rings;
    json["holes"] = f.holes;
    json["points"] = f.points;
    json["area"] = f.area;
    const bool known = f.points > 0;
    json["max_to_level0"] = known ? finite(f.maxToLevel0) : Json(nullptr);
    json["rms_to_level0"] = known ? finite(f.rmsToLevel0) : Json(nullptr);
    json["hold"] = f.hold ? holdJson(*f.hold) : Json(nullptr);
}

Json levelOf(const StepFacts& f) { return f.step % 2 == 0 ? Json(f.step / 2) : Json(nullptr); }

Json stepJson(const CurvesReport::Step& step) {
    Json json{{"step", step.facts.step}, {"level", levelOf(step.facts)}};
    json["file"] = step.file ? Json(*step.file) : Json(nullptr);
    putFacts(json, step.facts);
    return json;
}

// Thin samples, the share kept, changed control points; what opened or dropped, what joined or filled.
std::vector<std::string> holdCells(const StepFacts& facts) {
    if (!facts.hold) return {"", "", "", ""};
    const curves2d::HoldFacts& h = *facts.hold;
    return {isowave::grouped(h.samples), h.samples ? fmt::format("{:.1f}", 100 * h.kept) : "",
            isowave::grouped(h.changed), fmt::format("{}, {}", h.opened + h.dropped, h.joined + h.filled)};
}

std::string grouped(std::size_t count) { return isowave::grouped(static_cast<std::int64_t>(count)); }

Json treeOf(const CurvesReport& report) {
    Json json;
    json["version"] = 1;
    json["input"] = {{"path", report.path}, {"kind", report.kind}, {"pixel", report.pixel}};
    json["fit"] = fitJson(report.ladder);
    if (report.smooth)
        json["smooth"] = {{"deviation", report.deviation * report.pixel},
                          {"straight_pieces", report.straightPieces}};
    json["steps"] = Json::array();
    for (const CurvesReport::Step& step : report.steps) json["steps"].push_back(stepJson(step));
    json["hold"] = report.hold == curves2d::Hold::local ? "local" : "none";
    json["coefficients_stored"] = report.ladder.coefficients;
    json["control_points"] = report.ladder.controlPoints;
    json["peak_memory_bytes"] = report.peakMemoryBytes;
    return json;
}

}  // namespace

std::string jsonOf(const CurvesReport& report) { return dumped(treeOf(report), 2); }

namespace {

std::string tableOf(const std::vector<StepFacts>& steps) {
    Table table({"step", "domain", "|I|", "nodes", "rings", "holes", "points", "area", "thin", "kept %",
                 "changed", "cuts, fills"});
    for (const StepFacts& f : steps) {
        std::vector<std::string> row{curves2d::stepName(f.step),
                                     fmt::format("{}x{}", f.domain[0], f.domain[1]),
                                     tools::grouped(f.controlPoints),
                                     tools::grouped(f.nodes),
                                     grouped(f.rings),
                                     grouped(f.holes),
                                     grouped(f.points),
                                     shortNumber(f.area)};
        for (std::string& cell : holdCells(f)) row.push_back(std::move(cell));
        table.row(row);
    }
    return table.text();
}

double ratioOf(const Ladder& ladder) {
    return static_cast<double>(ladder.coefficients) /
           static_cast<double>(std::max<std::int64_t>(1, ladder.controlPoints));
}

}  // namespace

std::string table(const CurvesReport& report) {
    std::vector<StepFacts> steps;
    for (const CurvesReport::Step& step : report.steps) steps.push_back(step.facts);
    return tableOf(steps);
}

std::string summary(const CurvesReport& report, const std::string& folder) {
    const Ladder& ladder = report.ladder;
    return fmt::format("{}: {}, {} control points, {} coefficients (+{:.1f} %), {} files\n", folder,
                       report.kind, tools::grouped(ladder.controlPoints), tools::grouped(ladder.coefficients),
                       100.0 * (ratioOf(ladder) - 1), report.files);
}

std::vector<std::string> fitRemarks(const curves2d::FitReport& report) {
    if (!report.disagreeing) return {};
    return {fmt::format("{} of {} lattice points have another sign than the input", report.disagreeing,
                        report.latticePoints)};
}

std::string smoothRemark(const CurvesReport& report) {
    const std::string straight =
        report.straightPieces ? fmt::format("; {} pieces in squares that hold a sharp bend are straight",
                                            grouped(report.straightPieces))
                              : "";
    return fmt::format("the smooth curves stay within {} pixels of the zero set{}",
                       shortNumber(report.deviation), straight);
}

// ---- info

std::string jsonOf(const CurvePyramidInfo& info) {
    const auto corner = [](curves2d::Point p) { return std::array{p.x, p.y}; };
    Json json{
        {"version", 1}, {"path", info.path}, {"kind", "curves"}, {"format_version", info.formatVersion}};
    json["K"] = info.K;
    json["input"] = {{"kind", info.kind},
                     {"pixel", info.pixel},
                     {"extent", {corner(info.extent.low), corner(info.extent.high)}},
                     {"y_up", info.yUp}};
    json["fit"] = fitJson(info.ladder);
    json["coefficients_stored"] = info.ladder.coefficients;
    json["control_points"] = info.ladder.controlPoints;
    json["file_bytes"] = info.fileBytes;
    json["steps"] = Json::array();
    for (const StepFacts& f : info.steps) {
        Json step{{"step", f.step}, {"level", levelOf(f)}};
        putFacts(step, f);
        json["steps"].push_back(std::move(step));
    }
    return dumped(json);
}

std::string textOf(const CurvePyramidInfo& info) {
    const Ladder& ladder = info.ladder;
    std::string text =
        fmt::format("{}: pyramid of curves of {} steps, K {:g}\n", info.path, info.steps.size() - 1, info.K);
    text +=
        fmt::format("input      {}, {} fit\n", info.kind, ladder.fit == Fit::binary ? "binary" : "distance");
    text += fmt::format("pixel      {:.6g}, y points {}\n", info.pixel, info.yUp ? "up" : "down");
    text += fmt::format("from       {:.6g} {:.6g}\nto         {:.6g} {:.6g}\n", info.extent.low.x,
                        info.extent.low.y, info.extent.high.x, info.extent.high.y);
    text += tableOf(info.steps);
    text +=
        fmt::format("{} coefficients for {} control points (x{:.3f})\n", tools::grouped(ladder.coefficients),
                    tools::grouped(ladder.controlPoints), ratioOf(ladder));
    return text + fmt::format("{} on disk ({:.2f} bytes a control point)\n",
                              bytesText(static_cast<double>(info.fileBytes)),
                              static_cast<double>(info.fileBytes) /
                                  static_cast<double>(std::max<std::int64_t>(1, ladder.controlPoints)));
}

}  // namespace isowave::tools
