// How thick the walls of a solid are, before anything is fitted: of a mesh, and of voxels.
//
// A mesh: from points p spread evenly over the surface a ray goes inwards, along -n, until it meets the surface again, at f. Where
// the normals there look away from each other there is a wall, (n - n').(p - f)/2 thick. The ray is followed by sphere tracing
// (Hart 1996): the distance to the mesh says how far it may go on in one step.
//
// Voxels: the thickness at a voxel is the shortest of the three runs of inside voxels along the axes through it. It is exact
// for walls across an axis and at most sqrt(3) times too large for others.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave::lod {

// Of the thinnest share (0 to 1) of the walls, by area, for each of the shares: in the mesh's units. Empty where nothing lies
// opposite anything, as in an open sheet. REQUIRES: at least one triangle; oriented outwards.
std::vector<double> thinnestWalls(const TriangleMesh& mesh, const std::vector<double>& shares,
                                  const Progress& progress = {});

// Voxels that are inside (1) or outside (0), x fastest.
struct InsideVoxels {
    std::array<std::int64_t, 3> size{};
    std::vector<std::uint8_t> inside;

    std::int64_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return x + size[0] * (y + size[1] * z);
    }
};
struct VoxelFacts {
    std::int64_t faces = 0;  // of inside voxels, outside beyond them; the image's border counts as outside
    std::int64_t cells = 0;  // of 2x2x2 voxels, some inside and some not
    std::array<std::int64_t, 3> low{}, high{};  // of the inside voxels; low > high where there is none
    std::vector<double> walls;                  // of the thinnest shares, by faces: voxels
};
// Runs of more than 255 voxels count as that.
VoxelFacts factsOf(const InsideVoxels& voxels, const std::vector<double>& shares,
                   const Progress& progress = {});

}  // namespace isowave::lod
