// The twelve triangles of a box whose corner i = 4 z + 2 y + x is high in x, y, z where that bit is set; normals outwards.
#pragma once

#include <array>

#include "isowave/mesh.h"

namespace isowave::zoo {

inline constexpr std::array<Triangle, 12> kBoxTriangles{{{0, 2, 3},
                                                         {0, 3, 1},
                                                         {4, 5, 7},
                                                         {4, 7, 6},
                                                         {0, 1, 5},
                                                         {0, 5, 4},
                                                         {2, 6, 7},
                                                         {2, 7, 3},
                                                         {0, 4, 6},
                                                         {0, 6, 2},
                                                         {1, 3, 7},
                                                         {1, 7, 5}}};

}  // namespace isowave::zoo
