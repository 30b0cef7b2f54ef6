#include "tools/input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "isowave/error.h"
#include "tools/repair_json.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"
#include "volume/vdb_file.h"
#include "wavelets/pyramid_file.h"

namespace isowave::tools {
namespace fs = std::filesystem;
namespace {

// Voxels along the longest axis of a mesh when nothing is said.
constexpr std::int64_t kDefaultVoxels = 256;

// What lod takes at its peak, beside the 60 MB that the program needs anyway; docs/volume.md has the runs.
// Distance fit, for each lattice point of the distances' band. Seen: 44 to 74 a control point, of which there are fewer,
// for TR12J at 400, 256 and 128 voxels.
constexpr double kBytesPerBandPoint = 80;
// Binary fit, for each node. Seen: 275 and 312 for bench/make_volume's 512^3 and 256^3.
constexpr double kBytesPerNode = 320;

constexpr double kDefaultMemoryShare = 0.7;

// ---- options that fit some kinds of input only ----

struct KindOption {
    const char* name;
    bool given;
    bool image, mesh, vdb;  // for which kinds it means something
};

void refuseForeignOptions(const fs::path& path, InputKind kind, const Settings& s) {
    const KindOption table[] = {
        {"--iso", s.iso.has_value(), true, false, true},
        {"--label", s.label.has_value(), true, false, false},
        {"--invert", s.invert, true, false, true},
        {"--open-border", s.openBorder, true, false, false},
        {"--voxels", s.voxels.has_value(), false, true, false},
        {"--voxel", s.voxel.has_value(), false, true, false},
        {"--fit", s.fit.has_value(), true, true, true},
        {"--half-width", s.halfWidth.has_value(), true, true, true},
        {"--band", s.band.has_value(), true, true, true},
        {"--size", s.size.has_value(), true, false, false},
        {"--type", s.type.has_value(), true, false, false},
        {"--spacing", s.spacing.has_value(), true, false, false},
        {"--endian", s.bigEndian.has_value(), true, false, false},
        {"--header-bytes", s.headerBytes.has_value(), true, false, false},
        {"--series", s.series.has_value(), true, false, false},
        {"--grid", s.grid.has_value(), false, false, true},
    };
    const char* what = kind == InputKind::image  ? "an image"
                       : kind == InputKind::mesh ? "a mesh"
                       : kind == InputKind::vdb  ? "a level set"
                                                 : "a pyramid, whose solid was fitted when it was made";
    for (const KindOption& option : table) {
        const bool fits = (kind == InputKind::image && option.image) ||
                          (kind == InputKind::mesh && option.mesh) || (kind == InputKind::vdb && option.vdb);
        if (option.given && !fits)
            throw UsageError(fmt::format("{} has no meaning for {}, which is {}; leave it out", option.name,
                                         path.string(), what));
    }
}

void checkFitOptions(const Settings& s) {
    const DistanceFitOptions defaults;
    const double halfWidth = s.halfWidth.value_or(defaults.halfWidth), band = s.band.value_or(defaults.band);
    if (band > halfWidth)
        throw UsageError(
            fmt::format("--band {} is wider than --half-width {}; the distance is known only within "
                        "the half-width",
                        band, halfWidth));
}

// ---- the fit, common to all kinds ----

// Sees to it that there is a surface, with a line that suits the kind of input.
void requireSurface(const BSplineField& field, const std::string& name, const std::string& remedy) {
    bool inside = false, outside = false;
    for (auto value = field.shape->cbeginValueOn(); value && !(inside && outside); ++value)
        (*value ? inside : outside) = true;
    if (!inside || !outside) throw InputError(name, "has no surface at this resolution: " + remedy);
}

// The signs of a grid of distances, for fitBinary.
NodeCollection nodesOfDistance(const openvdb::FloatGrid& distance) {
    auto inside = openvdb::BoolGrid::create(false);
    inside->setTransform(distance.transform().copy());
    auto& tree = inside->tree();
    for (auto value = distance.cbeginValueAll(); value; ++value) {
        if (*value >= 0) continue;
        if (value.isVoxelValue())
            tree.setValueOff(value.getCoord(), true);
        else
            tree.addTile(value.getLevel(), value.getCoord(), true, false);
    }
    return nodesFromSigns(*inside);
}

// Swaps inside and outside.
void negate(openvdb::FloatGrid& levelSet) {
    for (auto value = levelSet.beginValueAll(); value; ++value) value.setValue(-*value);
    // Background nodes that hold no tile of their own keep the old sign unless the root's background turns
    // too.
    levelSet.tree().root().setBackground(-levelSet.background(), /*updateChildNodes=*/false);
}

const char* nameOf(FitMethod method) { return method == FitMethod::binary ? "binary" : "distance"; }

struct Fitting {
    FitMethod method;
    DistanceFitOptions distance;
    BinaryFitOptions binary;
};

Fitting fittingOf(const Settings& settings, FitMethod fallback) {
    Fitting fitting;
    fitting.method = settings.fit.value_or(fallback);
    fitting.distance.halfWidth = settings.halfWidth.value_or(fitting.distance.halfWidth);
    fitting.distance.band = settings.band.value_or(fitting.distance.band);
    return fitting;
}

Json fitJson(const Fitting& fitting, const FitReport& report) {
    Json json;
    json["method"] = nameOf(fitting.method);
    if (fitting.method == FitMethod::distance) {
        json["half_width"] = fitting.distance.halfWidth;
        json["band"] = fitting.distance.band;
    } else {
        json["filter_passes"] = report.filterPasses;
    }
    addRepair(json, report);
    return json;
}

void refuseTooLarge(const std::string& name, double bytes, const Settings& settings, const char* remedy) {
    const double limit = memoryLimit(settings);
    if (bytes <= limit) return;
    throw InputError(
        name, fmt::format("would take about {} of memory, over the limit of {}; {}, or raise the limit "
                          "with --max-memory GB",
                          bytesText(bytes), bytesText(limit), remedy));
}

// nodes(), distance(): make what the method needs. allow(bytes): throws when the rest of the job may not take
// that.
template <class MakeNodes, class MakeDistance, class Allow>
void fit(Solid& solid, const Fitting& fitting, MakeNodes nodes, MakeDistance distance, Allow allow,
         Console& console, StageClock& clock) {
    FitReport report;
    if (fitting.method == FitMethod::binary) {
        const NodeCollection collection = [&] {
            const StageClock::Scope scope(clock, "nodes");
            return nodes();
        }();
        allow(kBytesPerNode * static_cast<double>(collection.nodeCount()));
        const StageClock::Scope scope(clock, "fit");
        solid.field = fitBinary(collection, fitting.binary, &report, console.progress());
    } else {
        const openvdb::FloatGrid::Ptr grid = [&] {
            const StageClock::Scope scope(clock, "distance");
            return distance();
        }();
        allow(kBytesPerBandPoint * static_cast<double>(grid->activeVoxelCount()));
        const StageClock::Scope scope(clock, "fit");
        solid.field = fitDistance(*grid, fitting.distance, &report, console.progress());
    }
    solid.fit = fitJson(fitting, report);
    if (report.disagreeing > 0)
        console.say(fmt::format("the sign of {} of {} lattice points differs from the input's",
                                grouped(report.disagreeing), grouped(report.latticePoints)));
}

// ---- images ----

// What an image shows, and what follows from it.
struct ImagePlan {
    const char* kind;  // "mask", "labels", "grey image"
    double iso = 0;
    FitMethod fit = FitMethod::distance;
};

// With as many digits as tell float32 values apart, so that --label takes what is shown.
std::string labelList(const std::vector<float>& values) { return fmt::format("{}", fmt::join(values, ", ")); }

bool looksLikeLabels(const Image& image, const ImageStatistics& statistics) {
    return image.integral && statistics.low >= 0 && !statistics.distinct.empty();
}

// Voxels are kept as float32. From 2^24 on it leaves whole numbers out, so labels of a wider type that were
// different may have become one there; only what was float32 in the file is still what it was.
constexpr double kExact = 1 << 24;

[[noreturn]] void refuseRoundedLabel(const std::string& name, double label) {
    throw InputError(name, fmt::format("label {:.17g} cannot be told from its neighbours: voxels are kept as "
                                       "float32, exact for labels below {:.0f}; renumber the labels",
                                       label, kExact));
}

// What a voxel with that label holds. A label is the value after scaling: slope k + intercept with a whole k, as
// float32 rounds it; so 0.3 finds the voxels that a slope of 0.1, itself a float32, has made of 3.
float voxelOfLabel(const Image& image, const std::string& name, double label) {
    if (image.componentType.starts_with("float")) {
        const bool kept =
            image.componentType == "float32" && static_cast<double>(static_cast<float>(label)) == label;
        if (std::abs(label) >= kExact && !kept) refuseRoundedLabel(name, label);
        return static_cast<float>(label);
    }
    const auto voxel = [&](double k) { return static_cast<float>(image.slope * k + image.intercept); };
    const double k = std::round((label - image.intercept) / image.slope);
    // A thousandth of a step: what is typed has a few digits. Anything else is the voxel's own float32, as `info`
    // shows it, or no label of this image.
    if (std::abs(image.slope * k + image.intercept - label) > 1e-3 * std::abs(image.slope))
        return static_cast<float>(label);
    if (std::abs(k) >= kExact || voxel(k - 1) == voxel(k) || voxel(k + 1) == voxel(k))
        refuseRoundedLabel(name, label);
    return voxel(k);
}

ImagePlan planForLabel(const ImageStatistics& statistics, const std::string& name, double label) {
    if (!statistics.found)
        throw InputError(name, statistics.distinct.empty()
                                   ? fmt::format("no voxel has the value {}; values run from {:g} to {:g}",
                                                 label, statistics.low, statistics.high)
                                   : fmt::format("no voxel has the label {}; labels found: {}", label,
                                                 labelList(statistics.distinct)));
    return {"labels", 0.5, FitMethod::binary};
}

ImagePlan planFor(const Image& image, const ImageStatistics& statistics, const std::string& name,
                  const Settings& settings, Console& console) {
    if (settings.label && settings.iso)
        throw UsageError("--label and --iso exclude each other; give one of them");
    if (settings.label) return planForLabel(statistics, name, *settings.label);
    if (statistics.low == statistics.high)
        throw InputError(name,
                         fmt::format("every voxel has the value {:g}; there is no surface", statistics.low));

    ImagePlan plan;
    if (statistics.distinct.size() == 2)
        plan = {"mask", (double{statistics.low} + statistics.high) / 2, FitMethod::binary};
    else if (looksLikeLabels(image, statistics) && !settings.iso)
        plan = {"labels", 0.5, FitMethod::binary};
    else if (!settings.iso)
        throw UsageError(
            fmt::format("{}: --iso is missing; values run from {}", name, rangeText(statistics)));
    else
        plan = {"grey image", 0, FitMethod::distance};

    if (settings.iso) {
        plan.iso = *settings.iso;
        const bool crosses = settings.invert ? statistics.low < plan.iso && plan.iso <= statistics.high
                                             : statistics.low <= plan.iso && plan.iso < statistics.high;
        if (!crosses)
            throw InputError(name,
                             fmt::format("no voxel lies on the other side of --iso {:g}; values run from {}",
                                         plan.iso, rangeText(statistics)));
    } else if (plan.kind == std::string_view("mask")) {
        console.say(fmt::format("{}: two values, {:g} and {:g}: a mask, iso {:g}", name, statistics.low,
                                statistics.high, plan.iso));
    } else if (statistics.low > 0) {
        throw InputError(
            name, fmt::format("a label image without a background (labels {}); choose one with --label",
                              labelList(statistics.distinct)));
    } else {
        console.say(
            fmt::format("{}: a label image (labels {}); the solid is everything but 0; --label chooses one",
                        name, labelList(statistics.distinct)));
    }
    return plan;
}

Json imageJson(const fs::path& path, const Image& image, const ImagePlan& plan,
               const ImageStatistics& statistics, const Settings& settings) {
    Json json;
    json["path"] = path.string();
    json["kind"] = plan.kind;
    json["format"] = image.format;
    json["component_type"] = image.componentType;
    json["dimensions"] = image.size;
    json["spacing"] = image.spacing();
    json["range"] = {finite(statistics.low), finite(statistics.high)};
    if (settings.label)
        json["label"] = *settings.label;
    else
        json["iso"] = plan.iso;
    json["inverted"] = settings.invert;
    json["open_border"] = settings.openBorder;
    json["origin"] = originOf(image);
    json["direction"] = directionOf(image);
    json["space"] = "lps";
    return json;
}

// The border that imageJson() describes, if it is an open one.
std::optional<Solid::Border> borderOf(const Json& input) {
    if (!input.value("open_border", false)) return std::nullopt;
    openvdb::math::Mat4d indexToWorld = openvdb::math::Mat4d::identity();
    openvdb::Vec3d high;
    for (int row = 0; row < 4; ++row)
        for (int axis = 0; axis < 3; ++axis)
            indexToWorld(row, axis) =
                row == 3 ? input["origin"][axis].get<double>()
                         : input["spacing"][row].get<double>() * input["direction"][row][axis].get<double>();
    for (int axis = 0; axis < 3; ++axis) high[axis] = input["dimensions"][axis].get<double>() - 1;
    return Solid::Border{indexToWorld.inverse(), openvdb::Vec3d(0), high};
}

Solid loadImageSolid(const fs::path& path, const Settings& settings, Console& console, StageClock& clock) {
    const std::string name = path.string();
    Solid solid;
    std::optional<ImageStream> stream;
    ImageStatistics statistics;
    std::optional<float> wanted;  // by --label
    {
        const StageClock::Scope scope(clock, "read");
        stream.emplace(path, imageReadOptions(settings));
        if (settings.label) wanted = voxelOfLabel(stream->header(), name, *settings.label);
        statistics = statisticsOf(*stream, wanted, console.progress());
        for (const std::string& warning : stream->header().warnings) console.say(warning);
    }
    const Image image = stream->header();
    const ImagePlan plan = planFor(image, statistics, name, settings, console);
    const Fitting fitting = fittingOf(settings, plan.fit);
    console.say(fmt::format("{}: {}x{}x{} voxels of {:.4g} x {:.4g} x {:.4g} mm, {}, {} fit", name,
                            image.size[0], image.size[1], image.size[2], image.spacing()[0],
                            image.spacing()[1], image.spacing()[2], plan.kind, nameOf(fitting.method)));

    const ImageSolid shape{
        .iso = plan.iso, .invert = settings.invert, .label = wanted, .openBorder = settings.openBorder};
    fit(
        solid, fitting,
        [&] {
            auto nodes = nodesFromImage(*stream, shape, console.progress());
            stream.reset();
            return nodes;
        },
        [&] {
            auto grid = distanceFromImage(*stream, shape, fitting.distance.halfWidth, console.progress());
            stream.reset();
            return grid;
        },
        [&](double bytes) { refuseTooLarge(name, bytes, settings, "crop or downsample it"); }, console,
        clock);
    solid.input = imageJson(path, image, plan, statistics, settings);
    solid.openBorder = borderOf(solid.input);
    solid.space = Space::lps;
    requireSurface(*solid.field, name, "the image holds nothing but inside or nothing but outside");
    return solid;
}

// ---- meshes ----

double voxelSizeFor(const TriangleMesh& mesh, const Settings& settings, const std::string& name,
                    Console& console) {
    if (settings.voxel && settings.voxels)
        throw UsageError("--voxel and --voxels exclude each other; give one of them");
    if (settings.voxel) return *settings.voxel;
    if (!settings.voxels)
        console.say(fmt::format("{}: --voxels {} along the longest axis", name, kDefaultVoxels));
    return voxelForCount(mesh, static_cast<double>(settings.voxels.value_or(kDefaultVoxels)));
}

std::array<double, 3> extentOf(const TriangleMesh& mesh) {
    std::array<double, 3> extent{};
    if (mesh.points.empty()) return extent;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] =
            std::minmax_element(mesh.points.begin(), mesh.points.end(),
                                [axis](const Point& a, const Point& b) { return a[axis] < b[axis]; });
        extent[axis] = (*high)[axis] - (*low)[axis];
    }
    return extent;
}

