#include "lod/regions/kept_levels.h"

#include <algorithm>

#include "polygonize/knot_insertion.h"

namespace isowave::lod {
namespace {

// How often each axis of the finer lattice is halved to get the coarser one.
Halvings between(const Halvings& finer, const Halvings& coarser) {
    return {coarser[0] - finer[0], coarser[1] - finer[1], coarser[2] - finer[2]};
}

// No axis of a level is sampled more coarsely than it was.
int samplesAfter(int samples, const Halvings& halvings) {
    constexpr int kAll = 31;  // bits of an int
    return samples >> std::min(kAll, *std::min_element(halvings.begin(), halvings.end()));
}

}  // namespace

void KeptLevels::remember(DrawnLevel level) {
    openvdb::FloatGrid::Ptr& points = level.field.controlPoints;
    if (points->tree().hasActiveTiles()) {
        points = points->deepCopy();
        points->tree().voxelizeActiveTiles();
    }
    const int step = level.step;
    kept_[step] = std::move(level);
}

std::optional<RegionBlend> KeptLevels::blended(const DrawnLevel& own, const RegionsByStep& regions,
                                               const Progress& progress) const {
    std::vector<LocalLevels::Stage> stages;
    std::vector<const DrawnLevel*> blendedIn;  // finest first, as stages
    BSplineField field = own.field;
    Halvings at = order_.halvings(own.step);  // of the lattice that the field is on
    for (auto region = std::make_reverse_iterator(regions.lower_bound(own.step)); region != regions.rend();
         ++region) {
        const DrawnLevel& kept = kept_.at(region->first);
        const openvdb::math::Transform& lattice = kept.field.transform();
        auto weights = std::make_shared<FadeWeights>(Fade(region->second, lattice), lattice);
        const Halvings there = order_.halvings(kept.step);
        Blend b = blend(insertKnots(field, between(there, at), progress), kept.field, *weights, progress);
        if (!b.differs) continue;
        field = std::move(b.field);
        at = there;
        blendedIn.insert(blendedIn.begin(), &kept);
        stages.insert(stages.begin(), {there, kept.smallest, std::move(weights)});
    }
    if (stages.empty()) return std::nullopt;
    const Halvings ofOwn = order_.halvings(own.step);
    int samples = std::max(1, samplesAfter(own.refine, between(at, ofOwn)));
    for (std::size_t i = 0; i < stages.size(); ++i)
        samples = std::max(samples, samplesAfter(blendedIn[i]->refine, between(at, stages[i].halvings)));
    LocalLevels levels(std::move(stages), {ofOwn, own.smallest, nullptr});
    RegionSummary summary;
    for (std::size_t i = 0; i < blendedIn.size(); ++i)
        summary.finePoints += levels.pointsOf(i, blendedIn[i]->field, progress);
    summary.coarsePoints = levels.pointsOf(blendedIn.size(), own.field, progress);
    return RegionBlend{std::move(field), std::move(levels), samples, summary};
}

}  // namespace isowave::lod
