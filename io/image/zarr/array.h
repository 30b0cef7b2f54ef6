// What .zarray says of an array of Zarr, version 2: its shape, and how its chunks are stored.
//     https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/value_type.h"
#include "io/image/zarr/unpack.h"

namespace isowave::imageio {

struct ZarrArray {
    std::filesystem::path folder;  // that .zarray and the chunks lie in
    std::vector<std::int64_t> shape, chunk;
    ValueType type = ValueType::uint8;  // bool is uint8
    bool bigEndian = false;
    ZarrCodec codec = ZarrCodec::none;
    double fill = 0;            // of chunks that are not there
    std::string fillText;       // as it is written
    bool firstFastest = false;  // order F, inside a chunk
    char separator = '.';       // of a chunk's indices in its name

    std::size_t axes() const { return shape.size(); }
    std::int64_t chunkVoxels() const;
    std::int64_t chunkBytes() const { return chunkVoxels() * static_cast<std::int64_t>(sizeOf(type)); }
    // How many chunks there are along an axis.
    std::int64_t chunksAlong(std::size_t axis) const { return (shape[axis] - 1) / chunk[axis] + 1; }
    // Where the chunk with these numbers lies, an axis each.
    std::filesystem::path fileOf(const std::vector<std::int64_t>& numbers) const;
    // Voxels of a chunk from one index to the next, an axis each.
    std::vector<std::int64_t> strides() const;
};

// Throws InputError: no .zarray, no JSON, keys that are missing or senseless, filters, codecs and types that are not read.
ZarrArray readZarrArray(const std::filesystem::path& folder);

// The voxels of a chunk in this machine's byte order; false where it is not there. Throws InputError that names the chunk's file: it
// is damaged, or holds more or fewer bytes than a chunk has. out: chunkBytes() of them.
bool readZarrChunk(const ZarrArray& array, const std::vector<std::int64_t>& numbers, std::vector<char>& out);

}  // namespace isowave::imageio