const char* nameOf(Space space) {
    return space == Space::lps ? "lps" : space == Space::ras ? "ras" : "unspecified";
}

Solid loadMeshSolid(const fs::path& path, const Settings& settings, Console& console, StageClock& clock) {
    const std::string name = path.string();
    Solid solid;
    LoadedMesh loaded;
    MeshRepairReport repair;
    {
        const StageClock::Scope scope(clock, "read");
        loaded = loadMesh(path, console.progress());
        loaded.mesh = repairMesh(std::move(loaded.mesh), name, &repair, {}, console.progress());
    }
    const TriangleMesh& mesh = loaded.mesh;
    for (const std::string& note : repair.notes) console.say(note);

    const Fitting fitting = fittingOf(settings, FitMethod::distance);
    constexpr const char* kRemedy = "give fewer --voxels or a larger --voxel";
    const double voxel = voxelSizeFor(mesh, settings, name, console);
    refuseTooLarge(name, kBytesPerBandPoint * estimateBandVoxels(mesh, voxel, fitting.distance.halfWidth),
                   settings, kRemedy);
    const auto transform = transformForMesh(mesh, voxel);
    Json dimensions = Json::array();
    for (const double extent : extentOf(mesh))
        dimensions.push_back(static_cast<std::int64_t>(std::ceil(extent / voxel)));
    console.say(fmt::format("{}: {}, {}x{}x{} voxels of {:.4g}, {} fit", name,
                            counted(static_cast<std::int64_t>(mesh.triangles.size()), "triangle"),
                            dimensions[0].get<std::int64_t>(), dimensions[1].get<std::int64_t>(),
                            dimensions[2].get<std::int64_t>(), voxel, nameOf(fitting.method)));

    const auto distance = [&] {
        return distanceFromMesh(mesh, *transform, fitting.distance.halfWidth, repair.evenOdd,
                                console.progress());
    };
    fit(
        solid, fitting, [&] { return nodesOfDistance(*distance()); }, distance,
        [&](double bytes) { refuseTooLarge(name, bytes, settings, kRemedy); }, console, clock);

    Json& json = solid.input;
    json["path"] = path.string();
    json["kind"] = "mesh";
    json["format"] = loaded.format;
    json["dimensions"] = dimensions;
    json["spacing"] = {voxel, voxel, voxel};
    json["triangles"] = repair.facesRead;
    json["repair"] = repair.notes;
    json["space"] = nameOf(loaded.space);
    solid.space = loaded.space;
    requireSurface(*solid.field, name,
                   "no lattice point lies inside the solid; give more --voxels or a smaller --voxel");
    return solid;
}

