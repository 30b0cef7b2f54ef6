// Steps of a field that lies in slabs: a step halves lines along one axis, and slabs of another axis hold whole ones.
//
// Between phases a field lies in columns, cut along z and along y. A phase is a run of steps that slabs of one of these two axes can
// make by themselves: its tasks read the columns of a slab, halve, and write the columns of the coarser field. So all that goes from
// one slab to another is what lies in the folder. Where cuts are after a phase follows from where they were: halved with the lattice.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "isowave/progress.h"
#include "lod/slabs/slab_cuts.h"
#include "lod/slabs/slab_store.h"
#include "wavelets/pyramid.h"

namespace isowave::lod {

struct SlabGrid {
    SlabCuts rows{2, {}}, columns{1, {}};  // along z and y
};

struct SlabPhase {
    int first = 0, end = 0;  // steps
    int cut = 2;             // its slabs are those of this axis
    SlabGrid before, after;

    int slabs() const { return cut == 2 ? before.rows.count() : before.columns.count(); }
};

// The phase that begins with a step; it ends at the next step that is asked for, if not before.
SlabPhase phaseFrom(int step, const StepOrder& order, const SlabGrid& grid,
                    const std::function<bool(int step)>& isAskedFor);

// What the slabs of the first phase are made of: parts as they were fitted, whose origin is moved now.
struct SlabOrigin {
    AffineTransform indexToWorld;
    openvdb::Coord shift{0};

    openvdb::math::Transform::Ptr transform() const;
};
// Step 0 in a slab that was fitted.
BSplineField fittedPart(const SlabStore& store, int slab, const SlabOrigin& origin);

struct SlabHalving {
    SlabPhase phase;
    StepOrder order;
    bool keep = false;                 // shapes and details
    std::optional<SlabOrigin> origin;  // of a first phase
};

// What a slab's task tells.
struct SlabHalved {
    std::vector<std::int64_t> details;           // of each of the phase's steps
    std::vector<wavelets::FieldExtent> extents;  // of the slab, after each
};

// The task: the slab's field at phase.first, its steps, and the columns of what comes out. REQUIRES: with an origin the phase's
// slabs are those of z.
SlabHalved halveSlab(const SlabStore& store, const SlabHalving& halving, int slab, const Progress& progress);
// Puts a slab of z into columns.
void putColumns(const SlabStore& store, int step, int row, const BSplineField& part, const SlabGrid& grid);

// The whole field.
BSplineField wholeField(const SlabStore& store, int step, const SlabGrid& grid);

}  // namespace isowave::lod
