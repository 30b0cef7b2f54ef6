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

// How often each axis of the finer lattice is halved to get the coarser one.
Halvings between(const Halvings& finer, const Halvings& coarser) {
    return {coarser[0] - finer[0], coarser[1] - finer[1], coarser[2] - finer[2]};
}

// No axis of a level is sampled more coarsely than it was.
int samplesAfter(int samples, const Halvings& halvings) {
    constexpr int kAll = 31;  // bits of an int
    return samples >> std::min(kAll, *std::min_element(halvings.begin(), halvings.end()));
}

bool areApart(const PointBox& a, const PointBox& b) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return true;
    return false;
}

// Of what is measured; textOf() is of what was given.
std::string shortText(const Point& p) { return fmt::format("{:.4g},{:.4g},{:.4g}", p[0], p[1], p[2]); }

}  // namespace

std::vector<int> stepsOf(const std::vector<FineRegion>& regions, const StepOrder& order) {
    std::set<int> steps;
    for (const FineRegion& region : regions) steps.insert(order.stepOf(region.level));
    return {steps.begin(), steps.end()};
}

FineRegions::FineRegions(const std::vector<FineRegion>& regions, const StepOrder& order,
                         const Progress& progress)
    : order_(order) {
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
        if (order_.stepOf(shape.level) == step)
            kept.regions.push_back(std::make_shared<const RegionDistance>(shape, lattice, progress));
    if (kept.regions.empty()) return;
    if (field.controlPoints->tree().hasActiveTiles()) {
        kept.field.controlPoints = field.controlPoints->deepCopy();
        kept.field.controlPoints->tree().voxelizeActiveTiles();
    }
    kept_[step] = std::move(kept);
}

std::optional<RegionBlend> FineRegions::blended(int step, const BSplineField& own, int refine,
                                                double smallest, const Progress& progress) const {
    std::vector<LocalLevels::Stage> stages;
    std::vector<int> samplesOf;  // of the stages, coarsest first
    RegionSummary summary;
    BSplineField field = own;
    Halvings at = order_.halvings(step);  // of the lattice that the field is on
    for (auto kept = std::make_reverse_iterator(kept_.lower_bound(step)); kept != kept_.rend(); ++kept) {
        const auto& [finer, k] = *kept;
        const openvdb::math::Transform& lattice = k.field.transform();
        auto weights = std::make_shared<FadeWeights>(Fade(k.regions, lattice, longestVoxel(own)), lattice);
        const Halvings there = order_.halvings(finer);
        Blend b = blend(insertKnots(field, between(there, at), progress), k.field, *weights, progress);
        if (!b.differs) continue;
        field = std::move(b.field);
        at = there;
        summary.finePoints += b.finePoints;
        samplesOf.push_back(k.refine);
        stages.insert(stages.begin(), {there, k.smallest, std::move(weights)});
    }
    if (stages.empty()) return std::nullopt;
    const Halvings ofOwn = order_.halvings(step);
    int samples = std::max(1, samplesAfter(refine, between(at, ofOwn)));
    for (std::size_t i = 0; i < stages.size(); ++i)
        samples = std::max(samples,
                           samplesAfter(samplesOf[stages.size() - 1 - i], between(at, stages[i].halvings)));
    LocalLevels levels(std::move(stages), {ofOwn, smallest, nullptr});
    summary.coarsePoints = levels.pointsLeftOf(own, progress);
    return RegionBlend{std::move(field), std::move(levels), samples, summary};
}

}  // namespace isowave::lod