// ---- level sets ----

Solid loadLevelSetSolid(const fs::path& path, const Settings& settings, Console& console, StageClock& clock) {
    const std::string name = path.string();
    Solid solid;
    openvdb::FloatGrid::Ptr levelSet;
    {
        const StageClock::Scope scope(clock, "read");
        levelSet = readLevelSet(path, settings.grid);
    }
    if ((*levelSet)["isowave:K"])
        throw InputError(name,
                         "holds the control points of a field (isowave field), not a level set; give the "
                         "pyramid or the input that it was made from");
    const double iso = settings.iso.value_or(0.0);
    if ((levelSet->background() > iso) == settings.invert)
        throw InputError(
            name, fmt::format("everything far away would be inside (background {:g}, iso {:g}); a solid "
                              "must be finite; {}",
                              levelSet->background(), iso,
                              settings.invert ? "leave --invert out" : "give another --iso, or --invert"));
    if (settings.invert) negate(*levelSet);
    const Fitting fitting = fittingOf(settings, FitMethod::distance);
    const auto box = levelSet->evalActiveVoxelBoundingBox();
    const auto dim = box.empty() ? openvdb::Coord(0) : box.dim();
    const auto spacing = levelSet->transform().voxelSize();
    console.say(fmt::format("{}: level set '{}', iso {:g}, inside is {}, {} fit", name, levelSet->getName(),
                            iso, settings.invert ? "above" : "below", nameOf(fitting.method)));

    const auto distance = [&] {
        auto grid = distanceFromLevelSet(*levelSet, settings.invert ? -iso : iso, fitting.distance.halfWidth,
                                         console.progress());
        levelSet.reset();
        return grid;
    };
    Json& json = solid.input;
    json["path"] = path.string();
    json["kind"] = "level set";
    json["grid"] = levelSet->getName();
    json["dimensions"] = {dim.x(), dim.y(), dim.z()};
    json["spacing"] = triple(spacing);
    json["iso"] = iso;
    json["inverted"] = settings.invert;
    json["space"] = "unspecified";
    fit(
        solid, fitting, [&] { return nodesOfDistance(*distance()); }, distance,
        [&](double bytes) { refuseTooLarge(name, bytes, settings, "resample it to larger voxels"); }, console,
        clock);
    requireSurface(*solid.field, name,
                   fmt::format("no lattice point lies below {:g}, or none above it", iso));
    return solid;
}

