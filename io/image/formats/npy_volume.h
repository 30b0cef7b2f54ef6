// Arrays of NumPy (.npy) of three or four axes.
#pragma once

#include <filesystem>

#include "io/image/source.h"
#include "isowave/image.h"

namespace isowave::imageio {

// The indices are x, y, z and, of a fourth axis, the volume that options.volume chooses, whatever order the file stores them in: C
// (last index fastest) or Fortran (first index fastest). A file says nothing of spacing and sides. Throws InputError: no
// array, truncated, elements that are not numbers, another number of axes.
SourcePtr openNpyVolume(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
