#include "lod/dry_run/dry_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hold/hold.h"
#include "isowave/error.h"
#include "lod/dry_run/wall_thickness.h"
#include "lod/fit_solid.h"
#include "lod/memory.h"
#include "lod/open_image.h"
#include "lod/open_level_set.h"
#include "lod/open_mesh.h"
#include "lod/solid.h"
#include "lod/steps.h"
#include "volume/distance_mesh.h"
#include "volume/vdb_file.h"

namespace isowave::lod {
namespace {

constexpr double kBytesOfProgram = 60e6;  // lod/memory.h
const std::vector<double> kShares{0.01, 0.05, 0.5};

// Control points along an axis, c -> (c + 3)/2 from one halving to the next, until the 4 of one node are left on all axes.
int lastLevelOf(const std::array<std::int64_t, 3>& voxels, double band, const StepOrder& order) {
    std::array<double, 3> points{};
    for (std::size_t a = 0; a < 3; ++a) points[a] = static_cast<double>(voxels[a]) + 2 * band + 1;
    int step = 0;
    for (; *std::max_element(points.begin(), points.end()) > 4; ++step) {
        double& along = points[static_cast<std::size_t>(order.axisAfter(step))];
        along = std::max(4.0, (along + 3) / 2);
    }
    const int level = order.levelUpTo(step);
    return order.stepOf(level) < step ? level + 1 : level;
}

// thickness: of kShares, in voxels; empty: nothing is known.
void putWalls(DryRun& run, const std::vector<double>& thickness) {
    for (std::size_t i = 0; i < thickness.size(); ++i) {
        DryRun::Wall wall{kShares[i], thickness[i], {}};
        const double widest = LevelHold::widestVoxelFor(thickness[i]);
        if (widest >= 1) wall.heldUpTo = run.order.levelOfVoxel(widest);
        run.walls.push_back(wall);
    }
}

DryRun begun(InputReport::Kind kind, const SolidOptions& options, FitMethod usual) {
    DryRun run;
    run.kind = kind;
    run.fit = options.fit.value_or(usual);
    run.memoryLimit = memoryLimit(options.maxMemory);
    run.fieldOnly = options.fieldOnly;
    return run;
}

DryRun ofMesh(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress) {
    const MeshPlan plan = planMesh(path, options, progress);
    DryRun run = begun(InputReport::Kind::mesh, options, FitMethod::distance);
    run.voxels = *plan.input.dimensions;
    run.spacing = *plan.input.spacing;
    run.memoryBytes = kBytesOfProgram + bytesFor(options.fieldOnly, kBytesPerBandPoint * plan.bandPoints);
    run.lastLevel = lastLevelOf(run.voxels, fittingOf(options, run.fit).distance.band, run.order);
    std::vector<double> walls;
    if (options.thicken)
        walls.assign(kShares.size(), *options.thicken);
    else
        walls = thinnestWalls(plan.mesh, kShares, progress);
    for (double& wall : walls) wall /= run.spacing[0];
    putWalls(run, walls);
    return run;
}

InsideVoxels insideOf(ImageStream& stream, const ImageSolid& shape, const Progress& progress) {
    InsideVoxels voxels;
    voxels.size = stream.header().size;
    voxels.inside.resize(static_cast<std::size_t>(stream.header().voxelCount()));
    const InsideTest isInside(shape);
    const std::int64_t slice = voxels.size[0] * voxels.size[1];
    stream.pass("reading", progress, [&](const Slab& slab) {
        std::visit(
            [&](auto values) {
                std::transform(values.begin(), values.end(), voxels.inside.begin() + slab.z0 * slice,
                               [&](auto v) { return isInside(static_cast<float>(v)); });
            },
            slab.voxels);
    });
    return voxels;
}

// Two thirds of the voxels' faces are about the surface's area: a plane across an axis has as many as its area, one across a
// diagonal sqrt(3) times as many, the mean over all directions is 3/2.
DryRun ofImage(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress) {
    ImagePlanned plan = planImage(path, options, progress);
    DryRun run = begun(plan.kind, options, plan.fit);
    run.voxels = plan.stream.header().size;
    run.spacing = plan.stream.header().spacing();
    run.order = orderFor(run.spacing, options, path.string(), progress);
    const VoxelFacts facts = factsOf(insideOf(plan.stream, plan.shape, progress), kShares, progress);
    const Fitting fitting = fittingOf(options, plan.fit);
    const double band = static_cast<double>(facts.faces) * 2 / 3 * 2 * fitting.distance.halfWidth;
    const double most =
        run.fit == FitMethod::distance ? kBytesPerBandPoint * band : kBytesPerNode * double(facts.cells);
    run.memoryBytes = kBytesOfProgram + bytesFor(options.fieldOnly, most);
    std::array<std::int64_t, 3> box{};
    for (int a = 0; a < 3; ++a) box[a] = std::max<std::int64_t>(1, facts.high[a] - facts.low[a] + 1);
    run.lastLevel = lastLevelOf(box, fitting.distance.band, run.order);
    run.wallsAreBounds = true;
    putWalls(run, facts.walls);
    return run;
}

DryRun ofLevelSet(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress) {
    const openvdb::FloatGrid::Ptr grid = readLevelSet(path, options.grid);
    DryRun run = begun(InputReport::Kind::levelSet, options, FitMethod::distance);
    const auto box = grid->evalActiveVoxelBoundingBox();
    const auto dim = box.empty() ? openvdb::Coord(0) : box.dim();
    const auto spacing = grid->transform().voxelSize();
    run.voxels = {dim.x(), dim.y(), dim.z()};
    run.spacing = {spacing.x(), spacing.y(), spacing.z()};
    run.memoryBytes =
        kBytesOfProgram +
        bytesFor(options.fieldOnly, kBytesPerBandPoint * static_cast<double>(grid->activeVoxelCount()));
    run.order = orderFor(run.spacing, options, path.string(), progress);
    run.lastLevel = lastLevelOf(run.voxels, 0, run.order);  // the active voxels are the band
    return run;
}

}  // namespace

DryRun dryRun(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress) {
    checkFitOptions(options);
    switch (checkedKindOf(path, options)) {
        case InputKind::mesh:
            return ofMesh(path, options, progress);
        case InputKind::image:
            return ofImage(path, options, progress);
        case InputKind::vdb:
            return ofLevelSet(path, options, progress);
        case InputKind::pyramid:
            break;
    }
    throw UsageError(fmt::format(
        "--dry-run: {} is a pyramid, whose levels are known; isowave info tells them", path.string()));
}

}  // namespace isowave::lod
