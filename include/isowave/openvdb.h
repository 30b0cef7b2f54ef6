// Solids and fields from and to OpenVDB's grids. The one public header that includes OpenVDB.
#pragma once

#include <openvdb/openvdb.h>

#include "isowave/field.h"
#include "isowave/solid.h"

namespace isowave {

// A level set: negative inside, in world units, of any half-width. Throws as open() of a file does.
ISOWAVE_EXPORT Solid open(const openvdb::FloatGrid& levelSet, const SolidOptions& options = {},
                          const Progress& progress = {});

// The control points: active where known, ±K elsewhere by side; the transform takes lattice points to the world.
ISOWAVE_EXPORT openvdb::FloatGrid::ConstPtr gridOf(const Field& field);

// A field of control points that another program has made, or changed. inside: true at lattice points that are inside, in
// active and inactive voxels and in tiles alike; the same active voxels. REQUIRES: both grids have one transform.
ISOWAVE_EXPORT Field fieldOf(openvdb::FloatGrid::Ptr controlPoints, openvdb::BoolGrid::Ptr inside,
                             double K = 1);

}  // namespace isowave
