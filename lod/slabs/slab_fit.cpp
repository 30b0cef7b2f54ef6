#include "lod/slabs/slab_fit.h"

#include <algorithm>

#include "isowave/error.h"
#include "volume/distance_image.h"
#include "volume/fit/known.h"
#include "volume/linear_transform.h"
#include "volume/nodes_image.h"

namespace isowave::lod {
namespace {

int passesOf(const Fitting& fitting) {
    return fitting.method == FitMethod::distance ? fitting.distance.mostRepairPasses
                                                 : fitting.binary.mostRepairPasses;
}

BSplineField fitPart(ImageStream& stream, const SlabFitPlan& plan, const LeafBox& box, int passes,
                     fitting::PartRepair& repair, const Progress& progress) {
    const int most = std::min(passes, passesOf(plan.fitting));
    switch (plan.fitting.method) {
        case FitMethod::distance: {
            DistanceFitOptions options = plan.fitting.distance;
            options.mostRepairPasses = most;
            auto distance = distanceFromImage(stream, plan.solid, options.halfWidth, progress, plan.allow);
            return fitDistancePart(std::move(distance), options, box, repair, progress);
        }
        case FitMethod::binary: {
            BinaryFitOptions options = plan.fitting.binary;
            options.mostRepairPasses = most;
            return fitBinaryPart(nodesFromImage(stream, plan.solid, progress), options, box, repair,
                                 progress);
        }
        case FitMethod::mask:
            break;
    }
    throw UsageError("--slabs needs a fit that works on parts; give --fit distance or --fit binary");
}

bool knowsOutside(const Shape& shape) {
    for (auto value = shape.cbeginValueOn(); value; ++value)
        if (!*value) return true;
    return false;
}

// Slices z0 <= z < z1 that a slab reads for so many passes; multiples of 8, but for the image's end.
struct Slices {
    std::int64_t z0, z1;
};
Slices slicesOf(const SlabFitPlan& plan, int slab, int passes) {
    const std::int64_t reach = kFitReach + passes;
    const LeafBox box = plan.cuts.box(slab);
    const std::int64_t low = std::max<std::int64_t>(0, box.min().z() - reach) & ~std::int64_t{7};
    return {low, std::min<std::int64_t>(plan.depth, (box.max().z() + 8 + reach) & ~std::int64_t{7})};
}

}  // namespace

SlabFitted fitSlab(const SlabStore& store, ImageStream& stream, const SlabFitPlan& plan, int slab, int passes,
                   const Progress& progress) {
    const Slices slices = slicesOf(plan, slab, passes);
    stream.showSlices(slices.z0, slices.z1);
    const openvdb::Coord first(0, 0, static_cast<int>(slices.z0));
    LeafBox box = plan.cuts.box(slab);
    if (slab > 0) box.min() -= first;
    if (slab + 1 < plan.cuts.count()) box.max() -= first;
    SlabFitted told;
    BSplineField part = partOf(fitPart(stream, plan, box, passes, told.repair, progress), box, first);
    const auto transform = linearTransform(plan.indexToWorld, "image");
    part.controlPoints->setTransform(transform);
    part.shape->setTransform(transform->copy());
    told.extent = wavelets::FieldExtent::of(part);
    told.K = part.K;
    told.inside = pointsInside(*part.shape);
    told.outside = knowsOutside(*part.shape);
    store.putFitted(slab, part);
    return told;
}

bool needsMorePasses(const SlabFitted& slab, const SlabFitPlan& plan, int passes) {
    const std::vector<std::int64_t>& repaired = slab.repair.repaired;
    return passes < passesOf(plan.fitting) && static_cast<int>(repaired.size()) == passes &&
           !repaired.empty() && repaired.back() != 0;
}

std::optional<FitReport> reportOf(const std::vector<SlabFitted>& slabs, const SlabFitPlan& plan, int passes) {
    for (const SlabFitted& slab : slabs)
        if (needsMorePasses(slab, plan, passes)) return std::nullopt;
    FitReport report;
    const Fitting& fitting = plan.fitting;
    const bool byDistance = fitting.method == FitMethod::distance;
    if (!byDistance) report.filterPasses = fitting.binary.passes;
    report.repairFloor =
        byDistance ? fitting::kDistanceFloor / fitting.distance.halfWidth : fitting::kBinaryFloor;
    for (const SlabFitted& slab : slabs) {
        report.latticePoints += slab.repair.latticePoints;
        report.disagreeing += slab.repair.disagreeing;
    }
    for (int pass = 0; pass < passes; ++pass) {
        std::int64_t count = 0;
        for (const SlabFitted& slab : slabs)
            if (static_cast<std::size_t>(pass) < slab.repair.repaired.size())
                count += slab.repair.repaired[static_cast<std::size_t>(pass)];
        report.repairAgreed = count == 0;
        if (report.repairAgreed) return report;
        report.repaired += count;
        ++report.repairPasses;
    }
    report.repairAgreed = false;
    if (passes >= passesOf(fitting)) return report;
    return std::nullopt;
}

openvdb::Coord shiftOf(const std::vector<SlabFitted>& slabs) {
    openvdb::CoordBBox known;
    for (const SlabFitted& slab : slabs)
        if (slab.extent.controlPoints > 0) known.expand(slab.extent.box);
    return fitting::shiftOf(known);
}

}  // namespace isowave::lod
