#include "tools/view/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "base/cad_model.h"
#include "base/inflate.h"
#include "base/polygon_triangles.h"
#include "base/read_file.h"
#include "base/text.h"
#include "curves2d/file/pyramid_file.h"
#include "curves2d/polygon_input.h"
#include "io/mesh/equal_points.h"
#include "io/vector/svg.h"
#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "lod/open_mesh.h"
#include "lod/solid.h"
#include "lod/source.h"
#include "tools/view/level_facts.h"

namespace isowave::tools {
namespace {

namespace fs = std::filesystem;
using PagePointer = std::unique_ptr<view::Page>;

std::string extensionOf(const fs::path& path) { return toLower(path.extension().string()); }

bool isCurvePath(const fs::path& path) {
    return curves2d::looksLikePolygons(path) || extensionOf(path) == ".svg";
}

// The last part of a folder's name, "part" of "out/part/" too.
std::string nameOfFolder(const fs::path& folder) {
    const fs::path whole = fs::absolute(folder).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

// "L2" of "part_L2.ply" where the folder is "part"; else the file's own name.
std::string levelName(const fs::path& file, const std::string& folder) {
    const std::string stem = withoutGz(file).stem().string();
    const bool isOurs = stem.rfind(folder + "_", 0) == 0 && stem.size() > folder.size() + 1;
    return isOurs ? stem.substr(folder.size() + 1) : file.filename().string();
}

// ---- meshes

struct MeshFile {
    TriangleMesh mesh;
    Space space = Space::unspecified;
};

MeshFile readMeshFile(const fs::path& path, Console& console) {
    lod::LoadedMesh loaded = lod::loadMesh(path, console.progress());
    return {mergeEqualPoints(loaded.mesh), loaded.space};
}

PagePointer pageOfMeshes(const std::vector<fs::path>& files, const std::string& title, Console& console) {
    PagePointer page;
    for (const fs::path& file : files) {
        const MeshFile read = readMeshFile(file, console);
        const bool anatomical = read.space != Space::unspecified;
        if (!page)
            page = std::make_unique<view::Page>(
                view::PageOptions{.title = title, .unit = anatomical ? "mm" : "", .anatomical = anatomical});
        view::LevelFacts facts{.name = levelName(file, title), .file = file.filename().string()};
        putTopology(facts, topologyOf(read.mesh));
        page->add(facts, read.mesh, console.progress());
    }
    return page;
}

// ---- planar curves

view::Rings readRings(const fs::path& path, Console& console) {
    view::Rings rings;
    if (extensionOf(path) == ".svg") {
        const SvgLines drawing(readFile(path, "an SVG"), path.string());
        for (const Polyline& line : drawing.lines()) {
            rings.emplace_back();
            for (std::size_t i = 0; i < line.size(); ++i)
                rings.back().push_back({line.coordinates[2 * i], line.coordinates[2 * i + 1]});
        }
    } else {
        const curves2d::PolygonInput input = curves2d::readPolygons(path);
        for (const std::string& remark : input.remarks) console.say(path.string() + ": " + remark);
        for (const curves2d::Polygon& polygon : input.polygons)
            rings.insert(rings.end(), polygon.rings.begin(), polygon.rings.end());
    }
    if (rings.empty()) throw InputError(path.string(), "holds no line; expected closed curves");
    return rings;
}

PagePointer pageOfCurves(const std::vector<fs::path>& files, const std::string& title, Console& console) {
    auto page = std::make_unique<view::Page>(
        view::PageOptions{.title = title, .yUp = extensionOf(files.front()) != ".svg"});
    for (const fs::path& file : files) {
        const view::Rings rings = readRings(file, console);
        page->add({.name = levelName(file, title),
                   .file = file.filename().string(),
                   .rings = static_cast<std::int64_t>(rings.size())},
                  rings);
    }
    return page;
}

// ---- reports

Json readReport(const fs::path& path) {
    const std::string text = readFile(path, "a report");
    const Json report = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    const bool isOurs = report.is_object() && report.contains("version") && report.contains("input") &&
                        report["input"].is_object();
    if (!isOurs)
        throw InputError(path.string(),
                         "is no report of isowave lod or isowave curves; give the folder that they wrote");
    return report;
}

std::string textAt(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Entries of lists of the report that have a file, in order.
std::vector<Json> entriesOf(const Json& report, std::initializer_list<const char*> lists) {
    std::vector<Json> entries;
    for (const char* list : lists) {
        const auto found = report.find(list);
        if (found == report.end() || !found->is_array()) continue;
        for (const Json& entry : *found)
            if (entry.is_object() && !textAt(entry, "file").empty()) entries.push_back(entry);
    }
    return entries;
}

// A report names files of its own folder.
fs::path placeOf(const Json& entry, const fs::path& report) {
    const fs::path name = textAt(entry, "file");
    if (name.has_parent_path())
        throw InputError(report.string(), "'file' is " + name.string() + "; expected a name without folders");
    return report.parent_path() / name;
}

view::PageOptions optionsOf(const Json& report, const std::string& title) {
    const Json& input = report["input"];
    const std::string space = textAt(input, "space"), unit = textAt(input, "unit");
    const bool anatomical = space == "lps" || space == "ras";
    const Json& made = input.contains("source") && input["source"].is_object() ? input["source"] : input;
    const std::string kind = textAt(made, "kind");
    const bool isImage = kind == "mask" || kind == "labels" || kind == "grey image";
    view::PageOptions options{.title = title,
                              .unit = unit.empty() && (anatomical || isImage) ? "mm" : unit,
                              .anatomical = anatomical,
                              .yUp = textAt(input, "kind").rfind("image", 0) != 0};
    options.notes.push_back("Made from " + fs::path(textAt(input, "path")).filename().string() + ".");
    return options;
}

// Entries of budgets say components alone.
void putParts(view::LevelFacts& facts, const TriangleMesh& mesh) {
    const MeshTopology topology = topologyOf(mesh);
    if (!topology.closed() || !topology.manifold()) return;
    facts.parts = topology.parts;
    facts.cavities = topology.cavities;
}

PagePointer pageOfReport(const fs::path& path, Console& console) {
    const Json report = readReport(path);
    const bool planar = !report.contains("levels");
    const std::vector<Json> entries =
        planar ? entriesOf(report, {"steps"}) : entriesOf(report, {"levels", "budgets"});
    if (entries.empty()) throw InputError(path.string(), "names no file of a level; nothing to show");
    const std::string title = nameOfFolder(path.parent_path());
    view::PageOptions options = optionsOf(report, title);
    const bool toLevel0 = factsOf(entries.front(), "", false).step == 0;
    if (extensionOf(placeOf(entries.front(), path)) == ".svg") options.yUp = false;
    auto page = std::make_unique<view::Page>(std::move(options));
    for (const Json& entry : entries) {
        const fs::path file = placeOf(entry, path);
        view::LevelFacts facts = factsOf(entry, levelName(file, title), planar || toLevel0);
        facts.file = file.filename().string();
        if (planar) {
            page->add(facts, readRings(file, console));
            continue;
        }
        const TriangleMesh mesh = readMeshFile(file, console).mesh;
        if (!facts.parts) putParts(facts, mesh);
        page->add(facts, mesh, console.progress());
    }
    return page;
}

// ---- folders

// Where a file stands among its folder's: twice the number behind the last L or s of "part_L12.ply", and 1 more for the half
// step "coast_L12a.svg"; nothing for other names.
std::optional<long> numberOf(const fs::path& file) {
    std::string stem = withoutGz(file).stem().string();
    const bool isHalf = stem.ends_with('a');
    if (isHalf) stem.pop_back();
    const auto at = stem.find_last_not_of("0123456789");
    if (at == stem.npos || at + 1 == stem.size() || (stem[at] != 'L' && (isHalf || stem[at] != 's')))
        return std::nullopt;
    return 2 * std::stol(stem.substr(at + 1, 9)) + isHalf;
}

PagePointer pageOfFolder(const fs::path& folder, Console& console) {
    if (fs::exists(folder / "report.json")) return pageOfReport(folder / "report.json", console);
    std::vector<std::pair<long, fs::path>> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (const auto number = numberOf(entry.path());
            number && (isMeshPath(entry.path()) || isCurvePath(entry.path())))
            files.emplace_back(*number, entry.path());
    if (files.empty())
        throw InputError(folder.string(),
                         "holds neither report.json nor levels (name_L0.ply, name_L0.geojson, ...); give the "
                         "folder that isowave lod or isowave curves wrote");
    std::sort(files.begin(), files.end());
    std::vector<fs::path> paths;
    for (const auto& [number, path] : files) paths.push_back(path);
    return isMeshPath(paths.front()) ? pageOfMeshes(paths, nameOfFolder(folder), console)
                                     : pageOfCurves(paths, nameOfFolder(folder), console);
}

// ---- pyramids and subdivisions

// part.pyramid.vdb and part.iwz: part
std::string nameOfPyramid(const fs::path& path) {
    const fs::path stem = path.stem();
    return (stem.extension() == ".pyramid" ? stem.stem() : stem).string();
}

PagePointer pageOfPyramid(const fs::path& path, Console& console) {
    Solid solid = open(path, {}, console.progress());
    auto page = std::make_unique<view::Page>(pageOptionsOf(solid.input(), nameOfPyramid(path)));
    const auto add = [&](const LevelReport& level, const TriangleMesh& mesh) {
        page->add(factsOf(level, fmt::format("L{}", *level.level), true), mesh, console.progress());
    };
    makeLadder(std::move(solid), {}, {.level = add}, console.progress());
    return page;
}

TriangleMesh trianglesOfFaces(const subdivision::PolygonMesh& mesh) {
    TriangleMesh result;
    for (const Vec3& p : mesh.points) result.points.push_back({p.x, p.y, p.z});
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        std::vector<Point> polygon;
        for (const subdivision::Index v : face) polygon.push_back(result.points[v]);
        for (const auto& t : trianglesOf(polygon))
            result.triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
    }
    return result;
}

bool isDetailsFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    char start[8] = {};
    file.read(start, sizeof start);
    return std::string_view(start, sizeof start) == "isowmesh";
}

PagePointer pageOfDetails(const fs::path& path, Console& console) {
    const subdivision::Hierarchy hierarchy = subdivision::loadHierarchy(path);
    view::PageOptions options{.title = path.stem().string()};
    options.notes.push_back("Scheme " + hierarchy.scheme + ", " + hierarchy.variant + ".");
    auto page = std::make_unique<view::Page>(std::move(options));
    for (int steps = hierarchy.steps(); steps >= 0; --steps) {
        const subdivision::PolygonMesh mesh = subdivision::reconstruct(hierarchy, steps, console.progress());
        const TriangleMesh triangles = trianglesOfFaces(mesh);
        view::LevelFacts facts{.name = steps == 0 ? "base" : fmt::format("{}", steps),
                               .faces = static_cast<std::int64_t>(mesh.faceCount())};
        putTopology(facts, topologyOf(triangles));
        page->add(facts, triangles, console.progress());
    }
    return page;
}

// ---- which of them

PagePointer pageOfFile(const fs::path& path, Console& console) {
    if (isDetailsFile(path)) return pageOfDetails(path, console);
    const std::string extension = extensionOf(path);
    if ((extension == ".vdb" || extension == ".iwz") && lod::kindOf(path, {}) == lod::InputKind::pyramid)
        return pageOfPyramid(path, console);
    if (const auto text = cadModelText(path)) throw InputError(path.string(), *text);
    if (curves2d::isPyramidPath(path)) {
        const std::string folder = inShell((path.parent_path() / path.stem()).string());
        throw InputError(
            path.string(),
            fmt::format("is a pyramid of curves; write its levels first, then show them: isowave "
                        "curves {} -o {} && isowave view {}",
                        inShell(path.string()), folder, folder));
    }
    throw InputError(
        path.string(),
        "is nothing that view shows: a folder of isowave lod or curves, a pyramid, a packed solid, a mesh, "
        "curves "
        "(GeoJSON, SVG, text) or the details of isowave reverse; make levels of a scan or a level "
        "set with isowave lod first");
}

template <class Is>
void requireAll(const std::vector<fs::path>& inputs, const Is& is, const char* kind) {
    for (const fs::path& input : inputs)
        if (!is(input))
            throw UsageError(fmt::format(
                "view: {} is no {} file; several inputs are all meshes or all curves", input.string(), kind));
}

}  // namespace

view::PageOptions pageOptionsOf(const InputReport& input, const std::string& name) {
    const InputReport& source = input.madeFrom ? *input.madeFrom : input;
    const bool anatomical = source.space.value_or(Space::unspecified) != Space::unspecified;
    view::PageOptions options{.title = name, .unit = lod::unitOf(input), .anatomical = anatomical};
    options.notes.push_back("Made from " + fs::path(source.path).filename().string() + ".");
    return options;
}

std::unique_ptr<view::Page> pageOf(const std::vector<fs::path>& inputs, Console& console) {
    const fs::path& first = inputs.front();
    std::error_code error;
    if (!fs::exists(first, error))
        throw InputError(first.string(),
                         error ? "cannot be looked at (" + error.message() + ")" : "no such file or folder");
    const std::string title = withoutGz(first).stem().string();
    if (inputs.size() == 1 && fs::is_directory(first)) return pageOfFolder(first, console);
    if (isMeshPath(first)) {
        requireAll(
            inputs, [](const fs::path& path) { return isMeshPath(path); }, "mesh");
        return pageOfMeshes(inputs, title, console);
    }
    if (inputs.size() == 1 && extensionOf(first) == ".json") return pageOfReport(first, console);
    if (isCurvePath(first)) {
        requireAll(inputs, isCurvePath, "curve");
        return pageOfCurves(inputs, title, console);
    }
    if (inputs.size() > 1)
        requireAll(
            inputs, [](const fs::path& path) { return isMeshPath(path); }, "mesh");
    return pageOfFile(first, console);
}

}  // namespace isowave::tools
