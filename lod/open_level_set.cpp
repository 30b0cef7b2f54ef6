#include "lod/open_level_set.h"

#include <fmt/format.h>

#include "isowave/error.h"
#include "lod/fit_solid.h"
#include "lod/memory.h"
#include "volume/distance.h"
#include "volume/vdb_file.h"

namespace isowave::lod {
namespace {

// Swaps inside and outside.
void negate(openvdb::FloatGrid& levelSet) {
    for (auto value = levelSet.beginValueAll(); value; ++value) value.setValue(-*value);
    // Background nodes that hold no tile of their own keep the old sign unless the root's background turns
    // too.
    levelSet.tree().root().setBackground(-levelSet.background(), /*updateChildNodes=*/false);
}

void requireFinite(const openvdb::FloatGrid& levelSet, const std::string& name, double iso, bool invert) {
    if (levelSet["isowave:K"])
        throw InputError(name,
                         "holds the control points of a field (isowave field), not a level set; give the "
                         "pyramid or the input that it was made from");
    if ((levelSet.background() > iso) == invert)
        throw InputError(
            name, fmt::format("everything far away would be inside (background {:g}, iso {:g}); a solid "
                              "must be finite; {}",
                              levelSet.background(), iso,
                              invert ? "leave --invert out" : "give another --iso, or --invert"));
}

InputReport reportOf(const openvdb::FloatGrid& levelSet, const std::string& name, double iso, bool inverted) {
    InputReport report;
    const auto box = levelSet.evalActiveVoxelBoundingBox();
    const auto dim = box.empty() ? openvdb::Coord(0) : box.dim();
    const auto spacing = levelSet.transform().voxelSize();
    report.path = name;
    report.kind = InputReport::Kind::levelSet;
    report.grid = levelSet.getName();
    report.dimensions = {dim.x(), dim.y(), dim.z()};
    report.spacing = {spacing.x(), spacing.y(), spacing.z()};
    report.iso = iso;
    report.inverted = inverted;
    report.space = Space::unspecified;
    return report;
}

}  // namespace

Solid::State openLevelSet(const std::filesystem::path& path, const SolidOptions& options,
                          const Progress& progress, StageClock& clock) {
    openvdb::FloatGrid::Ptr levelSet = [&] {
        const StageClock::Scope scope(clock, "read");
        return readLevelSet(path, options.grid);
    }();
    return openLevelSet(std::move(levelSet), path.string(), options, progress, clock);
}

Solid::State openLevelSet(openvdb::FloatGrid::Ptr levelSet, const std::string& name,
                          const SolidOptions& options, const Progress& progress, StageClock& clock) {
    const double iso = options.iso.value_or(0.0);
    requireFinite(*levelSet, name, iso, options.invert);
    if (options.invert) negate(*levelSet);
    const Fitting fitting = fittingOf(options, FitMethod::distance);
    progress.say(fmt::format("{}: level set '{}', iso {:g}, inside is {}, {} fit", name, levelSet->getName(),
                             iso, options.invert ? "above" : "below", nameOf(fitting.method)));

    Solid::State solid;
    solid.input = reportOf(*levelSet, name, iso, options.invert);
    const auto distance = [&] {
        auto grid = distanceFromLevelSet(*levelSet, options.invert ? -iso : iso, fitting.distance.halfWidth,
                                         progress);
        levelSet.reset();
        return grid;
    };
    fit(solid, fitting, {[&] { return nodesOfDistance(*distance()); }, distance},
        memoryLimit(options.maxMemory), "resample it to larger voxels", progress, clock);
    requireSurface(*solid.field, name,
                   fmt::format("no lattice point lies below {:g}, or none above it", iso));
    return solid;
}

}  // namespace isowave::lod