// ---- pyramids ----

// "input.path" -> {"input": {"path": ...}}: what Solid::source() flattened. Values that are not JSON stay
// text.
Json unflattened(const std::map<std::string, std::string>& source) {
    Json json = Json::object();
    for (const auto& [key, text] : source) {
        Json value = Json::parse(text, nullptr, /*allow_exceptions=*/false);
        if (value.is_discarded()) value = text;
        const auto dot = key.find('.');
        if (dot == std::string::npos)
            json[key] = std::move(value);
        else
            json[key.substr(0, dot)][key.substr(dot + 1)] = std::move(value);
    }
    return json;
}

Solid loadPyramidSolid(const fs::path& path, int finestStep, StageClock& clock) {
    Solid solid;
    const StageClock::Scope scope(clock, "read");
    solid.pyramid = wavelets::readPyramid(path, finestStep);
    const Json source = unflattened(solid.pyramid->source);
    solid.input["path"] = path.string();
    solid.input["kind"] = "pyramid";
    if (source.contains("input")) {
        for (const char* key : {"dimensions", "spacing", "iso", "space"})
            if (source["input"].contains(key)) solid.input[key] = source["input"][key];
        solid.input["source"] = source["input"];
        solid.openBorder = borderOf(source["input"]);
    }
    solid.fit = source.contains("fit") ? source["fit"] : Json::object();
    const std::string space = solid.input.value("space", "unspecified");
    solid.space = space == "lps" ? Space::lps : space == "ras" ? Space::ras : Space::unspecified;
    return solid;
}

