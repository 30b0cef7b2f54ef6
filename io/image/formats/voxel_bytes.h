// The bytes of voxels, however a file stores them: as they are, deflated (gzip or zlib), as text, as hexadecimal digits,
// in one file or in several.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/value_type.h"

namespace isowave::imageio {

enum class Encoding { raw, deflated, text, hex };

// Where one of the files begins to hold voxels.
struct VoxelPiece {
    std::filesystem::path file;
    std::int64_t start = 0;  // byte of the file
    std::int64_t skip = 0;   // bytes that are left out behind it, after decoding
};

// How voxels are stored, x fastest among them.
struct VoxelLayout {
    Encoding encoding = Encoding::raw;
    std::vector<VoxelPiece> pieces;  // each holds as many bytes as the others; one after another they are all
    bool bigEndian = false;
    std::int64_t inner = 1;  // numbers that lie side by side for each voxel (an axis before x); one is read
    std::int64_t outer = 1;  // volumes that lie one after another (axes behind z); one is read
};

// Voxels behind a header in a file that may itself be compressed by gzip: from byte `start` on, of what it inflates to.
// Throws InputError where it is, and its voxels are encoded once more or, asItIs false, not counted from the start.
void putBehindHeader(VoxelLayout& voxels, const std::filesystem::path& file, std::int64_t start,
                     bool asItIs = true);

class VoxelBytes {
  public:
    virtual ~VoxelBytes() = default;
    // Bytes [at, at + count) of all the voxels. Going back is allowed, and costs decoding from the start. Throws
    // InputError for what breaks off, for damaged compression (its checksum is compared where the end is reached), for text
    // that is no number and for a number that `type` cannot hold.
    virtual void read(std::int64_t at, char* to, std::int64_t count) = 0;
};

// total: bytes of all the voxels. Numbers come in the byte order that the layout states, text in this machine's.
// REQUIRES: total is a multiple of the number of pieces.
std::unique_ptr<VoxelBytes> openVoxelBytes(const VoxelLayout& layout, ValueType type, std::int64_t total);

// Throws InputError unless the files can hold what is promised ("'sizes' says 4 x 3 x 2"): a file that is missing or too
// short, an inflated length that differs, fewer characters than so many numbers take. Memory that is set aside for voxels
// afterwards is at most about 1032 times the files' length, deflate's best ratio.
void checkVoxelBytes(const std::filesystem::path& header, const VoxelLayout& layout, ValueType type,
                     std::int64_t total, const std::string& promise);

}  // namespace isowave::imageio
