#include "lod/slabs/slab_steps.h"

#include "volume/fit/known.h"
#include "volume/linear_transform.h"
#include "wavelets/part_direction.h"

namespace isowave::lod {
namespace {

constexpr int kY = 1, kZ = 2;

SlabCuts& cutsAlong(SlabGrid& grid, int axis) { return axis == kZ ? grid.rows : grid.columns; }

BSplineField slabOf(const SlabStore& store, const SlabPhase& phase, int slab) {
    std::vector<BSplineField> parts;
    if (phase.cut == kZ)
        for (int column = 0; column < phase.before.columns.count(); ++column)
            parts.push_back(store.field(phase.first, slab, column));
    else
        for (int row = 0; row < phase.before.rows.count(); ++row)
            parts.push_back(store.field(phase.first, row, slab));
    return joinedPart(parts);
}

void putSlab(const SlabStore& store, const SlabPhase& phase, int slab, const BSplineField& part) {
    if (phase.cut == kZ) return putColumns(store, phase.end, slab, part, phase.after);
    for (int row = 0; row < phase.after.rows.count(); ++row)
        store.putField(phase.end, row, slab, partOf(part, phase.after.rows.box(row)));
}

}  // namespace

SlabPhase phaseFrom(int step, const StepOrder& order, const SlabGrid& grid,
                    const std::function<bool(int step)>& isAskedFor) {
    SlabPhase phase{step, step, order.axisAfter(step) == kZ ? kY : kZ, grid, grid};
    do {
        const int axis = order.axisAfter(phase.end);
        if (axis == phase.cut) break;
        if (axis != 0) cutsAlong(phase.after, axis) = cutsAlong(phase.after, axis).halved();
        ++phase.end;
    } while (!isAskedFor(phase.end));
    return phase;
}

openvdb::math::Transform::Ptr SlabOrigin::transform() const {
    return fitting::shiftedTransform(*linearTransform(indexToWorld, "image"), shift);
}

BSplineField fittedPart(const SlabStore& store, int slab, const SlabOrigin& origin) {
    BSplineField part = store.fitted(slab);
    if (origin.shift != openvdb::Coord(0)) part = partOf(part, SlabCuts{}.box(0), origin.shift);
    part.controlPoints->setTransform(origin.transform());
    part.shape->setTransform(origin.transform());
    return part;
}

SlabHalved halveSlab(const SlabStore& store, const SlabHalving& halving, int slab, const Progress& progress) {
    const SlabPhase& phase = halving.phase;
    BSplineField part =
        halving.origin ? fittedPart(store, slab, *halving.origin) : slabOf(store, phase, slab);
    SlabHalved told;
    for (int step = phase.first; step < phase.end; ++step) {
        wavelets::DirectionResult result =
            wavelets::analysePart(part, halving.order.axisAfter(step), progress);
        told.details.push_back(static_cast<std::int64_t>(result.details->activeVoxelCount()));
        if (halving.keep) store.putStep(step, slab, part.shape, result.details);
        part = std::move(result.coarse);
        told.extents.push_back(wavelets::FieldExtent::of(part));
    }
    putSlab(store, phase, slab, part);
    return told;
}

void putColumns(const SlabStore& store, int step, int row, const BSplineField& part, const SlabGrid& grid) {
    for (int column = 0; column < grid.columns.count(); ++column)
        store.putField(step, row, column, partOf(part, grid.columns.box(column)));
}

BSplineField wholeField(const SlabStore& store, int step, const SlabGrid& grid) {
    std::vector<BSplineField> parts;
    for (int row = 0; row < grid.rows.count(); ++row)
        for (int column = 0; column < grid.columns.count(); ++column)
            parts.push_back(store.field(step, row, column));
    return joinedField(parts);
}

}  // namespace isowave::lod
