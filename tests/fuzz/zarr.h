// Zarr stores: zarr.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// The bytes are .zarray, .zattrs and one chunk, each behind a byte 0 but the first. Where there are attributes the array is the
// resolution "0" of an OME-Zarr image. The chunk has the names that chunk 0 of one to five axes has, with "." and with "/".
std::vector<Target> zarrTargets();

}  // namespace isowave::fuzz
