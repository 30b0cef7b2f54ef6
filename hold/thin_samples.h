// What is thin in a solid: points in the middle of walls, sheets, struts and rods, with the way across and the thickness.
//
// They are read off level 0's mesh. Its vertices lie where the lattice's lines meet the surface, so that two that follow each
// other on a line, in and out, are the ends of a run inside the solid. Where the outward normals at the ends look away from
// each other the run passes through something thin, or through the whole of a convex solid: which of them are thin is for
// the level to say.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "polygonize/topology.h"
#include "volume/vdb.h"

namespace isowave {

// Level 0's surface in its own index space: lengths are voxels of level 0.
struct FinestSurface {
    std::vector<openvdb::Vec3d> points;
    std::vector<openvdb::Vec3f> normals;  // unit, outwards
    std::vector<float> partVolume;        // of the component that the point is on, voxels
    openvdb::Vec3d spacing{1.0};          // of level 0's lattice, world units
    int refine = 1;                       // samples of a voxel that the mesh was made of
};

// components: the mesh's. mesh: as polygonize() made it of a field with this transform, vertices and normals untouched.
FinestSurface surfaceOf(const TriangleMesh& mesh, const MeshComponents& components,
                        const openvdb::math::Transform& transform, int refine);

struct ThinSample {
    openvdb::Vec3f at{0.0f};      // in the middle
    openvdb::Vec3f normal{0.0f};  // unit, across
    float thickness = 0;          // across
    float length = 0;             // of the run, along its axis
    float partVolume = 0;         // of the part that it is in
    float area = 0;               // of the wall that it stands for, voxels^2
    float thicknessInWorld = 0;   // world units
};

// Its area, voxels^2: a line along an axis meets it |n| times, so that each vertex on one stands for |n|, n its normal's part along the
// line.
double areaOf(const FinestSurface& surface);

// Every run whose ends' normals have at most this cosine (135 degrees apart): the two sides of a right-angled edge make 0.
inline constexpr double kOppositeNormals = -0.7;

// Runs through the solid, or through what is between two of its walls: a gap, whose sample's normal is across it too.
enum class Side { inside, outside };

// Runs no longer than `longest` (voxels), along the three axes in turn, along each in the order of the lines: the same for any
// number of threads.
std::vector<ThinSample> thinSamplesOf(const FinestSurface& surface, double longest, Side side = Side::inside,
                                      const Progress& progress = {});

// How thick the thinnest share (0 to 1) of the walls are, weighted by area: the thickness in voxels and in world units, for
// each of the shares. Where voxels are no cubes, the walls that are thinnest in voxels and those that are so in the world are others.
// Zeros where there is no sample. REQUIRES: ascending shares.
struct Thickness {
    double voxels = 0, world = 0;
};
std::vector<Thickness> thinnest(const std::vector<ThinSample>& samples, const std::vector<double>& shares);

}  // namespace isowave