// memory.max of the root of the control groups that this process sees: a container's own limit inside one,
// and nothing outside, where the root has no limit.
std::optional<double> containerMemory() {
    std::ifstream file("/sys/fs/cgroup/memory.max");
    double bytes = 0;
    if (file >> bytes && bytes > 0) return bytes;
    return std::nullopt;
}

bool hasExtension(const fs::path& path, std::string_view extension) {
    std::string found = path.extension().string();
    std::transform(found.begin(), found.end(), found.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return found == extension;
}

}  // namespace

std::map<std::string, std::string> Solid::source() const {
    std::map<std::string, std::string> flat;
    const auto flatten = [&](const std::string& prefix, const Json& json) {
        for (const auto& [key, value] : json.items())
            flat[prefix + key] = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    };
    flatten("input.", input);
    flatten("fit.", fit);
    return flat;
}

InputKind kindOf(const fs::path& path, const Settings& settings) {
    std::error_code error;
    if (!fs::exists(path, error))
        throw InputError(path.string(),
                         error ? "cannot be looked at (" + error.message() + ")" : "no such file");
    if (settings.size) return InputKind::image;
    if (hasExtension(path, ".vdb"))
        return wavelets::isPyramidFile(path) ? InputKind::pyramid : InputKind::vdb;
    if (isMeshPath(path)) return InputKind::mesh;
    if (isImagePath(path)) return InputKind::image;
    if (hasExtension(path, ".gz")) throw InputError(path.string(), "is compressed by gzip; gunzip it first");
    throw InputError(path.string(),
                     "is neither an image, a mesh nor a .vdb by its name; a headerless image needs "
                     "--size, --type and --spacing");
}

