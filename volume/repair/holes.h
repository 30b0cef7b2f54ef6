// Holes: boundary loops measured, refused or filled.
#pragma once

#include <string>
#include <vector>

#include "volume/repair/loops.h"
#include "volume/repair/report.h"

namespace isowave::repair {

// A loop and the surface that would fill it, trianglesOf() (base/polygon_triangles.h). length: the diagonal of the loop's
// box. width: the least of 2 area / length and of the distances between two parallel lines that hold the loop, seen along
// its vector area: a circle's diameter, a square's side, next to nothing for a crack, however it winds.
// A loop of more than 4,096 edges is measured with the fan about its mean, and filled with it.
struct Hole {
    Loop loop;
    double area = 0, width = 0, length = 0;
    std::vector<Triangle> filling;  // corners: points of the mesh; past its end: the mean of the loop
};
std::vector<Hole> holesOf(const TriangleMesh& mesh, std::vector<Loop> loops, const Progress& progress);

// Throws InputError (object: name) for holes that `options` does not close, with how many, where the widest is, its width
// and length, and the two options that help.
void refuseLargeHoles(const TriangleMesh& mesh, const std::string& name, const std::vector<Hole>& holes,
                      const MeshRepairReport& report, const RepairOptions& options);

// A loop around one triangle is closed by dropping that triangle: it bounds nothing. All others are filled.
// Throws InputError where more than 1 % of the area would be dropped so, and something would be left.
void closeHoles(TriangleMesh& mesh, const std::string& name, const std::vector<Hole>& holes,
                MeshRepairReport& report);

// The corners in ascending order, and whether an even permutation leads there.
std::pair<Triangle, bool> sortedCorners(Triangle t);

}  // namespace isowave::repair
