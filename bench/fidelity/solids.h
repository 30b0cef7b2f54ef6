// What is compared: a solid as a surface, and what everybody gets of it, its signed distances.
//
// Everything is in voxels: lattice point i of level 0 lies at (i, i, i), and lengths are voxels of level 0.
#pragma once

#include <string>

#include "isowave/mesh.h"
#include "volume/vdb.h"

namespace isowave::bench {

struct FidelitySolid {
    std::string name;
    // The surface that levels are measured against: the CAD mesh; of a function, its zero set on a lattice twice as fine,
    // which is then taken for the solid itself; of an image, the zero set of the voxels, interpolated linearly.
    TriangleMesh truth;
    // Distances to it up to kWide voxels, exact (of an image: as `isowave` takes them).
    openvdb::FloatGrid::Ptr distance;
};

constexpr double kWide = 16;

// name: plate, plate-turned, gyroid, trabecular; a closed mesh (sampled with `voxels` voxels along its longest axis); an
// image followed by @ISO (as it is, `voxels` means nothing).
FidelitySolid fidelitySolid(const std::string& name, int voxels);

// The same distances, clamped to +-halfWidth.
openvdb::FloatGrid::Ptr clamped(const openvdb::FloatGrid& distance, double halfWidth);

}  // namespace isowave::bench
