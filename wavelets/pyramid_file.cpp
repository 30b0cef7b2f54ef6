#include "wavelets/pyramid_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "isowave/error.h"
#include "volume/grid_bytes.h"
#include "volume/vdb_file.h"
#include "wavelets/step_order.h"

namespace isowave::wavelets {
namespace {

constexpr const char* kFormat = "isowave:format";
constexpr const char* kVersion = "isowave:version";
constexpr const char* kK = "isowave:K";
constexpr const char* kAxes = "isowave:axes";
constexpr const char* kFirstLevels = "isowave:first_levels";
const std::string kSource = "isowave:source:";
constexpr const char* kPyramid = "pyramid";
constexpr const char* kControlPoints = "control_points";
constexpr const char* kShape = "shape";
constexpr const char* kExact = "exact_000";

std::string shapeName(std::size_t step) { return fmt::format("shape_{:03}", step); }
std::string detailsName(std::size_t step) { return fmt::format("details_{:03}", step); }

template <class Grid>
openvdb::GridBase::ConstPtr named(const typename Grid::ConstPtr& grid, const std::string& name) {
    auto copy = grid->copy();  // shares the tree
    auto mutableCopy = openvdb::ConstPtrCast<Grid>(copy);
    mutableCopy->setName(name);
    return mutableCopy;
}

// The parts of a file, by name.
class Parts {
  public:
    // Reads the parts of these names.
    Parts(std::string file, VdbParts& parts, const std::vector<std::string>& names) : file_(std::move(file)) {
        const auto grids = parts.read(names);
        for (std::size_t i = 0; i < names.size(); ++i) parts_[names[i]] = grids[i];
    }

    bool has(const std::string& name) const { return parts_.at(name) != nullptr; }

    template <class Grid>
    typename Grid::Ptr take(const std::string& name) {
        const auto part = std::exchange(parts_.at(name), nullptr);
        if (!part)
            throw InputError(file_,
                             fmt::format("the pyramid's part '{}' is missing; the file is damaged", name));
        auto grid = openvdb::gridPtrCast<Grid>(part);
        if (!grid)
            throw InputError(file_, fmt::format("the pyramid's part '{}' is a {} grid, expected {}", name,
                                                part->type(), Grid::gridType()));
        return grid;
    }

