#include "tools/report/info_report.h"

#include <fmt/format.h>

#include "lod/open_image.h"
#include "lod/source.h"
#include "tools/report/ladder_report.h"
#include "tools/report/level_story.h"
#include "tools/report/mesh_json.h"
#include "tools/report/text.h"

namespace isowave::tools {
namespace {

Json start(const std::string& path, const char* kind) {
    Json json;
    json["version"] = 1;
    json["path"] = path;
    json["kind"] = kind;
    return json;
}

std::string triples(const std::array<double, 3>& v) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", v[0], v[1], v[2]);
}

Json metadataJson(const VdbInfo::Metadata& metadata) {
    Json json = Json::object();
    for (const auto& [key, text] : metadata) json[key] = text;
    return json;
}

// How the file's axes are called.
const char* spaceText(Space space) {
    return space == Space::lps ? " (LPS)" : space == Space::ras ? " (LPS; the file is RAS)" : "";
}

std::string timesText(const std::array<double, 3>& v) {
    return fmt::format("{:.4g}x{:.4g}x{:.4g}", v[0], v[1], v[2]);
}

std::string timesText(const std::array<std::int64_t, 3>& v) {
    return fmt::format("{}x{}x{}", v[0], v[1], v[2]);
}

}  // namespace

// ---- images

std::string jsonOf(const ImageInfo& info) {
    const Image& image = info.header;
    const ImageStatistics& statistics = info.statistics;
    Json json = start(info.path, "image");
    json["format"] = image.format;
    json["component_type"] = image.componentType;
    json["dimensions"] = image.size;
    json["spacing"] = image.spacing();
    json["origin"] = image.indexToWorld.origin;
    json["direction"] = lod::directionOf(image);
    json["space"] = lod::nameOf(image.space);
    json["unit"] = image.unit;
    json["range"] = {finite(statistics.low), finite(statistics.high)};
    for (const auto& [percent, value] : statistics.percentiles)
        json["percentiles"][std::to_string(percent)] = finite(value);
    json["distinct_values"] = statistics.distinct.empty() ? Json(nullptr) : Json(statistics.distinct);
    json["warnings"] = image.warnings;
    return dumped(json);
}

std::string textOf(const ImageInfo& info) {
    const Image& image = info.header;
    std::string text = fmt::format("{}: {}, {}\n", info.path, image.format, image.componentType);
    text += fmt::format("size       {} x {} x {} voxels\n", image.size[0], image.size[1], image.size[2]);
    text += fmt::format("spacing    {} {}\n", triples(image.spacing()), image.unit);
    text += fmt::format("origin     {} {}{}\n", triples(image.indexToWorld.origin), image.unit,
                        spaceText(image.space));
    const auto direction = lod::directionOf(image);
    for (std::size_t axis = 0; axis < 3; ++axis)
        text += fmt::format("{} {} runs {}\n", axis == 0 ? "direction " : "          ", "xyz"[axis],
                            triples(direction[axis]));
    text += fmt::format("values     {}\n", lod::rangeText(info.statistics));
    if (info.statistics.distinct.empty()) return text;
    text += "distinct  ";
    for (const float value : info.statistics.distinct)
        text += fmt::format(" {}", value);  // as --label takes it
    return text + "\n";
}

// ---- meshes

std::string jsonOf(const MeshInfo& info) {
    Json json = start(info.path, "mesh");
    json["format"] = info.format;
    json["space"] = lod::nameOf(info.space);
    putTopology(json, info.topology);
    json["boundary_edges"] = info.topology.boundaryEdges;
    json["bounds"] = {info.low, info.high};
    return dumped(json);
}

std::string textOf(const MeshInfo& info) {
    const MeshTopology& topology = info.topology;
    std::string text =
        fmt::format("{}: {}, {}, {}\n", info.path, info.format, counted(topology.triangles, "triangle"),
                    counted(topology.vertices, "vertex", "vertices"));
    text += fmt::format("from       {}{}\nto         {}\n", triples(info.low), spaceText(info.space),
                        triples(info.high));
    return text +
           fmt::format("components {}, volume {}, area {}, {}\n", grouped(topology.components),
                       shortNumber(topology.volume), shortNumber(topology.area),
                       topology.closed() ? "closed" : grouped(topology.boundaryEdges) + " boundary edges");
}

// ---- .vdb

