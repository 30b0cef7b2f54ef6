// Voxels that lie in a file as they are: headerless ones, and those of uncompressed NRRD, MetaImage and
// NIfTI.
#pragma once

#include <cstdint>
#include <filesystem>

#include "io/image/source.h"

namespace isowave::imageio {

// Where the voxels lie: from byte `start` of `file` on, x fastest.
struct PlainData {
    std::filesystem::path file;
    std::int64_t start = 0;
    bool bigEndian = false;
};
// REQUIRES: the file holds as many voxels as the header says.
SourcePtr openPlain(const PlainData& data, const Header& header);

// Turns round the bytes of each of `count` values.
void reverseBytes(std::size_t bytesEach, char* values, std::int64_t count);

// A headerless file. REQUIRES: options.raw. Throws InputError for an unknown type and for a file that is too
// short.
SourcePtr openRaw(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
