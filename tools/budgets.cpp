#include "tools/budgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace isowave::tools {

Budgets::Budgets(const Settings& settings, std::string name, MeshFormat format)
    : name_(std::move(name)), format_(format), limits_{settings.maxGenus, settings.minComponent} {
    for (const std::int64_t n : settings.budgetTriangles)
        asked_.push_back({{Budget::Kind::triangles, static_cast<double>(n)}, 0, fmt::format("T{}", n)});
    for (const double ratio : settings.budgetRatios)
        asked_.push_back({{Budget::Kind::triangles, 0}, ratio, fmt::format("R{:g}", ratio)});
    for (const double distance : settings.budgetTolerances)
        asked_.push_back({{Budget::Kind::distance, distance}, 0, fmt::format("D{:g}", distance)});
    if (asked_.empty() && (limits_.maxGenus || limits_.minComponent)) asked_.push_back({{}, 0, "chosen"});
    if (wanted() && settings.openBorder)
        throw UsageError("budgets and limits on the topology need closed meshes; leave --open-border out");
}

std::string Budgets::fileName(const Asked& asked) const {
    return fmt::format("{}_{}{}", name_, asked.suffix, extensionOf(format_));
}

std::vector<std::string> Budgets::fileNames() const {
    std::vector<std::string> names;
    for (const Asked& asked : asked_) names.push_back(fileName(asked));
    return names;
}

void Budgets::add(int step, const BSplineField& field, const TriangleMesh& mesh,
                  const MeshTopology& topology) {
    if (steps_.empty()) finestTriangles_ = topology.triangles;
    steps_.push_back({step, mesh, topology, field.transform().voxelSize().length()});
}

Json Budgets::written(const Asked& asked, BudgetChooser& chooser, OutputFolder& out, Space space,
                      Console& console, StageClock& clock) const {
    const double begin = clock.secondsSoFar();
    Budget budget = asked.budget;
    if (asked.ratio > 0) budget.value = std::round(asked.ratio * static_cast<double>(finestTriangles_));
    const BudgetMesh made = [&] {
        const StageClock::Scope scope(clock, "collapse");
        return chooser.choose(budget, console.progress());
    }();
    const std::string file = fileName(asked);
    {
        const StageClock::Scope scope(clock, "write");
        writeMesh(out.place(file), made.mesh, format_, {.space = space});
    }
    const StageClock::Scope scope(clock, "measure");
    const bool count = budget.kind == Budget::Kind::triangles;
    const bool distance = budget.kind == Budget::Kind::distance;
    Json json;
    json["file"] = file;
    json["triangles_asked"] = count ? Json(static_cast<std::int64_t>(budget.value)) : Json(nullptr);
    json["ratio_asked"] = asked.ratio > 0 ? Json(asked.ratio) : Json(nullptr);
    json["tolerance_asked"] = distance ? Json(budget.value) : Json(nullptr);
    json["max_genus"] = limits_.maxGenus ? Json(*limits_.maxGenus) : Json(nullptr);
    json["min_component"] = limits_.minComponent ? Json(*limits_.minComponent) : Json(nullptr);
    json["step"] = made.step;
    json["why"] = made.why;
    putTopology(json, topologyOf(made.mesh));
    json["self_intersections"] = countSelfIntersections(made.mesh, console.progress());
    json["rms_to_level0"] = finite(made.distance.aToB.rms);
    json["max_to_level0"] = finite(made.distance.aToB.max);
    json["max_bound_to_level0"] = finite(made.distance.aToB.maxBound);
    json["rms_from_level0"] = finite(made.distance.bToA.rms);
    json["max_from_level0"] = finite(made.distance.bToA.max);
    json["max_bound_from_level0"] = finite(made.distance.bToA.maxBound);
    json["seconds"] = clock.secondsSoFar() - begin;
    return json;
}

Json Budgets::write(OutputFolder& out, Space space, const std::string& input, Console& console,
                    StageClock& clock) {
    BudgetChooser chooser(std::move(steps_), limits_, input);
    Json list = Json::array();
    for (const Asked& asked : asked_) list.push_back(written(asked, chooser, out, space, console, clock));
    return list;
}

std::string Budgets::tableOf(const Json& budgets, const std::string& unit) {
    Table table({"file", "step", "triangles", "components", "genus", "volume", "max to level 0" + unit,
                 "max from level 0" + unit, "closed"});
    std::string reasons;
    for (const Json& b : budgets) {
        const auto whole = [&](const char* key) { return grouped(b[key].get<std::int64_t>()); };
        const auto number = [&](const char* key) { return shortNumber(b[key].get<double>()); };
        table.row({b["file"].get<std::string>(), whole("step"), whole("triangles"), whole("components"),
                   b["genus"].is_null() ? "-" : whole("genus"), number("volume"), number("max_to_level0"),
                   number("max_from_level0"),
                   b["closed"].get<bool>() && b["manifold"].get<bool>() ? "yes" : "no"});
        reasons += fmt::format("{}: {}\n", b["file"].get<std::string>(), b["why"].get<std::string>());
    }
    return table.text() + reasons;
}

}  // namespace isowave::tools
