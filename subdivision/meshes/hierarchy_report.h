// What taking a mesh apart and putting it together again finds out: sizes, details and errors (isowave/subdivision.h).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "isowave/subdivision.h"

namespace isowave::subdivision {

// The errors of the base with the longest 0, 1, 2, 5, 10, 20, 50 % of the details. `whole`: with all of them, in the
// order of reconstruct().
std::vector<RebuildReport::Share> errorByShare(const Hierarchy& hierarchy, const PolygonMesh& whole,
                                               const Progress& progress = {});

// Points of the base's own file count as the base's within this part of its diagonal: the file may have been written in
// single precision.
inline constexpr double kSameBase = 1e-6;

// The first vertex of `mesh` that lies elsewhere than that of the base. REQUIRES: requireSameConnectivity(base, mesh).
struct MovedVertex {
    std::size_t vertex;
    double distance;
};
std::optional<MovedVertex> firstMovedVertex(const PolygonMesh& base, const PolygonMesh& mesh);

// `mesh` has the limit positions of the base, and they are not its own points: details do not belong on it.
// REQUIRES: requireSameConnectivity(base, mesh).
bool isBaseAtLimit(const Hierarchy& hierarchy, const PolygonMesh& mesh);

}  // namespace isowave::subdivision
