#include "lod/open_image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "io/image/view.h"
#include "isowave/error.h"
#include "lod/fit_solid.h"
#include "lod/memory.h"
#include "lod/slabs/slabbed_field.h"
#include "lod/source.h"
#include "volume/distance.h"
#include "volume/distance/crossing_band.h"

namespace isowave::lod {
namespace {

// What an image shows, and what follows from it.
struct ImagePlan {
    InputReport::Kind kind = InputReport::Kind::greyImage;
    double iso = 0;
    FitMethod fit = FitMethod::distance;
};

// With as many digits as tell float32 values apart, so that --label takes what is shown.
std::string labelList(const std::vector<float>& values) { return fmt::format("{}", fmt::join(values, ", ")); }

bool areWhole(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return v == std::floor(v); });
}

// Few values, none below 0, all of them whole: label images are stored as floating-point numbers too.
bool looksLikeLabels(const Image& image, const ImageStatistics& statistics) {
    return statistics.low >= 0 && !statistics.distinct.empty() &&
           (image.integral || areWhole(statistics.distinct));
}

// What else may be meant where no iso-value is given.
const char* labelAdvice(const Image& image, const ImageStatistics& statistics) {
    const bool whole = image.integral || (!statistics.distinct.empty() && areWhole(statistics.distinct));
    return whole ? "; if they are labels, choose one with --label" : "";
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

bool asksForLabels(const SolidOptions& options) { return options.label || !options.labels.empty(); }

void requireLabel(const ImageStatistics& statistics, const std::string& name, double label) {
    if (!statistics.found)
        throw InputError(name, statistics.distinct.empty()
                                   ? fmt::format("no voxel has the value {}; values run from {:g} to {:g}",
                                                 label, statistics.low, statistics.high)
                                   : fmt::format("no voxel has the label {}; labels found: {}", label,
                                                 labelList(statistics.distinct)));
}

ImagePlan planFor(const Image& image, const ImageStatistics& statistics, const std::string& name,
                  const SolidOptions& options, const Progress& progress) {
    if (asksForLabels(options)) return {InputReport::Kind::labels, 0.5, FitMethod::mask};
    if (statistics.low == statistics.high)
        throw InputError(name,
                         fmt::format("every voxel has the value {:g}; there is no surface", statistics.low));

    ImagePlan plan;
    if (statistics.distinct.size() == 2)
        plan = {InputReport::Kind::mask, (double{statistics.low} + statistics.high) / 2, FitMethod::mask};
    else if (looksLikeLabels(image, statistics) && !options.iso)
        plan = {InputReport::Kind::labels, 0.5, FitMethod::mask};
    else if (!options.iso)
        throw UsageError(fmt::format("{}: --iso is missing; values run from {}{}", name,
                                     rangeText(statistics), labelAdvice(image, statistics)));
    else
        plan = {InputReport::Kind::greyImage, 0, FitMethod::distance};

    if (options.iso) {
        plan.iso = *options.iso;
        const bool crosses = options.invert ? statistics.low < plan.iso && plan.iso <= statistics.high
                                            : statistics.low <= plan.iso && plan.iso < statistics.high;
        if (!crosses)
            throw InputError(name,
                             fmt::format("no voxel lies on the other side of --iso {:g}; values run from {}",
                                         plan.iso, rangeText(statistics)));
    } else if (plan.kind == InputReport::Kind::mask) {
        progress.say(fmt::format("{}: two values, {:g} and {:g}: a mask, iso {:g}", name, statistics.low,
                                 statistics.high, plan.iso));
    } else if (statistics.low > 0) {
        throw InputError(
            name, fmt::format("a label image without a background (labels {}); choose one with --label",
                              labelList(statistics.distinct)));
    } else {
        progress.say(
            fmt::format("{}: a label image (labels {}); the solid is everything but 0; --label chooses one",
                        name, labelList(statistics.distinct)));
    }
    return plan;
}

InputReport reportOf(const std::string& name, const Image& image, const ImagePlan& plan,
                     const ImageStatistics& statistics, const SolidOptions& options) {
    InputReport report;
    report.path = name;
    report.kind = plan.kind;
    report.format = image.format;
    report.componentType = image.componentType;
    report.dimensions = image.size;
    report.spacing = image.spacing();
    report.range = {statistics.low, statistics.high};
    report.label = options.label;
    report.labels = options.labels;
    if (!options.label && options.labels.empty()) report.iso = plan.iso;
    report.inverted = options.invert;
    report.openBorder = options.openBorder;
    report.origin = image.indexToWorld.origin;
    report.direction = directionOf(image);
    report.space = image.space;
    if (image.unit != "mm") report.unit = image.unit;
    return report;
}

// An image about to be read for the second time, and what the first time has told.
struct SeenImage {
    std::optional<ImageStream> stream;
    ImageStatistics statistics;
    std::optional<float> label;  // as a voxel has it
    std::vector<float> mask;     // of several labels: their voxels, and the stream is 1 there
};

// Each of several labels must be there. Leaves a stream that is 1 where one of them is, and which voxels these are; returns what it
// was before.
ImageStatistics takeLabels(ImageStream& stream, const std::string& name, const std::vector<double>& labels,
                           std::vector<float>& voxels, const Progress& progress) {
    ImageStatistics statistics;
    for (const double label : labels) {
        const float voxel = voxels.emplace_back(voxelOfLabel(stream.header(), name, label));
        if (voxels.size() == 1 || statistics.distinct.empty())
            statistics = statisticsOf(stream, voxel, progress);
        else
            statistics.found = std::find(statistics.distinct.begin(), statistics.distinct.end(), voxel) !=
                               statistics.distinct.end();
        requireLabel(statistics, name, label);
    }
    stream.takeAsMask(voxels);
    return statistics;
}

SeenImage looked(ImageStream stream, const std::string& name, const SolidOptions& options,
                 const Progress& progress) {
    if (asksForLabels(options) && options.iso)
        throw UsageError("--label and --iso exclude each other; give one of them");
    SeenImage seen;
    if (!options.labels.empty()) {
        seen.statistics = takeLabels(stream, name, options.labels, seen.mask, progress);
        seen.label = 1.0f;  // of the mask
    } else {
        if (options.label) seen.label = voxelOfLabel(stream.header(), name, *options.label);
        seen.statistics = statisticsOf(stream, seen.label, progress);
        if (options.label) requireLabel(seen.statistics, name, *options.label);
    }
    for (const std::string& warning : stream.header().warnings)
        progress.say(fmt::format("{}: {}", name, warning));
    seen.stream.emplace(std::move(stream));
    return seen;
}

ImageSolid shapeOf(const ImagePlan& plan, const SeenImage& seen, const SolidOptions& options) {
    return {.iso = plan.iso, .invert = options.invert, .label = seen.label, .openBorder = options.openBorder};
}

template <class T>
std::string textOf(const std::optional<T>& option) {
    return option ? fmt::format("{}", *option) : "-";
}

// Size and time of a file and all that chooses what is read of it, so that nobody goes on with slabs of what it was.
std::string stampOf(const std::string& name, const ImageReadOptions& options) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(name, error);
    if (error) return {};
    const auto size =
        std::filesystem::is_regular_file(name, error) ? std::filesystem::file_size(name, error) : 0;
    std::string raw = "-";
    if (const auto& layout = options.raw)
        raw = fmt::format("{} {} {} {}", fmt::join(layout->size, "x"), layout->type, layout->bigEndian,
                          layout->headerBytes);
    return fmt::format("{} {} {}; {} {} {} {} {} {} {} {}", name, size, time.time_since_epoch().count(), raw,
                       textOf(options.series), textOf(options.volume), textOf(options.nan),
                       textOf(options.stack), textOf(options.channel), textOf(options.time),
                       options.resampleSlices);
}