Solid loadSolid(const fs::path& path, const Settings& settings, Console& console, StageClock& clock,
                int finestStep) {
    checkFitOptions(settings);
    const InputKind kind = kindOf(path, settings);
    refuseForeignOptions(path, kind, settings);
    switch (kind) {
        case InputKind::image:
            return loadImageSolid(path, settings, console, clock);
        case InputKind::mesh:
            return loadMeshSolid(path, settings, console, clock);
        case InputKind::vdb:
            return loadLevelSetSolid(path, settings, console, clock);
        case InputKind::pyramid:
            break;
    }
    return loadPyramidSolid(path, finestStep, clock);
}

LoadedMesh loadMesh(const fs::path& path, const Progress& progress) {
    MeshFileInfo info;
    LoadedMesh loaded;
    loaded.mesh = readMesh(path, &info, progress);
    loaded.format = info.format;
    if (info.space == "LPS") loaded.space = Space::lps;
    if (info.space == "RAS") {
        // Inside the program everything is LPS. Half a turn about z: orientation stays.
        loaded.space = Space::ras;
        for (Point& p : loaded.mesh.points) p[0] = -p[0], p[1] = -p[1];
        for (auto& n : loaded.mesh.normals) n[0] = -n[0], n[1] = -n[1];
    }
    return loaded;
}

