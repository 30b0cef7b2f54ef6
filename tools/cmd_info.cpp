// isowave info FILE: what is in it.
#include <fmt/format.h>

#include <cmath>

#include "polygonize/topology.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/level_mesh.h"
#include "tools/steps.h"
#include "volume/vdb_file.h"
#include "wavelets/pyramid_file.h"

namespace isowave::tools {
namespace {
namespace fs = std::filesystem;

// A description in both forms.
struct Description {
    Json json;
    std::string text;
};

Json start(const fs::path& path, const char* kind) {
    Json json;
    json["version"] = 1;
    json["path"] = path.string();
    json["kind"] = kind;
    return json;
}

std::string triples(const Json& v) {
    const auto part = [](const Json& x) {
        return x.is_null() ? "-" : fmt::format("{:.6g}", x.get<double>());
    };
    return fmt::format("{} {} {}", part(v[0]), part(v[1]), part(v[2]));
}

// ---- images ----

Description describeImage(const fs::path& path, const Settings& settings, Console& console) {
    ImageStream stream(path, imageReadOptions(settings));
    const ImageStatistics statistics = statisticsOf(stream, {}, console.progress());
    const Image& image = stream.header();
    for (const std::string& warning : image.warnings) console.say(warning);

    Description d{start(path, "image"), {}};
    Json& json = d.json;
    json["format"] = image.format;
    json["component_type"] = image.componentType;
    json["dimensions"] = image.size;
    json["spacing"] = image.spacing();
    json["origin"] = originOf(image);
    json["direction"] = directionOf(image);
    json["range"] = {finite(statistics.low), finite(statistics.high)};
    for (const auto& [percent, value] : statistics.percentiles)
        json["percentiles"][std::to_string(percent)] = finite(value);
    json["distinct_values"] = statistics.distinct.empty() ? Json(nullptr) : Json(statistics.distinct);
    json["warnings"] = image.warnings;

    d.text = fmt::format("{}: {}, {}\n", path.string(), image.format, image.componentType);
    d.text += fmt::format("size       {} x {} x {} voxels\n", image.size[0], image.size[1], image.size[2]);
    d.text += fmt::format("spacing    {} mm\n", triples(json["spacing"]));
    d.text += fmt::format("origin     {} mm (LPS)\n", triples(json["origin"]));
    for (int axis = 0; axis < 3; ++axis)
        d.text += fmt::format("{} {} runs {}\n", axis == 0 ? "direction " : "          ", "xyz"[axis],
                              triples(json["direction"][axis]));
    d.text += fmt::format("values     {}\n", rangeText(statistics));
    if (!statistics.distinct.empty()) {
        d.text += fmt::format("distinct  ");
        for (const float value : statistics.distinct) d.text += fmt::format(" {}", value);  // as --label takes it
        d.text += "\n";
    }
    return d;
}

// ---- meshes ----

// How the file's axes are called; what it holds is shown in LPS, as it is read.
const char* spaceText(Space space) {
    return space == Space::lps ? " (LPS)" : space == Space::ras ? " (LPS; the file is RAS)" : "";
}

Description describeMesh(const fs::path& path, Console& console) {
    const LoadedMesh loaded = loadMesh(path, console.progress());
    const MeshTopology topology = topologyOf(mergeEqualPoints(loaded.mesh));
    Point low = loaded.mesh.points.front(), high = low;
    for (const Point& p : loaded.mesh.points)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }

    Description d{start(path, "mesh"), {}};
    d.json["format"] = loaded.format;
    d.json["space"] = loaded.space == Space::lps ? "lps" : loaded.space == Space::ras ? "ras" : "unspecified";
    putTopology(d.json, topology);
    d.json["boundary_edges"] = topology.boundaryEdges;
    d.json["bounds"] = {low, high};

