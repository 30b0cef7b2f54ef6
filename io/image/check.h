// What every image must satisfy, whatever file it came from, and the texts that say what it does not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// "512 x 512 x 300"; "157 MB"
std::string sizeText(const std::array<std::int64_t, 3>& size);
std::string bytesText(double bytes);

// Product of the sizes times bytesEach. Throws InputError for a size < 1 and for a product beyond 2^62.
std::int64_t byteCount(const std::string& file, const std::vector<std::int64_t>& size,
                       std::int64_t bytesEach);

// Throws InputError when the voxels would take more than the limit: those kept, keptBytes a voxel, and those
// of one read() beside them, besideBytes a voxel.
void checkMemory(const std::string& file, const VoxelSource& source, const ImageReadOptions& options,
                 std::size_t keptBytes, std::size_t besideBytes);

// Puts options.spacing in place of the header's, with warnings; then throws InputError for spacing that is
// not positive, a direction that cannot be inverted, an origin that is not finite.
void settleGeometry(const std::string& file, Header& header, const ImageReadOptions& options);

// NaNs and infinities among voxels, counted piece by piece.
struct NotFinite {
    std::int64_t count = 0;
    std::int64_t first = -1;  // voxel number, x fastest
    float value = 0;          // there

    // Adds those among `n` values, the first of which is voxel number `from`; pieces come in any order.
    void countIn(const float* values, std::int64_t n, std::int64_t from);
    void add(const NotFinite& other);
};
// Throws InputError that says where the first one is and how many there are.
void checkFinite(const std::string& file, const std::array<std::int64_t, 3>& size, const NotFinite& found);
// "12 of 300 int32 voxels are too large for float32 and were rounded"
std::string roundedText(std::int64_t inexact, const Image& image);

// One line of printable text, at most 200 characters, of whatever a library said.
std::string oneLine(std::string text);

}  // namespace isowave::imageio
