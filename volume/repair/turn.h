// Triangles turned so that neighbours agree on outside.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/repair/edges.h"

namespace isowave::repair {

// Turns the minority of each component round. Returns whether the outcome can be trusted: where more than a
// quarter of a component had to turn, nobody knows which side its author meant. One component alone has only
// one inside. turned: the triangles turned are added to it.
bool turnToAgree(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, std::int64_t& turned,
                 const Progress& progress);

}  // namespace isowave::repair
