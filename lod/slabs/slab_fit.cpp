#include "lod/slabs/slab_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lod/memory.h"
#include "volume/distance_image.h"
#include "volume/fit/known.h"
#include "volume/linear_transform.h"
#include "volume/nodes_image.h"

namespace isowave::lod {
namespace {

int passesOf(const Fitting& fitting) {
    switch (fitting.method) {
        case FitMethod::distance:
            return fitting.distance.mostRepairPasses;
        case FitMethod::binary:
            return fitting.binary.mostRepairPasses;
        case FitMethod::mask:
            break;
    }
    return fitting.mask.mostRepairPasses;
}

double floorOf(const Fitting& fitting) {
    switch (fitting.method) {
        case FitMethod::distance:
            return fitting::kDistanceFloor / fitting.distance.halfWidth;
        case FitMethod::binary:
            return fitting::kBinaryFloor;
        case FitMethod::mask:
            break;
    }
    return kMaskFloor;
}

int reachOf(const Fitting& fitting) { return fitting.method == FitMethod::mask ? kMaskReach : kFitReach; }

constexpr double kSparing = 0.9;  // of the slices that would suffice, should each take as much

struct LacksMemory {
    double bytes;
};

// Throws LacksMemory.
void allow(const SlabFitPlan& plan, const ImageStream& stream, double bytes) {
    bytes += static_cast<double>(stream.bytesKept());
    if (plan.memory > 0 && bytes > plan.memory) throw LacksMemory{bytes};
}

NodeCollection nodesOf(ImageStream& stream, const SlabFitPlan& plan, double bytesPerNode,
                       const Progress& progress) {
    NodeCollection nodes = nodesFromImage(stream, plan.solid, progress);
    allow(plan, stream, bytesPerNode * static_cast<double>(nodes.nodeCount()));
    return nodes;
}

BSplineField fitPart(ImageStream& stream, const SlabFitPlan& plan, const LeafBox& box, int passes,
                     fitting::PartRepair& repair, const Progress& progress) {
    const int most = std::min(passes, passesOf(plan.fitting));
    switch (plan.fitting.method) {
        case FitMethod::distance: {
            DistanceFitOptions options = plan.fitting.distance;
            options.mostRepairPasses = most;
            auto distance =
                distanceFromImage(stream, plan.solid, options.halfWidth, progress, [&](std::int64_t points) {
                    allow(plan, stream, kBytesPerSlabPoint * static_cast<double>(points));
                });
            return fitDistancePart(std::move(distance), options, box, repair, progress);
        }
        case FitMethod::binary: {
            BinaryFitOptions options = plan.fitting.binary;
            options.mostRepairPasses = most;
            return fitBinaryPart(nodesOf(stream, plan, kBytesPerSlabNode, progress), options, box, repair,
                                 progress);
        }
        case FitMethod::mask:
            break;
    }
    MaskFitOptions options = plan.fitting.mask;
    options.mostRepairPasses = most;
    return fitMaskPart(nodesOf(stream, plan, kBytesPerSlabMaskNode, progress), options, box, repair,
                       progress);
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
    const std::int64_t reach = reachOf(plan.fitting) + passes;
    const LeafBox box = plan.cuts.box(slab);
    const std::int64_t low = std::max<std::int64_t>(0, box.min().z() - reach) & ~std::int64_t{7};
    return {low, std::min<std::int64_t>(plan.depth, (box.max().z() + 8 + reach) & ~std::int64_t{7})};
}

SlabFitted fitted(const SlabStore& store, ImageStream& stream, const SlabFitPlan& plan, int slab, int passes,
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

}  // namespace

SlabFitted fitSlab(const SlabStore& store, ImageStream& stream, const SlabFitPlan& plan, int slab, int passes,
                   const Progress& progress) {
    try {
        return fitted(store, stream, plan, slab, passes, progress);
    } catch (const LacksMemory& lacking) {
        SlabFitted told;
        told.bytesLacking = lacking.bytes;
        return told;
    }
}

std::optional<SlabCuts> thinner(const std::vector<SlabFitted>& slabs, const SlabFitPlan& plan, int passes,
                                const std::string& image) {
    double most = 0;
    for (const SlabFitted& slab : slabs) most = std::max(most, slab.bytesLacking);
    if (most == 0) return std::nullopt;
    // In proportion to the slices that are read, as if those of now were of the even thickness.
    const double beside = 2.0 * (reachOf(plan.fitting) + passes), depth = static_cast<double>(plan.depth);
    const double read = std::min(depth, depth / plan.cuts.count() + beside);
    const int count = plan.cuts.count();
    const double thickness = kSparing * plan.memory / most * read - beside;
    SlabCuts cuts = SlabCuts::even(
        2, plan.depth, std::max(count + 1, static_cast<int>(std::ceil(depth / std::max(thickness, 8.0)))));
    if (cuts.count() == count)
        refuseTooLarge(
            image, most, plan.memory,
            fmt::format("slabs are 8 slices thick as they are, and see {:.0f} beside them; crop or "
                        "downsample it",
                        beside));
    return cuts;
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
    if (fitting.method == FitMethod::binary) report.filterPasses = fitting.binary.passes;
    if (fitting.method == FitMethod::mask) report.gradientPasses = fitting.mask.passes;
    report.repairFloor = floorOf(fitting);
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