constexpr const char* kNoSurface = "the image holds nothing but inside or nothing but outside";

// Grey values do not say how much is inside.
void putVolume(Solid::State& solid, InputReport::Kind kind, double volume) {
    if (kind != InputReport::Kind::greyImage && !solid.openBorder) solid.input.volume = volume;
}

// A slab's fit must not depend on what lies far away.
void checkSlabs(const Fitting& fitting) {
    if (fitting.method == FitMethod::distance && fitting.distance.halfWidth > CrossingDistances::kReach)
        throw UsageError(
            fmt::format("--slabs: distances are known {} voxels far; take --half-width {} or less",
                        CrossingDistances::kReach, CrossingDistances::kReach));
}

double memoryOfSlab(const SolidOptions& options, double limit) {
    if (!options.slabMemory) return limit;
    if (*options.slabMemory <= kBytesOfWorker)
        throw UsageError(fmt::format("a slab may take {} of memory; the program alone takes {}",
                                     bytesText(*options.slabMemory), bytesText(kBytesOfWorker)));
    return *options.slabMemory - kBytesOfWorker;
}

void fitInSlabs(Solid::State& solid, SeenImage seen, const ImageSolid& shape, const Fitting& fitting,
                const SolidOptions& options, double limit, const Progress& progress, StageClock& clock) {
    checkSlabs(fitting);
    const StageClock::Scope scope(clock, "fit");
    const Image image = seen.stream->header();
    const SlabFitPlan plan{shape,
                           fitting,
                           SlabCuts::even(2, image.size[2], *options.slabs),
                           image.size[2],
                           image.indexToWorld,
                           memoryOfSlab(options, limit)};
    const auto allowWhole = [name = solid.name(), limit, fieldOnly = options.fieldOnly](std::int64_t points) {
        refuseTooLarge(name, bytesFor(fieldOnly, kBytesPerImageBandPoint * static_cast<double>(points)),
                       limit,
                       "levels need the whole: take a coarser one with isowave mesh --hold none, or crop it");
    };
    SlabWork work{options.slabFolder,
                  options.slabMap,
                  std::move(seen.mask),
                  solid.name(),
                  stampOf(solid.name(), options.image),
                  allowWhole};
    if (work.folder.empty()) work.folder = std::filesystem::temp_directory_path();
    solid.slabs = std::make_shared<SlabbedField>(std::move(*seen.stream), plan, work, progress);
    if (!solid.slabs->hasSurface()) refuseNoSurface(solid.name(), kNoSurface);
    solid.fit = summaryOf(fitting, solid.slabs->report());
    tellDisagreement(solid.slabs->report(), progress);
}

