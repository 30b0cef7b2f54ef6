// What a hierarchy is for: moving its base with the details riding along, and leaving details out.
#pragma once

#include <cstddef>
#include <vector>

#include "subdivision/meshes/hierarchy.h"

namespace isowave::subdivision {

// How details follow when the base is moved.
//   global   they keep their direction in space
//   local    they turn with the surface: each is taken from the frame of its point on the subdivided surface (normal,
//            and the direction of an edge there) before the edit to that after it. A rigid motion of the base is then
//            a rigid motion of every level; global frames carry a translation only.
enum class Frames { global, local };

// The mesh after `steps` steps from the moved base. REQUIRES: moved.size() == base.points.size(). Throws as
// reconstruct() does. With the base's own points it is what reconstruct() returns (local: up to rounding).
PolygonMesh reconstructEdited(const Hierarchy& hierarchy, const std::vector<Vec3>& moved, int steps,
                              Frames frames, const Progress& progress = {});

// The details of all steps, and how many are not 0.
std::size_t detailCount(const Hierarchy& hierarchy);
std::size_t nonzeroDetailCount(const Hierarchy& hierarchy);
// Sets every detail shorter than `length` (in the units of the mesh) to 0.
void threshold(Hierarchy& hierarchy, double length);
// Keeps the `count` longest; of equal ones the coarser, then the earlier. Base + longest first is the order in which
// details are best sent.
void keepLongest(Hierarchy& hierarchy, std::size_t count);
// No details: what subdivision alone makes of the base.
void clearDetails(Hierarchy& hierarchy);

// Distances between the same vertices of two meshes. REQUIRES: as many points.
struct PointError {
    double rms = 0, largest = 0;
};
PointError pointError(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace isowave::subdivision
