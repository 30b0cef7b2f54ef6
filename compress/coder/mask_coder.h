// The set of nodes, coded bit by bit in raster order.
//
// Blocks of 8 x 8 x 8 without a node are flagged first and cost nothing more. Each other bit is mixed of three templates of 16
// bits coded before and of two match models.
#pragma once

#include <string>
#include <string_view>

#include "compress/coder/lattice.h"

namespace isowave::compress {

std::string encodeNodes(const BitBox& nodes);
// Throws std::runtime_error when the bytes do not end where the bits do.
BitBox decodeNodes(std::string_view bytes, const Size& size);

}  // namespace isowave::compress
