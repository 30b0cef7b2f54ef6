// Which lattice points lie inside a closed mesh: the sign of every lattice point, exactly, whatever the
// distance.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/vdb.h"

namespace isowave {

// The mesh's crossings with every lattice line along x that meets it.
//
// A lattice line (y, z) = (j, k) is cut by the triangles whose projection along x holds (j, k). Corners are
// rounded to 2^-20 voxel, so that "left of an edge" is an integer's sign, and a line that meets an edge or a
// corner is taken as shifted by (e, e^2), e infinitesimal (Edelsbrunner and Muecke: "Simulation of
// simplicity"). Two triangles on one edge compute the same integer with opposite signs, so a line through it
// meets exactly one of them: a closed mesh is entered as often as it is left. The x of a crossing is an exact
// fraction, and the first lattice point at or beyond it is all that is kept.
//
// (1) inside(p) depends on the rounded mesh and p alone: not on threads, order of triangles or neighbours.
// (2) A lattice point on the surface is inside or outside; boxes with corners on lattice points hold their
// low
//     faces and not their high ones.
class LatticeLines {
  public:
    // points: index space. evenOdd: inside where the number of crossings is odd, else where the winding
    // number is not 0. Throws InputError (object "mesh") when a line leaves the mesh as an inside one (it is
    // not closed) or the mesh is more than 2^20 voxels across.
    LatticeLines(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles,
                 bool evenOdd, const Progress& progress = {});

    bool inside(const openvdb::Coord& point) const;

    // Bit i: lattice point low + (i, 0, 0) is inside; i = 0..7.
    unsigned inside8(const openvdb::Coord& low) const;

    // Lattice points inside.
    std::int64_t insideCount() const;

    // Whether some line crosses the mesh between two lattice points that are inside: parts overlap or touch
    // there, or a slit is too thin for the lattice.
    bool hasBuried() const { return buried_ > 0; }
    // How many times lines do that.
    std::int64_t buriedCount() const { return buried_; }
    // How many times some line crosses the mesh between two lattice points that are outside.
    std::int64_t skippedCount() const { return skipped_; }

    // Whether some lattice point lies in two parts at once, or in one that winds around it twice; not with evenOdd.
    bool hasOverlap() const { return hasOverlap_; }

    // Lattice points outside this box are outside the mesh.
    const openvdb::CoordBBox& box() const { return box_; }

  private:
    struct Rasteriser;

    // First toggle beyond x, and the line's end.
    std::pair<const std::int32_t*, const std::int32_t*> togglesBeyond(const openvdb::Coord& point) const;
    std::size_t lineOf(std::int32_t y, std::int32_t z) const {
        return std::size_t(z - box_.min().z()) * std::size_t(box_.dim().y()) +
               std::size_t(y - box_.min().y());
    }

    bool hasOverlap_ = false;
    std::int64_t buried_ = 0, skipped_ = 0;
    openvdb::CoordBBox box_;  // empty: nothing is inside
    // Line l: inside on [t0, t1), [t2, t3), ... where t = toggles_[start_[l]], ...; the rest of the line's
    // entries are INT32_MAX.
    std::vector<std::uint32_t> start_;
    std::vector<std::int32_t> toggles_;
};

}  // namespace isowave
