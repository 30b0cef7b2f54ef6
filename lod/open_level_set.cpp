#include "lod/open_level_set.h"

#include <fmt/format.h>

#include <array>

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

// Nodes are looked for in every block of 8 voxels of the box, one slab of 2 kB a block at a time, so a box that is nearly empty
// costs much for nothing. The surface of a box of n x n x n blocks has 6 n^2 leaves: a compact solid is far below both limits.
void requireCompact(const openvdb::FloatGrid& levelSet, const std::string& name) {
    const auto box = levelSet.evalActiveVoxelBoundingBox();
    if (box.empty()) return;
    std::array<double, 3> blocks{}, size{};
    for (int a = 0; a < 3; ++a) {
        size[a] = double(box.max()[a]) - double(box.min()[a]) + 1;
        blocks[a] = size[a] / 8 + 1;
    }
    const auto leaves = static_cast<double>(levelSet.constTree().leafCount());
    if (blocks[1] * blocks[2] <= 262144 + 16 * leaves &&
        blocks[0] * blocks[1] * blocks[2] <= 4194304 + 1000 * leaves)
        return;
    throw InputError(name,
                     fmt::format("its {} leaves lie in a box of {:.0f} x {:.0f} x {:.0f} voxels, which is "
                                 "nearly empty; is it damaged? crop it to the part wanted",
                                 levelSet.constTree().leafCount(), size[0], size[1], size[2]));
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
    requireCompact(*levelSet, name);
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
    fit(solid, fitting,
        {.nodes = [&] { return nodesOfDistance(*distance()); },
         .distance = distance,
         .fieldOnly = options.fieldOnly},
        memoryLimit(options.maxMemory), "resample it to larger voxels", progress, clock);
    requireSurface(*solid.field, name,
                   fmt::format("no lattice point lies below {:g}, or none above it", iso));
    return solid;
}

}  // namespace isowave::lod
