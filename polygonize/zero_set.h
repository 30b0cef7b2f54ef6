// The zero set of a spline near a point, and how well a mesh follows it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

// World coordinates throughout. F - iso is the function; its gradient in world coordinates is M^-1 times that
// in index space where index -> world is x M + t (row vectors).
class ZeroSet {
  public:
    // REQUIRES: the field outlives this and has an affine, invertible transform.
    explicit ZeroSet(const BSplineField& field, double iso = 0);

    struct Foot {
        openvdb::Vec3d at;
        openvdb::Vec3d normal;  // unit, outwards; zero where the gradient vanishes
    };
    // Newton's iteration along the gradient, x -= F g / |g|^2, until a step is below kSettled voxels. For a
    // point closer than the radius of curvature the foot is the nearest point to second order in the
    // distance. Nothing where it does not settle within kReach voxels of the point: at a fold, or where the
    // function is flat.
    std::optional<Foot> foot(const openvdb::Vec3d& point) const;

    // For meshes with vertices near the zero set: the normals of their feet; where there is none, the mean of
    // the triangles' normals, weighted by area. The same for any number of threads.
    std::vector<std::array<float, 3>> normalsOf(const TriangleMesh& mesh,
                                                const Progress& progress = {}) const;

    double voxel() const { return voxel_; }  // shortest side, world units

    static constexpr double kSettled = 1e-9;
    static constexpr double kReach = 1;

  private:
    const BSplineField& field_;
    double iso_, voxel_;
    openvdb::Mat4d worldToIndex_;
    openvdb::Mat3d gradientToWorld_;
};

// Distances from the triangles of a mesh to the zero set, world units, from four samples a triangle: the
// middles of the sides and the centroid. Corners of a mesh made by polygonize() are on the zero set. Where a
// sample's foot is not found, or is farther away than the nearest corner, the distance to that corner is
// taken: the zero set is no farther.
struct Deviation {
    double max = 0, rms = 0;  // rms weighted by area
    std::int64_t samples = 0;
};
// The same to the bit for any number of threads. An empty mesh gives zeros.
Deviation deviationFrom(const ZeroSet& surface, const TriangleMesh& mesh, const Progress& progress = {});

}  // namespace isowave