std::string jsonOf(const VdbInfo& info) {
    Json json = start(info.path, "vdb");
    json["metadata"] = metadataJson(info.metadata);
    json["grids"] = Json::array();
    for (const VdbInfo::Grid& grid : info.grids)
        json["grids"].push_back({{"name", grid.name},
                                 {"type", grid.type},
                                 {"class", grid.gridClass},
                                 {"active_voxels", grid.activeVoxels},
                                 {"dimensions", grid.dimensions},
                                 {"spacing", triple(grid.spacing)},
                                 {"metadata", metadataJson(grid.metadata)}});
    return dumped(json);
}

std::string textOf(const VdbInfo& info) {
    Table table({"grid", "type", "class", "active voxels", "box", "voxel"});
    for (const VdbInfo::Grid& grid : info.grids)
        table.row({grid.name, grid.type, grid.gridClass, grouped(grid.activeVoxels),
                   timesText(grid.dimensions), timesText(grid.spacing)});
    return fmt::format("{}: {}\n", info.path, counted(static_cast<std::int64_t>(info.grids.size()), "grid")) +
           table.text();
}

// ---- pyramids

Json stepsJson(const std::vector<StepFacts>& steps) {
    Json json = Json::array();
    for (const StepFacts& f : steps)
        json.push_back({{"step", f.step},
                        {"level", f.level ? Json(*f.level) : Json(nullptr)},
                        {"halved", f.halvedAxis ? Json(std::string(1, "xyz"[*f.halvedAxis])) : Json(nullptr)},
                        {"spacing", triple(f.spacing)},
                        {"domain", f.domain},
                        {"control_points", f.controlPoints},
                        {"nodes", f.nodes},
                        {"details", f.details},
                        {"coefficients", f.coefficients},
                        {"leaf_occupancy", f.leafOccupancy}});
    return json;
}

std::string jsonOf(const PyramidInfo& info) {
    Json json = start(info.path, "pyramid");
    json["packed"] = info.packed;
    json["format_version"] = info.formatVersion;
    json["K"] = info.K;
    json["source"] = info.source;
    json["coefficients_stored"] = info.coefficientsStored;
    json["control_points"] = info.controlPoints;
    json["memory_bytes"] = info.memoryBytes;
    json["file_bytes"] = info.fileBytes;
    json["first_levels"] = info.order.first;
    json["steps"] = stepsJson(info.steps);
    json["levels"] = Json::array();
    for (const LevelReport& level : info.levels) json["levels"].push_back(storyJson(level));
    return dumped(json);
}

std::string textOf(const PyramidInfo& info) {
    Table table({"step", "level", "halved", "voxel", "domain", "control points", "nodes", "details",
                 "coefficients", "leaves full"});
    for (const StepFacts& f : info.steps)
        table.row({std::to_string(f.step), f.level ? std::to_string(*f.level) : "",
                   std::string(1, f.halvedAxis ? "xyz"[*f.halvedAxis] : '-'), timesText(f.spacing),
                   timesText(f.domain), grouped(f.controlPoints), grouped(f.nodes), grouped(f.details),
                   grouped(f.coefficients), fmt::format("{:.0f} %", 100 * f.leafOccupancy)});
    std::string text = fmt::format("{}: {} of {} steps, K {:g}\n", info.path,
                                   info.packed ? "packed solid" : "pyramid", info.steps.size() - 1, info.K);
    for (const auto& [key, value] : info.source) text += fmt::format("{:<22}{}\n", key, value);
    text += table.text();
    const auto perPoint = [&](std::int64_t n) {
        return static_cast<double>(n) / static_cast<double>(info.controlPoints);
    };
    text += fmt::format("{} coefficients stored for {} control points (x{:.3f})\n",
                        grouped(info.coefficientsStored), grouped(info.controlPoints),
                        perPoint(info.coefficientsStored));
    text += fmt::format("{} in memory ({:.1f} bytes a control point), {} on disk ({:.2f})\n",
                        bytesText(static_cast<double>(info.memoryBytes)), perPoint(info.memoryBytes),
                        bytesText(static_cast<double>(info.fileBytes)), perPoint(info.fileBytes));
    const auto input = lod::inputOfSource(info.source);
    const std::string unit = input ? lod::unitOf(*input) : "";
    for (const LevelReport& level : info.levels)
        text += storyText(level, unit.empty() ? "" : " " + unit) + "\n";
    return text;
}

}  // namespace isowave::tools
