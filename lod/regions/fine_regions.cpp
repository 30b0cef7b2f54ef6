#include "lod/regions/fine_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "isowave/error.h"
#include "polygonize/knot_insertion.h"

namespace isowave::lod {
namespace {

double longestVoxel(const BSplineField& field) {
    const openvdb::Vec3d spacing = field.transform().voxelSize();
    return std::max({spacing.x(), spacing.y(), spacing.z()});
}

BSplineField refined(BSplineField field, int times, const Progress& progress) {
    for (int i = 0; i < times; ++i) field = insertKnots(field, progress);
    return field;
}

bool areApart(const PointBox& a, const PointBox& b) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return true;
    return false;
}

// Of what is measured; textOf() is of what was given.
std::string shortText(const Point& p) { return fmt::format("{:.4g},{:.4g},{:.4g}", p[0], p[1], p[2]); }

}  // namespace

std::vector<int> stepsOf(const std::vector<FineRegion>& regions) {
    std::set<int> steps;
    for (const FineRegion& region : regions) steps.insert(kStepsPerLevel * region.level);
    return {steps.begin(), steps.end()};
}

FineRegions::FineRegions(const std::vector<FineRegion>& regions, const Progress& progress) {
    for (const FineRegion& region : regions) shapes_.push_back(regionShapeOf(region, progress));
}

void FineRegions::requireWithin(const PointBox& solid) const {
    for (const RegionShape& shape : shapes_)
        if (areApart(shape.bounds(), solid))
            throw InputError(shape.name,
                             fmt::format("the region is outside the solid, which lies between {} and {} "
                                         "(world coordinates)",
                                         shortText(solid.low), shortText(solid.high)));
}

void FineRegions::remember(int step, const BSplineField& field, int refine, double smallest,
                           const Progress& progress) {
    Kept kept{field, refine, smallest, {}};
    const openvdb::math::Transform::ConstPtr lattice = field.transform().copy();
    for (const RegionShape& shape : shapes_)
        if (kStepsPerLevel * shape.level == step)
            kept.regions.push_back(std::make_shared<const RegionDistance>(shape, lattice, progress));
    if (kept.regions.empty()) return;
    if (field.controlPoints->tree().hasActiveTiles()) {
        kept.field.controlPoints = field.controlPoints->deepCopy();
        kept.field.controlPoints->tree().voxelizeActiveTiles();
    }
    levels_[step / kStepsPerLevel] = std::move(kept);
}

std::optional<RegionBlend> FineRegions::blended(int step, const BSplineField& own, int refine,
                                                double smallest, const Progress& progress) const {
    const int level = step / kStepsPerLevel;
    std::vector<LocalLevels::Stage> stages;
    RegionSummary summary;
    BSplineField field = own;
    int at = level;  // whose lattice the field is on
    for (auto kept = std::make_reverse_iterator(levels_.lower_bound(level)); kept != levels_.rend(); ++kept) {
        const auto& [finer, k] = *kept;
        const openvdb::math::Transform& lattice = k.field.transform();
        auto weights = std::make_shared<FadeWeights>(Fade(k.regions, lattice, longestVoxel(own)), lattice);
        Blend b = blend(refined(field, at - finer, progress), k.field, *weights, progress);
        if (!b.differs) continue;
        field = std::move(b.field);
        at = finer;
        summary.finePoints += b.finePoints;
        stages.insert(stages.begin(), {finer, k.smallest, std::move(weights)});
    }
    if (stages.empty()) return std::nullopt;
    int samples = std::max(1, refine >> (level - at));
    for (const LocalLevels::Stage& stage : stages)
        samples = std::max(samples, levels_.at(stage.level).refine >> (stage.level - at));
    LocalLevels levels(std::move(stages), {level, smallest, nullptr});
    summary.coarsePoints = levels.pointsLeftOf(own, progress);
    return RegionBlend{std::move(field), std::move(levels), samples, summary};
}

}  // namespace isowave::lod
