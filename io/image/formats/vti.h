// VTK's XML images (.vti): numbers as text, in base64, or appended, plain or compressed by zlib (io/vtk/data_array.h).
#pragma once

#include <filesystem>

#include "io/image/source.h"
#include "isowave/image.h"

namespace isowave::imageio {

// Voxel (i, j, k) of the extent lies at Origin + Direction (Spacing (i, j, k)); values of cells lie in their middles. Each component of
// each array is a volume to choose from; without options.volume the active scalars, or the only one, are read. Coordinates
// are VTK's own, with no sides of a body. A file whose numbers are appended as they are is read a few slices at a time, any other
// as a whole. Throws InputError: no VTI, several pieces, no array, truncated, damaged.
SourcePtr openVti(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
