// Slabs of an image -> parts of its field, each from its own slices and some beyond them.
//
// A slab reads kFitReach slices more on either side (of masks kMaskReach), and one for each pass of the repair that it makes. How many
// passes the whole image takes is known once all slabs are there: as many as the first pass in which none of them changed anything.
// Where a slab turns out to need more than it was given, all are fitted once more, with more slices; where it turns out to need more
// memory than it may take, which is known once its surface has been found, with thinner slabs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/image/stream.h"
#include "lod/fitting.h"
#include "lod/slabs/slab_cuts.h"
#include "lod/slabs/slab_store.h"
#include "volume/fit.h"
#include "volume/image_solid.h"
#include "wavelets/pyramid.h"

namespace isowave::lod {

// What every slab is told.
struct SlabFitPlan {
    ImageSolid solid;
    Fitting fitting;
    SlabCuts cuts;  // of lattice points, which are voxels, along z
    std::int64_t depth = 0;
    AffineTransform indexToWorld;  // of the whole image
    double memory = 0;             // bytes that fitting a slab may take beside the program; 0: any number
};

// Of a part: what all parts together need.
struct SlabFitted {
    fitting::PartRepair repair;
    wavelets::FieldExtent extent;  // before the origin is moved
    double K = 1;
    std::int64_t inside = 0;  // lattice points inside
    bool outside = false;     // whether a known lattice point is outside
    double bytesLacking =
        0;  // else: what fitting it would take, more than the plan allows; nothing was fitted
};

// The task: a slab's part into the store. Its lattice point i is voxel i of the image: the origin is not moved yet. The stream shows
// the slab's slices afterwards.
SlabFitted fitSlab(const SlabStore& store, ImageStream& stream, const SlabFitPlan& plan, int slab, int passes,
                   const Progress& progress);

// Whether the last pass still changed something, and might not have been the last.
bool needsMorePasses(const SlabFitted& slab, const SlabFitPlan& plan, int passes);

// Where a slab lacked memory: cuts by which none will, should the surface be spread evenly. Throws InputError, which names `image`,
// where slabs cannot be thinner. REQUIRES: all slabs, or one that lacks memory as the last.
std::optional<SlabCuts> thinner(const std::vector<SlabFitted>& slabs, const SlabFitPlan& plan, int passes,
                                const std::string& image);

// What the whole image's fit reports; nothing where it takes more passes than these slabs made. REQUIRES: all slabs, or one
// that needs more passes.
std::optional<FitReport> reportOf(const std::vector<SlabFitted>& slabs, const SlabFitPlan& plan, int passes);

// How the origin moves.
openvdb::Coord shiftOf(const std::vector<SlabFitted>& slabs);

}  // namespace isowave::lod
