#include "lod/regions/fine_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "isowave/error.h"
#include "lod/voxel_edges.h"

namespace isowave::lod {
namespace {

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

bool FineRegions::place(int step, const openvdb::math::Transform& lattice, const Progress& progress) {
    Placed placed{lattice.copy(), {}};
    for (const RegionShape& shape : shapes_)
        if (order_.stepOf(shape.level) == step)
            placed.regions.push_back(std::make_shared<const ShapeDistance>(shape, placed.lattice, progress));
    if (placed.regions.empty()) return false;
    placed_[step] = std::move(placed);
    return true;
}

RegionsByStep FineRegions::regionsFor(int step, const openvdb::math::Transform& own) const {
    RegionsByStep regions;
    for (const auto& [finer, placed] : placed_)
        for (const auto& region : placed.regions)
            if (finer < step) regions[finer].push_back(fading(region, *placed.lattice, longestVoxel(own)));
    return regions;
}

}  // namespace isowave::lod
