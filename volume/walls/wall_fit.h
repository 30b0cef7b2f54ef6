// Thin walls and thin gaps of a mesh, put where they are: F = 0 on their faces.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/walls/between.h"

namespace isowave {

struct WallFitOptions {
    double halfWidth = 4;  // w of the fit, voxels: F = K is w voxels from the surface
    // Samples of a node along each axis, 1, 2 or 4, that the finest mesh of the field is made with. Walls too thin
    // for these are thickened until they are `sigma` sampling steps thick. Less tears them: a tube with walls of 0.23, turned by
    // 17 degrees, becomes 25 % thicker and keeps its one handle; with 1.0 it is 20 % and 92 handles, with 0.95 16 % and 784.
    int refine = 4;
    double sigma = 1.05;
    double widest = 4;                   // walls and gaps up to this thickness, voxels; at most 4
    const FineSigns* between = nullptr;  // signs to ask for between lattice points, too; none: only at these
    int rounds = 60;                     // of the ascent, at most; and as many for its last part
};

struct WallFitReport {
    std::int64_t rows = 0;       // conditions on F: on faces, at lattice points, in the middle of walls
    int sweeps = 0;              // over them
    std::int64_t unmet = 0;      // signs that could not be met
    std::int64_t between = 0;    // rows for places between lattice points whose sign was wrong
    std::int64_t changed = 0;    // control points
    std::int64_t thickened = 0;  // lattice points outside that a thickened wall or a closed gap took in
    // Voxels: the thickness that 1 % of the lattice points beside walls of at most `widest` are below, of walls whose
    // faces are parallel within 16 degrees; 0: no such wall.
    double thinnest = 0;
    // The least refine, 1, 2 or 4, whose mesh keeps all but 1 % of the walls whole: sigma/refine <= thinnest.
    int leastRefine = 1;
};

// The least change of the control points (ascend()) such that, within two lattice points of a wall or gap of at most
// `widest` voxels,
//   F = 0, softly, at the feet of lattice points nearer than 0.75 voxel, one a cell of half a voxel;
//   F has the shape's sign at lattice points nearer than 1.8 voxels;
//   F < 0 in the middle of walls below a voxel, F > 0 in the middle of gaps below one;
//   F has the shape's sign between lattice points, at those of `between` that are farther than 0.1 voxel from the mesh and
//   came out wrong (where walls meet, at the mouths of slots, at the edges of bars): looked for up to six times.
// Walls that are too thin for the samples of a mesh at `refine` are thickened until they are not; gaps that are too
// thin for them are closed, so that they end along a line and not in a row of tunnels.
// Quasi-interpolation makes plates of 1 to 2 voxels 3 to 9 % thicker, 17 % at worst: F has a kink in their middle, where it
// overshoots. Elsewhere the field keeps its bits.
//
// A wall that is thickened past a lattice point, or a gap that is closed over one, takes it in: the field's shape is
// then the sign of F there. At all other lattice points the shape stays, and the repair that follows gives F its sign.
// field: fitted to `distance` without repair. distance: of the mesh, as distanceFromMesh() has it; shift: its lattice
// point i is i + shift of the field. points: the mesh's, in the index space of `distance`.
// The same bits for any number of threads. Throws Cancelled.
WallFitReport fitWalls(BSplineField& field, const openvdb::FloatTree& distance, const openvdb::Coord& shift,
                       const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles,
                       const WallFitOptions& options = {}, const Progress& progress = {});

}  // namespace isowave
