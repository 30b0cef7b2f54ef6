// What every image reader returns: a VoxelSource, which is a header and a way to read slices z0 <= z < z1.
// readImage() walks over the slices and keeps them all; ImageStream keeps a few.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/value_type.h"
#include "isowave/image.h"
#include "isowave/mesh.h"

namespace isowave::imageio {

// What a file says before any voxel is read. World: LPS, mm; axis a points along axis[a] (of any length,
// usually 1) and one voxel along it is spacing[a] * axis[a].
struct Header {
    std::string format;
    std::array<std::int64_t, 3> size{};
    ValueType type = ValueType::uint8;
    std::array<double, 3> spacing{1, 1, 1};
    std::array<Vec3, 3> axis{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    Vec3 origin;                 // of the first stored voxel
    bool hasZSpacing = true;     // false for formats that hold none, or where one axis has none:
    std::string unspaced = "z";  // the axes that it lacks then
    Space space = Space::lps;    // unspecified: the file does not say where left and right are
    std::string unit = "mm";     // of world coordinates; "angstrom" for MRC
    std::vector<std::string> warnings;
    // componentType and integral, where they differ from `type`: NIfTI scales int16 into float32.
    std::optional<ValueType> storedType;
    std::optional<bool> integral;
    double slope = 1, intercept = 0;  // values that read() gives = slope * stored + intercept

    std::int64_t sliceVoxels() const { return size[0] * size[1]; }
};

class VoxelSource {
  public:
    virtual ~VoxelSource() = default;
    Header header;
    // Most slices that one read() may be asked for; fewer need less memory. size[2] where a file has to be
    // decoded as a whole.
    std::int64_t slicesPerRead = 1;
    // readNative() works; then read() need not be written.
    bool native = false;
    // Voxels lie in a file as they are: reading them again costs no decoding, and several threads may read at
    // once.
    bool plain = false;
    // Reads slices z0 <= z < z1 into out, x fastest; returns how many integers float32 could not hold
    // exactly. REQUIRES: 0 <= z0 < z1 <= size[2]; a source of slicesPerRead == size[2] is asked for all
    // slices at once. Throws InputError.
    virtual std::int64_t read(std::int64_t z0, std::int64_t z1, float* out);
    // The same as values of header.type, in this machine's byte order. REQUIRES: native.
    virtual void readNative(std::int64_t z0, std::int64_t z1, void* out);
    // True only if all of these voxels are known to be 0 without reading them (a hole of a sparse file).
    virtual bool isZero(std::int64_t, std::int64_t) { return false; }
};

using SourcePtr = std::unique_ptr<VoxelSource>;

// Converts `count` values of `type` at `in` to float; swap: the bytes of each are in the other order. Returns
// how many integers changed in value.
std::int64_t convert(ValueType type, const void* in, std::int64_t count, bool swap, float* out);

// A header as users see it: an Image without values.
Image imageOf(const Header& header);

}  // namespace isowave::imageio
