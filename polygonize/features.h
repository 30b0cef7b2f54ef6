// The topological features of a solid, its parts, handles and cavities: how large they are, and which of them
// a level still has.
//
// d is the signed distance to the solid's surface, negative inside; S_t = { d <= t } is the solid made
// thicker by t (thinner for t < 0). Each feature of the solid S_0 is a class of persistent homology of d,
// there for birth <= 0 < death (polygonize/persistence.h):
//
//   part     radius = -birth: the largest ball in it             gap = death: half the way to what it would merge with
//   handle   radius = death: the hole closes when S grows by it  thinnest = -birth: half the thinnest place of the ring
//   cavity   radius = death: the largest ball in it              thinnest = -birth: half the thinnest place of its wall
//
// A round hole through a plate has its own radius, however thin the plate; a slot has half its width. Classes
// are found on a lattice, so that what is narrower than its spacing may be missed; radii are then the exact
// distances to the mesh from the middle of the hole, near the lattice point that the class ends at.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "polygonize/specks.h"
#include "volume/field.h"

namespace isowave {

struct Feature {
    double radius = 0;         // world units; `reach` where it is not closed (filled) by then
    double thinnest = 0;       // world units; of a part: its radius
    bool beyondReach = false;  // radius is at least what it says
    Point core{};              // world: in the middle of the part, the hole, the cavity (unless beyondReach)
    Point weakest{};           // world: where the ring or the wall is thinnest; of a part: its core
};

struct SolidFeatures {
    std::vector<Feature> parts, handles, cavities;  // by radius, smallest first
    double spacing = 0;                             // of the lattice, world units
    double reach = 0;  // up to which d was known, world units. Cavities larger than that are not in the list
};

struct FeatureOptions {
    double spacing = 0;         // world units; REQUIRES > 0
    int reach = 16;             // in spacings
    double mostPoints = 1.2e7;  // of the lattice; spacing grows until it has no more. 12 bytes each
};

// mesh: closed and oriented, as polygonize makes it. Throws InputError as distanceFromMesh() does.
SolidFeatures featuresOf(const TriangleMesh& mesh, const FeatureOptions& options,
                         const Progress& progress = {});

// What became of the features of one kind.
struct Survival {
    std::int64_t survived = 0, closed = 0, torn = 0;  // torn: the ring or the wall has opened
    // World units. Of those that survived the smallest radius, of those that were closed (parts: that
    // vanished) the largest.
    std::optional<double> smallestSurviving, largestVanished;
};
struct SolidSurvival {
    Survival parts, handles, cavities;
};

// Asks a level's surface F = iso at the cores: a part is there while its core is inside; a handle or a cavity
// is open while its core is outside, and whole while its weakest place is inside. Exact about these points;
// an estimate of the topology where the surface moves by more than a feature's size. removed: boxes of the
// components that removeSpecks()
// took: what has its core in one of them is gone.
SolidSurvival survivalOf(const SolidFeatures& features, const BSplineField& level, double iso,
                         const std::vector<PointBox>& removed = {});

}  // namespace isowave