Solid::State fitted(SeenImage seen, const std::string& name, const SolidOptions& options,
                    const Progress& progress, StageClock& clock) {
    const Image image = seen.stream->header();
    const ImagePlan plan = planFor(image, seen.statistics, name, options, progress);
    const Fitting fitting = fittingOf(options, plan.fit);
    const auto spacing = image.spacing();
    progress.say(fmt::format("{}: {}x{}x{} voxels of {:.4g} x {:.4g} x {:.4g} {}, {}, {} fit", name,
                             image.size[0], image.size[1], image.size[2], spacing[0], spacing[1], spacing[2],
                             image.unit, nameOf(plan.kind), nameOf(fitting.method)));

    Solid::State solid;
    solid.input = reportOf(name, image, plan, seen.statistics, options);
    solid.openBorder = borderOf(solid.input);
    solid.space = image.space;
    const ImageSolid shape = shapeOf(plan, seen, options);
    const auto nodes = [&] {
        NodeCollection result = nodesFromImage(*seen.stream, shape, progress);
        seen.stream.reset();
        return result;
    };
    const double limit = memoryLimit(options.maxMemory);
    if (options.slabs) {
        fitInSlabs(solid, std::move(seen), shape, fitting, options, limit, progress, clock);
        putVolume(solid, plan.kind, double(solid.slabs->inside()) * volumeOfVoxel(solid.slabs->transform()));
        return solid;
    }
    const std::string remedy = "crop or downsample it, or take it in slabs (--slabs)";
    const auto allow = [&](std::int64_t points) {  // voxels that had to be decoded are still there
        const double bytes = kBytesPerLeafPoint * static_cast<double>(points);
        refuseTooLarge(name, bytes + static_cast<double>(seen.stream->bytesKept()), limit, remedy);
    };
    const auto distance = [&] {
        auto grid = distanceFromImage(*seen.stream, shape, fitting.distance.halfWidth, progress, allow);
        seen.stream.reset();
        return grid;
    };
    fit(solid, fitting, {nodes, distance, {}, kBytesPerImageBandPoint, options.fieldOnly}, limit, remedy,
        progress, clock);
    putVolume(solid, plan.kind, volumeInside(*solid.field->shape));
    requireSurface(*solid.field, name, kNoSurface);
    return solid;
}

}  // namespace

