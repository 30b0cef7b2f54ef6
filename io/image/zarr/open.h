// Zarr of version 2, in a folder: plain arrays, and the images of OME-Zarr.
#pragma once

#include <filesystem>

#include "io/image/source.h"
#include "isowave/image.h"

namespace isowave::imageio {

// options.time and options.channel choose among several. Chunks that are not there hold the array's fill value, which a remark says. One
// layer of chunks is unpacked at a time, by several threads. Throws InputError as chooseZarrArray() and readZarrArray() do;
// also for axes other than x, y, z, t and c, no z, several times or channels of which none is chosen, no chunk at all.
SourcePtr openZarr(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