  private:
    std::string file_;
    std::map<std::string, openvdb::GridBase::Ptr> parts_;
};

template <class T>
T metaValue(const std::string& file, const openvdb::MetaMap& map, const char* name) {
    const auto meta = map.getMetadata<openvdb::TypedMetadata<T>>(name);
    if (!meta)
        throw InputError(file,
                         fmt::format("the pyramid's metadatum '{}' is missing or of another type", name));
    return meta->value();
}

void checkFormat(const std::string& file, const openvdb::MetaMap& meta) {
    const auto format = meta.getMetadata<openvdb::StringMetadata>(kFormat);
    if (!format || format->value() != kPyramid)
        throw InputError(
            file, "is a .vdb but not a pyramid; make one with: isowave analyse INPUT -o OUT.pyramid.vdb");
    const int version = metaValue<openvdb::Int32>(file, meta, kVersion);
    if (version != kPyramidFormatVersion)
        throw InputError(
            file, fmt::format("is a pyramid of format version {}, expected {}; write it again with this "
                              "version of isowave, or read it with the one that wrote it",
                              version, kPyramidFormatVersion));
}

}  // namespace

void writePyramid(const std::filesystem::path& path, const Pyramid& pyramid, const StepSource& missing) {
    openvdb::MetaMap meta;
    meta.insertMeta(kFormat, openvdb::StringMetadata(kPyramid));
    meta.insertMeta(kVersion, openvdb::Int32Metadata(kPyramidFormatVersion));
    meta.insertMeta(kK, openvdb::DoubleMetadata(pyramid.K));
    std::string axes;
    for (const Step& step : pyramid.steps) axes += "xyz"[step.axis];
    meta.insertMeta(kAxes, openvdb::StringMetadata(axes));
    if (!pyramid.order.first.empty())
        meta.insertMeta(kFirstLevels, openvdb::StringMetadata(textOf(pyramid.order)));
    for (const auto& [key, value] : pyramid.source)
        meta.insertMeta(kSource + key, openvdb::StringMetadata(value));

    openvdb::GridCPtrVec grids;
    grids.push_back(named<openvdb::FloatGrid>(pyramid.coarsest.controlPoints, kControlPoints));
    grids.push_back(named<Shape>(pyramid.coarsest.shape, kShape));
    for (std::size_t s = 0; s < pyramid.steps.size(); ++s) {
        const Step& step = pyramid.steps[s];
        const int number = static_cast<int>(s);
        grids.push_back(step.shape ? named<Shape>(step.shape, shapeName(s))
                                   : madeWhenWritten<Shape>(
                                         shapeName(s), [&missing, number] { return missing.shape(number); }));
        grids.push_back(step.details ? named<DetailGrid>(step.details, detailsName(s))
                                     : madeWhenWritten<DetailGrid>(detailsName(s), [&missing, number] {
                                           return missing.details(number);
                                       }));
    }
    if (pyramid.exact) grids.push_back(named<openvdb::FloatGrid>(pyramid.exact, kExact));
    writeVdb(path, grids, meta);
}

namespace {

// A file without it has levels of all three axes, in whatever order.
void readOrder(const std::string& file, const openvdb::MetaMap& metadata, Pyramid& pyramid) {
    if (!metadata[kFirstLevels]) return;
    const auto text = metaValue<std::string>(file, metadata, kFirstLevels);
    const std::optional<StepOrder> order = orderOf(text);
    if (!order)
        throw InputError(
            file,
            fmt::format("the first levels are '{}', expected axes such as 'xy xy', at most {} levels of them",
                        text, kMostHalvings));
    for (int step = 0; step < pyramid.stepCount(); ++step)
        if (const int axis = pyramid.steps[static_cast<std::size_t>(step)].axis;
            axis != order->axisAfter(step))
            throw InputError(file,
                             fmt::format("step {} halves {}, and {} by the first levels '{}'; the file is "
                                         "damaged",
                                         step + 1, "xyz"[axis], "xyz"[order->axisAfter(step)], text));
    pyramid.order = *order;
}

// Everything but the grids. Steps have their axis only.
Pyramid readHead(const std::string& file, const openvdb::MetaMap& metadata) {
    checkFormat(file, metadata);
    Pyramid pyramid;
    pyramid.K = metaValue<double>(file, metadata, kK);
    if (!(pyramid.K > 0 && std::isfinite(pyramid.K)))
        throw InputError(file, fmt::format("K is {}, expected a positive number", pyramid.K));
    for (const char axis : metaValue<std::string>(file, metadata, kAxes)) {
        if (axis < 'x' || axis > 'z')
            throw InputError(
                file, fmt::format("axis '{}' of step {}, expected x, y or z", axis, pyramid.stepCount()));
        pyramid.steps.push_back({axis - 'x', nullptr, nullptr});
    }
    readOrder(file, metadata, pyramid);
    for (auto meta = metadata.beginMeta(); meta != metadata.endMeta(); ++meta)
        if (meta->first.starts_with(kSource))
            pyramid.source[meta->first.substr(kSource.size())] = meta->second->str();
    return pyramid;
}

}  // namespace

StepOrder readOrder(const std::filesystem::path& path) {
    return readHead(path.string(), VdbParts(path).metadata()).order;
}

Pyramid readPyramid(const std::filesystem::path& path, int finestStep, std::int64_t* bytesRead) {
    const std::string file = path.string();
    VdbParts all(path);
    Pyramid pyramid = readHead(file, all.metadata());
    const auto first = static_cast<std::size_t>(finestStep);
    std::vector<std::string> names{kControlPoints, kShape};
    for (std::size_t s = first; s < pyramid.steps.size(); ++s) {
        names.push_back(shapeName(s));
        names.push_back(detailsName(s));
    }
    if (finestStep == 0) names.emplace_back(kExact);
    Parts parts(file, all, names);
    pyramid.coarsest.K = pyramid.K;
    pyramid.coarsest.controlPoints = parts.take<openvdb::FloatGrid>(kControlPoints);
    pyramid.coarsest.shape = parts.take<Shape>(kShape);
    if (!pyramid.coarsest.shape->tree().hasSameTopology(pyramid.coarsest.controlPoints->tree()))
        throw InputError(file,
                         "the pyramid's parts 'control_points' and 'shape' differ; the file is damaged");
    for (std::size_t s = first; s < pyramid.steps.size(); ++s) {
        pyramid.steps[s].shape = parts.take<Shape>(shapeName(s));
        pyramid.steps[s].details = parts.take<DetailGrid>(detailsName(s));
    }
    if (finestStep == 0 && parts.has(kExact)) pyramid.exact = parts.take<openvdb::FloatGrid>(kExact);
    if (bytesRead) *bytesRead = all.bytesRead();
    return pyramid;
}

bool isPyramidFile(const std::filesystem::path& path) {
    if (!std::filesystem::is_regular_file(path)) return false;
    try {
        return vdbStringMetadatum(FileBytes(path, "a .vdb file"), kFormat) == kPyramid;
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace isowave::wavelets