    d.text =
        fmt::format("{}: {}, {}, {}\n", path.string(), loaded.format, counted(topology.triangles, "triangle"),
                    counted(topology.vertices, "vertex", "vertices"));
    d.text += fmt::format("from       {}{}\nto         {}\n", triples(Json(low)), spaceText(loaded.space),
                          triples(Json(high)));
    d.text += fmt::format("components {}, volume {}, area {}, {}\n", grouped(topology.components),
                          shortNumber(topology.volume), shortNumber(topology.area),
                          topology.closed() ? "closed" : grouped(topology.boundaryEdges) + " boundary edges");
    return d;
}

// ---- .vdb ----

Json metadataOf(const openvdb::MetaMap& map) {
    Json json = Json::object();
    for (auto entry = map.beginMeta(); entry != map.endMeta(); ++entry)
        json[entry->first] = entry->second ? entry->second->str() : std::string();
    return json;
}

Description describeVdb(const fs::path& path) {
    const VdbContent content = readVdb(path);
    Description d{start(path, "vdb"), {}};
    d.json["metadata"] = content.metadata ? metadataOf(*content.metadata) : Json::object();
    d.json["grids"] = Json::array();
    Table table({"grid", "type", "class", "active voxels", "box", "voxel"});
    for (const auto& grid : content.grids) {
        const auto box = grid->evalActiveVoxelBoundingBox();
        const auto dim = box.empty() ? openvdb::Coord(0) : box.dim();
        const auto spacing = grid->voxelSize();
        const std::string gridClass = openvdb::GridBase::gridClassToString(grid->getGridClass());
        d.json["grids"].push_back({{"name", grid->getName()},
                                   {"type", grid->valueType()},
                                   {"class", gridClass},
                                   {"active_voxels", grid->activeVoxelCount()},
                                   {"dimensions", {dim.x(), dim.y(), dim.z()}},
                                   {"spacing", triple(spacing)},
                                   {"metadata", metadataOf(*grid)}});
        table.row({grid->getName(), grid->valueType(), gridClass,
                   grouped(static_cast<std::int64_t>(grid->activeVoxelCount())),
                   fmt::format("{}x{}x{}", dim.x(), dim.y(), dim.z()),
                   fmt::format("{:.4g}x{:.4g}x{:.4g}", spacing.x(), spacing.y(), spacing.z())});
    }
    d.text = fmt::format("{}: {}\n", path.string(),
                         counted(static_cast<std::int64_t>(content.grids.size()), "grid")) +
             table.text();
    return d;
}

// ---- pyramids ----

// What each level's mesh bounds, coarser and coarser until nothing is left: keys that storyText() reads.
Json storiesOf(const wavelets::Pyramid& pyramid, const Settings& settings, Console& console) {
    StageClock clock;
    LevelMesher mesher(settings, std::nullopt, LevelMesher::Facts::few, console, clock);
    Json stories = Json::array();
    SolidCounts before;
    for (int step = 0; step <= pyramid.stepCount(); step += kStepsPerLevel) {
        const BSplineField field = pyramid.field(step, console.progress());
        const LevelMesh level = mesher.make(step, field);
        if (level.mesh.triangles.empty()) break;
        const SolidCounts now = countsOf(level.topology);
        if (step == 0) before = now;
        Json story{{"step", step},
                   {"level", step / kStepsPerLevel},
                   {"spacing", triple(field.transform().voxelSize())}};
        putTopology(story, level.topology);
        story.update(level.facts);
        story["change"] = changeJson(before, now);
        story["sampling"] = mesher.sampling(step, level, before);
        before = now;
        stories.push_back(std::move(story));
    }
    return stories;
}

Description describePyramid(const fs::path& path, const Settings& settings, Console& console) {
    const wavelets::Pyramid pyramid = wavelets::readPyramid(path);
    Description d{start(path, "pyramid"), {}};
    const std::int64_t stored = pyramid.coefficientsStored(), points = finestControlPoints(pyramid);
    d.json["format_version"] = wavelets::kPyramidFormatVersion;
    d.json["K"] = pyramid.K;
    d.json["source"] = pyramid.source;
    d.json["coefficients_stored"] = stored;
    d.json["control_points"] = points;
    const std::int64_t memory = bytesOf(pyramid), file = static_cast<std::int64_t>(fs::file_size(path));
    d.json["memory_bytes"] = memory;
    d.json["file_bytes"] = file;
    d.json["steps"] = Json::array();
    Table table({"step", "level", "halved", "voxel", "domain", "control points", "nodes", "details",
                 "coefficients", "leaves full"});
    for (const StepFacts& f : factsOf(pyramid)) {
        const bool whole = f.step % kStepsPerLevel == 0;
        const char axis = f.step == 0 ? '-' : "xyz"[pyramid.steps[f.step - 1].axis];
        d.json["steps"].push_back({{"step", f.step},
                                   {"level", whole ? Json(f.step / kStepsPerLevel) : Json(nullptr)},
                                   {"spacing", triple(f.spacing)},
                                   {"domain", {f.domain.x(), f.domain.y(), f.domain.z()}},
                                   {"control_points", f.controlPoints},
                                   {"nodes", f.definedNodes},
                                   {"details", f.details},
                                   {"coefficients", f.coefficients},
                                   {"leaf_occupancy", f.leafOccupancy}});
        table.row({std::to_string(f.step), whole ? std::to_string(f.step / kStepsPerLevel) : "",
                   std::string(1, axis),
                   fmt::format("{:.4g}x{:.4g}x{:.4g}", f.spacing.x(), f.spacing.y(), f.spacing.z()),
                   fmt::format("{}x{}x{}", f.domain.x(), f.domain.y(), f.domain.z()),
                   grouped(f.controlPoints), grouped(f.definedNodes), grouped(f.details),
                   grouped(f.coefficients), fmt::format("{:.0f} %", 100 * f.leafOccupancy)});
    }
    d.text = fmt::format("{}: pyramid of {} steps, K {:g}\n", path.string(), pyramid.stepCount(), pyramid.K);
    for (const auto& [key, value] : pyramid.source) d.text += fmt::format("{:<22}{}\n", key, value);
    d.text += table.text();
    const auto perPoint = [points](std::int64_t n) {
        return static_cast<double>(n) / static_cast<double>(points);
    };
    d.text += fmt::format("{} coefficients stored for {} control points (x{:.3f})\n", grouped(stored),
                          grouped(points), perPoint(stored));
    d.text += fmt::format("{} in memory ({:.1f} bytes a control point), {} on disk ({:.2f})\n",
                          bytesText(static_cast<double>(memory)), perPoint(memory),
                          bytesText(static_cast<double>(file)), perPoint(file));
    d.json["levels"] = storiesOf(pyramid, settings, console);
    const auto space = pyramid.source.find("input.space");  // as Solid::source() writes it
    const bool isMetric = space != pyramid.source.end() && space->second != "\"unspecified\"";
    for (const Json& level : d.json["levels"]) d.text += storyText(level, isMetric ? " mm" : "") + "\n";
    return d;
}

Description describe(const fs::path& path, const Settings& settings, Console& console) {
    switch (kindOf(path, settings)) {
        case InputKind::image:
            return describeImage(path, settings, console);
        case InputKind::mesh:
            return describeMesh(path, console);
        case InputKind::vdb:
            return describeVdb(path);
        case InputKind::pyramid:
            break;
    }
    return describePyramid(path, settings, console);
}

}  // namespace

int runInfo(const Settings& settings, Console& console) {
    const Description description = describe(settings.files[0], settings, console);
    console.progress().check();  // a stop that came while counting prints nothing either
    console.print(settings.json ? textOf(description.json) : description.text);
    return 0;
}

}  // namespace isowave::tools
