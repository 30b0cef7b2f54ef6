// Signed distances in voxels, the input of fitDistance().
//
// Every distanceFrom...() returns a FloatGrid whose transform takes lattice points to the world, with values
// in voxels (index space), negative inside, exact sign at every lattice point, clamped to ±halfWidth; active
// where |value| < halfWidth; inactive voxels and tiles ±halfWidth by sign; background +halfWidth. halfWidth
// >= 1, in voxels (4 = four on each side).
#pragma once

#include "volume/distance_image.h"
#include "volume/distance_mesh.h"
#include "volume/nodes.h"
#include "volume/nodes_image.h"
