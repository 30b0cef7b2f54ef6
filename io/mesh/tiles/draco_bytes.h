// Triangles of whole-numbered points as Draco packs them.
//     https://google.github.io/draco
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "isowave/mesh.h"

namespace isowave {

// A Draco mesh with one attribute, POSITION, three int32; nothing is rounded. Points that touch at a point or an edge alone
// may come back as several. REQUIRES: a triangle; every point is used by one.
std::string dracoBytes(std::span<const std::array<std::int32_t, 3>> points,
                       std::span<const Triangle> triangles);

}  // namespace isowave
