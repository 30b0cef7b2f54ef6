// The colours of distances to level 0, the same in files of meshes as on the page of `isowave view` (view/page/colours.js).
#pragma once

#include <array>
#include <cstdint>

namespace isowave {

// share: 0 to 1 of the range that is shown; beyond it the last colour. sRGB, 0 to 255. What has not moved is pale; what has
// goes through amber and red to a dark purple.
std::array<double, 3> distanceColour(double share);

// The same in linear light, 0 to 1, as glTF has the colours of vertices (sRGB's transfer function, IEC 61966-2-1).
std::array<double, 3> linearDistanceColour(double share);

// Of a vertex in COLOR_0 of glTF: red, green, blue and alpha in linear light, 65,535 for 1. range: the distance of the last
// colour; 0: all are at the first.
using StoredColour = std::array<std::uint16_t, 4>;
StoredColour storedDistanceColour(float distance, double range);

}  // namespace isowave