std::vector<double> labelsIn(const std::filesystem::path& path, const SolidOptions& options,
                             const Progress& progress) {
    ImageStream stream(path, imageReadOptions(options));
    const ImageStatistics statistics = statisticsOf(stream, std::nullopt, progress);
    if (!looksLikeLabels(stream.header(), statistics))
        throw InputError(
            path.string(),
            fmt::format(
                "is no label image, with at most {} values, all of them whole and none below 0; values "
                "run from {}",
                ImageStatistics::kMostDistinct, rangeText(statistics)));
    std::vector<double> labels;
    for (const float value : statistics.distinct)
        if (value != 0) labels.push_back(value);
    if (labels.empty()) throw InputError(path.string(), "all of its voxels are 0; there is no label");
    return labels;
}

Solid::State openImage(const std::filesystem::path& path, const SolidOptions& options,
                       const Progress& progress, StageClock& clock) {
    const std::string name = path.string();
    SeenImage seen = [&] {
        const StageClock::Scope scope(clock, "read");
        return looked(ImageStream(path, imageReadOptions(options)), name, options, progress);
    }();
    return fitted(std::move(seen), name, options, progress, clock);
}

Solid::State openImage(const Image& image, const SolidOptions& options, const Progress& progress,
                       StageClock& clock) {
    SeenImage seen = [&] {
        const StageClock::Scope scope(clock, "read");
        return looked(ImageStream(image), "image", options, progress);
    }();
    return fitted(std::move(seen), "image", options, progress, clock);
}

ImagePlanned planImage(const std::filesystem::path& path, const SolidOptions& options,
                       const Progress& progress) {
    const std::string name = path.string();
    SeenImage seen = looked(ImageStream(path, imageReadOptions(options)), name, options, progress);
    const ImagePlan plan = planFor(seen.stream->header(), seen.statistics, name, options, progress);
    const ImageSolid shape = shapeOf(plan, seen, options);
    return {std::move(*seen.stream), shape, plan.kind, plan.fit};
}

Solid::State openImage(const VoxelView& voxels, const SolidOptions& options, const Progress& progress,
                       StageClock& clock) {
    SeenImage seen = [&] {
        const StageClock::Scope scope(clock, "read");
        return looked(ImageStream(voxels, options.image), imageio::kViewName, options, progress);
    }();
    return fitted(std::move(seen), imageio::kViewName, options, progress, clock);
}

ImageReadOptions imageReadOptions(const SolidOptions& options) {
    ImageReadOptions result = options.image;
    result.memoryLimit = static_cast<std::int64_t>(memoryLimit(options.maxMemory));
    if (!result.raw) return result;
    if (result.raw->size == std::array<std::int64_t, 3>{})
        throw UsageError(
            "--type, --endian and --header-bytes describe a headerless image; give its --size too");
    if (result.raw->type.empty()) throw UsageError("--size needs --type, the type of a voxel, such as int16");
    return result;
}

std::array<std::array<double, 3>, 3> directionOf(const Image& image) {
    const auto spacing = image.spacing();
    std::array<std::array<double, 3>, 3> rows = image.indexToWorld.axis;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (double& x : rows[axis]) x /= spacing[axis];
    return rows;
}

std::string rangeText(const ImageStatistics& statistics) {
    std::string text = fmt::format("{:g} to {:g} (", statistics.low, statistics.high);
    for (const auto& [percent, value] : statistics.percentiles)
        text += fmt::format("{}{} % below {:g}", percent == statistics.percentiles.front().first ? "" : ", ",
                            percent, value);
    return text + ")";
}

}  // namespace isowave::lod

namespace isowave {

std::string runSlabTask(const std::filesystem::path& image, const SolidOptions& options,
                        const std::string& task, const Progress& progress) {
    return lod::runSlabTask(image, lod::imageReadOptions(options), task, progress);
}

}  // namespace isowave