Space outputSpace(const Solid& solid, const Settings& settings) {
    if (!settings.space) return solid.space;
    if (solid.space == Space::unspecified)
        throw UsageError(
            "--space: the axes of this input have no medical meaning (not an image, and no SPACE= in the "
            "mesh); leave it out");
    return *settings.space;
}

ImageReadOptions imageReadOptions(const Settings& settings) {
    ImageReadOptions options;
    options.spacing = settings.spacing;
    options.series = settings.series;
    options.memoryLimit = static_cast<std::int64_t>(memoryLimit(settings));
    if (settings.size) {
        if (!settings.type) throw UsageError("--size needs --type, the type of a voxel, such as int16");
        RawLayout raw;
        raw.size = *settings.size;
        raw.type = *settings.type;
        raw.bigEndian = settings.bigEndian.value_or(false);
        raw.headerBytes = settings.headerBytes.value_or(0);
        options.raw = raw;
    } else if (settings.type || settings.bigEndian || settings.headerBytes) {
        throw UsageError(
            "--type, --endian and --header-bytes describe a headerless image; give its --size too");
    }
    return options;
}

double memoryLimit(const Settings& settings) {
    if (settings.maxMemory) return *settings.maxMemory * 1e9;
    double memory =
        static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    if (const auto container = containerMemory()) memory = std::min(memory, *container);
    return kDefaultMemoryShare * memory;
}

Json originOf(const Image& image) {
    const auto row = image.indexToWorld.row(3);
    return {row[0], row[1], row[2]};
}

Json directionOf(const Image& image) {
    const auto spacing = image.spacing();
    Json rows = Json::array();
    for (int axis = 0; axis < 3; ++axis) {
        const auto row = image.indexToWorld.row(axis);
        rows.push_back({row[0] / spacing[axis], row[1] / spacing[axis], row[2] / spacing[axis]});
    }
    return rows;
}

std::string rangeText(const ImageStatistics& statistics) {
    std::string text = fmt::format("{:g} to {:g} (", statistics.low, statistics.high);
    for (const auto& [percent, value] : statistics.percentiles)
        text += fmt::format("{}{} % below {:g}", percent == statistics.percentiles.front().first ? "" : ", ",
                            percent, value);
    return text + ")";
}

}  // namespace isowave::tools
