// Readers of pictures and grids: png, pnm, bmp, npy, asc, tiff-picture, jpeg.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// The reader; luminance() and heights() of what it gives; PNG and npy come back the same when they are written and read again.
std::vector<Target> pictureTargets();

}  // namespace isowave::fuzz
