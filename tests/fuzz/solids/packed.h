// Packed solids: packed.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// Bytes that begin with the magic number of .iwz are the file itself. Others change a small packed solid: sections left out,
// doubled, exchanged, cut, some of their bytes replaced; checksums are right, so that what a damaged file cannot be is decoded.
// What is read has finite control points, can be analysed, and its mesh is sound.
std::vector<Target> packedTargets();

}  // namespace isowave::fuzz
