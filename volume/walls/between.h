// Where, between lattice points, a field's sign is not that of the mesh it was fitted to.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/mesh_nearest.h"
#include "volume/mesh_winding.h"

namespace isowave {

struct WrongPlace {
    openvdb::Vec3d at;    // index space of the distances
    bool inside;          // in the mesh
    double distance;      // to the mesh, voxels, > 0
    openvdb::Vec3d foot;  // there
    openvdb::Vec3d
        outwards;  // the normal of the face at the foot, of length 1; 0: the triangle is degenerate
};

// The signs of a mesh, as LatticeLines has them, at the points of a lattice `perVoxel` times as fine.
class FineSigns {
  public:
    // points, triangles: index space of the distances. perVoxel: 1, 2 or 4. Throws as LatticeLines does.
    FineSigns(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles, int perVoxel,
              bool evenOdd, const Progress& progress = {});

    int perVoxel() const { return perVoxel_; }
    // In voxels, of what is inside; by counting points.
    double volume() const {
        return static_cast<double>(lines_.insideCount()) / (perVoxel_ * perVoxel_ * perVoxel_);
    }
    const LatticeLines& lines() const { return lines_; }
    // fine: perVoxel times index space.
    bool inside(const openvdb::Coord& fine) const { return lines_.inside(fine); }

  private:
    int perVoxel_;
    LatticeLines lines_;
};

// Whether components of a mesh overlap, or come so near to each other that some line of the finer lattice passes between
// them from one of its points to the next: both are then one solid, with other parts, handles and cavities than they have one
// by one. What a component does with itself (a line grazes its notches) does not count. of: point -> component.
bool componentsTouch(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles,
                     const std::vector<std::uint32_t>& of, std::size_t components, const FineSigns& signs);

// The most points a voxel, 4, 2 or 1, that FineSigns takes 256 MB for (it keeps 4 bytes for each line along x and for each
// crossing, which the area tells) and that LatticeLines has room for; 1 where even that is more.
int finestSigns(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles);

// Of the points of the finer lattice in the cells that begin at the points of `near`, those where F's sign is the wrong
// one and the mesh is at least `least` voxels away (F rounds off edges, and a mesh drawn with such a lattice resolves
// no less). shift: lattice point i of the distances is i + shift of the field. By cells, in the order of near's leaves.
std::vector<WrongPlace> wrongPlaces(const BSplineField& field, const openvdb::Coord& shift,
                                    const openvdb::MaskTree& near, const FineSigns& signs,
                                    const TriangleHierarchy& triangles, double least,
                                    const Progress& progress = {});

}  // namespace isowave
