#include "tools/report/ladder_report.h"

#include <fmt/format.h>

#include "lod/source.h"
#include "tools/report/level_story.h"
#include "tools/report/text.h"

namespace isowave::tools {
namespace {

// ---- JSON

Json objectOf(const lod::Fields& fields) {
    Json object = Json::object();
    for (const auto& [key, text] : fields) object[key] = Json::parse(text);
    return object;
}

Json changeJson(const SolidCounts& change) {
    return {{"parts", change.parts}, {"handles", change.handles}, {"cavities", change.cavities}};
}

const char* nameOf(SolidFeature what) {
    return what == SolidFeature::part ? "part" : what == SolidFeature::handle ? "handle" : "cavity";
}

// The cuts or the fills among them.
Json editsJson(const std::vector<LevelEdit>& edits, bool fills) {
    double volume = 0;
    Json places = Json::array();
    for (const LevelEdit& edit : edits) {
        if (edit.fill != fills) continue;
        volume += edit.volume;
        places.push_back({{"what", nameOf(edit.what)}, {"at", edit.at}, {"volume", edit.volume}});
    }
    return {{"count", places.size()}, {"volume", volume}, {"places", places}};
}

Json fateJson(const FeatureFate& f) {
    return {{"survived", f.survived},
            {"vanished", f.vanished},
            {"torn", f.torn},
            {"more", f.more},
            {"smallest_surviving", orNull(f.smallestSurviving)},
            {"largest_vanished", orNull(f.largestVanished)}};
}

Json featuresJson(const std::optional<FeatureReport>& f) {
    if (!f) return nullptr;
    return {{"spacing", f->spacing},
            {"reach", f->reach},
            {"parts", fateJson(f->parts)},
            {"handles", fateJson(f->handles)},
            {"cavities", fateJson(f->cavities)}};
}

Json samplingJson(const std::optional<SamplingReport>& s) {
    if (!s) return nullptr;
    return {{"refine", s->refine},
            {"parts", s->counts.parts},
            {"genus", s->counts.handles},
            {"cavities", s->counts.cavities},
            {"thin_kept", orNull(s->thinKept)}};
}

Json wallsJson(const std::vector<WallThickness>& walls) {
    if (walls.empty()) return nullptr;
    Json json = Json::array();
    for (const WallThickness& w : walls)
        json.push_back({{"share", w.share},
                        {"voxels", w.voxels},
                        {"thickness", w.world},
                        {"kept_up_to_level", orNull(w.heldUpTo)}});
    return json;
}

Json holdJson(const std::optional<HoldSummary>& h) {
    if (!h) return nullptr;
    return {{"samples", h->samples},  {"inside_plain", h->insidePlain},
            {"inside", h->inside},    {"thickened", h->thickened},
            {"gaps_filled", h->gaps}, {"control_points", h->controlPoints},
            {"unmet", h->unmet}};
}

Json adaptiveJson(const std::optional<AdaptiveSummary>& a) {
    if (!a) return nullptr;
    return {{"tolerance", a->tolerance},
            {"max_distance", finite(a->farthest)},
            {"samples_beyond", a->samplesBeyond},
            {"rounds", a->rounds}};
}

Json regionsJson(const std::optional<RegionSummary>& r) {
    if (!r) return nullptr;
    return {
        {"control_points_fine", r->finePoints},           {"control_points_coarse", r->coarsePoints},
        {"triangles_inside", r->trianglesInside},         {"triangles_fading", r->trianglesFading},
        {"triangles_outside", r->trianglesOutside},       {"handles_inside", r->handlesInside},
        {"handles_outside", r->handlesOutside},           {"handles_level0", r->handlesOfLevel0},
        {"rms_to_level0_inside", orNull(r->rmsInside)},   {"max_to_level0_inside", orNull(r->maxInside)},
        {"rms_to_level0_outside", orNull(r->rmsOutside)}, {"max_to_level0_outside", orNull(r->maxOutside)},
        {"adaptive", adaptiveJson(r->adaptive)}};
}

Json inputJson(const std::optional<InputDistance>& d) {
    if (!d) return nullptr;
    return {{"rms_to", d->rmsTo}, {"max_to", d->maxTo}, {"rms_from", d->rmsFrom}, {"max_from", d->maxFrom}};
}

// What is known of the mesh itself.
void putMesh(Json& json, const LevelReport& level) {
    putTopology(json, level.topology);
    json["refine"] = level.refine;
    json["parts"] = level.topology.parts;
    json["cavities"] = level.topology.cavities;
    json["specks_removed"] = level.specksRemoved;
    json["speck_volume"] = level.speckVolume;
    json["bubbles_removed"] = level.bubblesRemoved;
    json["bubble_volume"] = level.bubbleVolume;
    json["iso_shift"] = level.isoShift;
    json["iso_distance"] = orNull(level.isoDistance);
    json["volume_at_iso_0"] = orNull(level.volumeAtIso0);
    json["volume_error"] = orNull(level.volumeError);
    json["thin_kept"] = orNull(level.thinKept);
    json["thin_kept_at_iso_0"] = orNull(level.thinKeptAtIso0);
    json["walls"] = wallsJson(level.walls);
    json["hold"] = holdJson(level.hold);
    json["regions"] = regionsJson(level.regions);
    json["features"] = featuresJson(level.features);
    json["cuts"] = editsJson(level.edits, false);
    json["fills"] = editsJson(level.edits, true);
    json["limits_missed"] = level.limitsMissed ? Json(*level.limitsMissed) : Json(nullptr);
    json["change"] = changeJson(level.change);
    json["sampling"] = samplingJson(level.sampling);
}

Json levelJson(const LevelReport& level, const std::string& file) {
    Json json;
    json["step"] = level.step;
    json["level"] = orNull(level.level);
    json["file"] = file.empty() ? Json(nullptr) : Json(file);
    json["spacing"] = triple(level.spacing);
    json["control_points"] = level.controlPoints;
    json["nodes"] = level.nodes;
    json["leaf_occupancy"] = level.leafOccupancy;
    json["memory_bytes"] = level.memoryBytes;
    putMesh(json, level);
    json["rms_to_level0"] = orNull(level.rmsToLevel0);
    json["max_to_level0"] = orNull(level.maxToLevel0);
    json["rms_from_level0"] = orNull(level.rmsFromLevel0);
    json["max_from_level0"] = orNull(level.maxFromLevel0);
    json["rms_to_level0_error"] = orNull(level.rmsToLevel0Error);
    json["rms_from_level0_error"] = orNull(level.rmsFromLevel0Error);
    json["to_input"] = inputJson(level.toInput);
    json["max_deviation"] = orNull(level.maxDeviation);
    json["rms_deviation"] = orNull(level.rmsDeviation);
    json["seconds"] = level.seconds;
    return json;
}

Json budgetJson(const BudgetReport& budget, const std::string& file) {
    Json json;
    json["file"] = file.empty() ? Json(nullptr) : Json(file);
    json["triangles_asked"] = orNull(budget.trianglesAsked);
    json["ratio_asked"] = budget.ratioAsked ? Json(*budget.ratioAsked) : Json(nullptr);
    json["tolerance_asked"] = budget.toleranceAsked ? Json(*budget.toleranceAsked) : Json(nullptr);
    json["max_genus"] = orNull(budget.maxGenus);
    json["min_component"] = budget.minComponent ? Json(*budget.minComponent) : Json(nullptr);
    json["step"] = budget.step;
    json["level"] = orNull(budget.level);
    json["why"] = budget.why;
    putTopology(json, budget.topology);
    json["self_intersections"] = budget.selfIntersections;
    json["rms_to_level0"] = finite(budget.toLevel0.rms);
    json["max_to_level0"] = finite(budget.toLevel0.max);
    json["max_bound_to_level0"] = finite(budget.toLevel0.maxBound);
    json["rms_from_level0"] = finite(budget.fromLevel0.rms);
    json["max_from_level0"] = finite(budget.fromLevel0.max);
    json["max_bound_from_level0"] = finite(budget.fromLevel0.maxBound);
    json["max_to_input"] = orNull(budget.maxToInput);
    json["seconds"] = budget.seconds;
    return json;
}

Json secondsJson(const Ladder& ladder) {
    Json json = Json::object();
    for (const StageSeconds& s : ladder.seconds) json[s.stage] = s.seconds;
    json["total"] = ladder.totalSeconds;
    return json;
}

std::string nameAt(const std::vector<std::string>& names, std::size_t i) {
    return i < names.size() ? names[i] : std::string();
}

// ---- text

std::string wholeText(const MeshTopology& topology) {
    return topology.closed() && topology.manifold() ? "yes" : "no";
}

std::string genusText(const MeshTopology& topology) {
    return topology.closed() && topology.manifold() ? grouped(topology.genus) : "-";
}

std::string numberText(const std::optional<double>& value) { return value ? shortNumber(*value) : "-"; }

std::string levelsText(const Ladder& ladder, const LadderFiles& files, const std::string& unit) {
    if (ladder.levels.empty()) return {};
    Table table({"file", "step", "voxel" + unit, "control points", "triangles", "components", "genus",
                 unit.empty() ? "volume" : "volume [mm^3]", "rms to level 0" + unit, "max to level 0" + unit,
                 "closed"});
    std::string stories;
    for (std::size_t i = 0; i < ladder.levels.size(); ++i) {
        const LevelReport& level = ladder.levels[i].report;
        const std::string file = nameAt(files.levels, i);
        table.row({file.empty() ? "(vanished)" : file, grouped(level.step), voxelText(level.spacing),
                   grouped(level.controlPoints), grouped(level.topology.triangles),
                   grouped(level.topology.components), genusText(level.topology),
                   shortNumber(level.topology.volume), numberText(level.rmsToLevel0),
                   numberText(level.maxToLevel0), wholeText(level.topology)});
        if (level.step != 0 && !file.empty()) stories += storyText(level, unit.empty() ? "" : " mm") + "\n";
    }
    return table.text() + stories;
}

std::string budgetsText(const Ladder& ladder, const LadderFiles& files, const std::string& unit) {
    if (ladder.budgets.empty()) return {};
    Table table({"file", "step", "triangles", "components", "genus", "volume", "max to level 0" + unit,
                 "max from level 0" + unit, "closed"});
    std::string reasons;
    for (std::size_t i = 0; i < ladder.budgets.size(); ++i) {
        const BudgetReport& b = ladder.budgets[i].report;
        const std::string file = nameAt(files.budgets, i);
        table.row({file, grouped(b.step), grouped(b.topology.triangles), grouped(b.topology.components),
                   genusText(b.topology), shortNumber(b.topology.volume), shortNumber(b.toLevel0.max),
                   shortNumber(b.fromLevel0.max), wholeText(b.topology)});
        reasons += fmt::format("{}: {}\n", file, b.why);
    }
    return table.text() + reasons;
}

}  // namespace

Json storyJson(const LevelReport& level) {
    Json json{{"step", level.step}, {"level", orNull(level.level)}, {"spacing", triple(level.spacing)}};
    putMesh(json, level);
    return json;
}

std::string jsonOf(const Ladder& ladder, const LadderFiles& files) {
    Json report;
    report["version"] = 1;
    report["input"] = objectOf(lod::fieldsOf(ladder.input));
    report["fit"] = objectOf(lod::fieldsOf(ladder.fit, ladder.input));
    report["K"] = ladder.K;
    report["first_levels"] = ladder.order.first;
    report["levels"] = Json::array();
    for (std::size_t i = 0; i < ladder.levels.size(); ++i)
        report["levels"].push_back(levelJson(ladder.levels[i].report, nameAt(files.levels, i)));
    report["budgets"] = Json::array();
    for (std::size_t i = 0; i < ladder.budgets.size(); ++i)
        report["budgets"].push_back(budgetJson(ladder.budgets[i].report, nameAt(files.budgets, i)));
    if (!files.lods.empty()) report["glb_lods"] = files.lods;
    if (!files.view.empty()) report["view"] = files.view;
    if (!files.tiles.empty()) report["tiles"] = files.tiles;
    if (files.colourRange) report["colour_range"] = *files.colourRange;
    report["steps"] = ladder.steps;
    report["coefficients_stored"] = ladder.coefficientsStored;
    report["control_points"] = ladder.controlPoints;
    report["seconds"] = secondsJson(ladder);
    report["peak_memory_bytes"] = ladder.peakMemoryBytes;
    report["threads"] = ladder.threads;
    return dumped(report);
}

std::string textOf(const Ladder& ladder, const LadderFiles& files, const std::string& unit) {
    const double ratio =
        static_cast<double>(ladder.coefficientsStored) / static_cast<double>(ladder.controlPoints);
    return levelsText(ladder, files, unit) + budgetsText(ladder, files, unit) +
           fmt::format("{} coefficients stored for {} control points (x{:.3f})\n",
                       grouped(ladder.coefficientsStored), grouped(ladder.controlPoints), ratio);
}

}  // namespace isowave::tools
