// Inside volume/: what the image readers share. No ITK type appears here, so that only two files pay for its
// headers.
//
// A reader turns a path into a VoxelSource: a header, and a way to read slices z0 <= z < z1. readImage()
// walks over the slices and keeps them all; ImageStream keeps a few.
#pragma once

#include <cstddef>
#include <memory>

#include "isowave/image.h"

namespace isowave::imageio {

enum class ValueType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

const char* nameOf(ValueType type);  // "int16"
std::size_t sizeOf(ValueType type);  // bytes
inline bool isIntegral(ValueType type) { return type < ValueType::float32; }
// By the name that nameOf() gives; also char, short, int, float, double with and without "unsigned".
std::optional<ValueType> valueTypeOf(std::string name);

// What a file says before any voxel is read. World: LPS, mm; axis a points along axis[a] (of any length,
// usually 1) and one voxel along it is spacing[a] * axis[a].
struct Header {
    std::string format;
    std::array<std::int64_t, 3> size{};
    ValueType type = ValueType::uint8;
    std::array<double, 3> spacing{1, 1, 1};
    std::array<openvdb::Vec3d, 3> axis{openvdb::Vec3d(1, 0, 0), openvdb::Vec3d(0, 1, 0),
                                       openvdb::Vec3d(0, 0, 1)};
    openvdb::Vec3d origin{0, 0, 0};  // of the first stored voxel
    bool hasZSpacing = true;         // false for formats that hold none
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
    // Most slices that one read() may be asked for; fewer need less memory. size[2] where a file is one
    // piece.
    std::int64_t slicesPerRead = 1;
    // readNative() works; then read() need not be written.
    bool native = false;
    // Voxels lie in a file as they are: reading them again costs no decoding, and several threads may read at
    // once.
    bool plain = false;
    // Reads slices z0 <= z < z1 into out, x fastest; returns how many integers float32 could not hold
    // exactly. REQUIRES: 0 <= z0 < z1 <= size[2]; a source that is one piece is asked for all of it at once.
    // Throws InputError.
    virtual std::int64_t read(std::int64_t z0, std::int64_t z1, float* out);
    // The same as values of header.type, in this machine's byte order. REQUIRES: native.
    virtual void readNative(std::int64_t z0, std::int64_t z1, void* out);
    // True only if all of these voxels are known to be 0 without reading them (a hole of a sparse file).
    virtual bool isZero(std::int64_t, std::int64_t) { return false; }
};

using SourcePtr = std::unique_ptr<VoxelSource>;

// Where voxels lie as they are, without compression: from byte `start` of `file` on, x fastest.
struct PlainData {
    std::filesystem::path file;
    std::int64_t start = 0;
    bool bigEndian = false;
};
// REQUIRES: the file holds as many voxels as the header says.
SourcePtr openPlain(const PlainData& data, const Header& header);  // image_plain.cpp

// Opens whatever the path is, with options.spacing settled; what readImage() and ImageStream begin with.
SourcePtr openSource(const std::filesystem::path& path, const ImageReadOptions& options);  // image.cpp
// A header as users see it: an Image without values.
Image imageOf(const Header& header);

// One for each kind of input; each throws InputError for what it finds wrong before reading voxels.
SourcePtr openRaw(const std::filesystem::path& path, const ImageReadOptions& options);  // image_raw.cpp
SourcePtr openVolumeFile(const std::filesystem::path& path,
                         const ImageReadOptions& options);  // image_itk.cpp
SourcePtr openSliceFiles(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& slices,
                         const ImageReadOptions& options);  // image_itk.cpp
SourcePtr openDicomFile(const std::filesystem::path& path,
                        const ImageReadOptions& options);  // image_dicom.cpp
SourcePtr openDicomFolder(const std::filesystem::path& folder,
                          const std::vector<std::filesystem::path>& files, const ImageReadOptions& options);

// What an NRRD or MetaImage header calls the files of its voxels, relative to it: names, or one pattern
// with a %; nothing when they are in the file itself. Throw InputError.
std::vector<std::string> nrrdVoxelFiles(const std::filesystem::path& path);
std::vector<std::string> metaVoxelFiles(const std::filesystem::path& path);

// ----------------------------------------------------------------------------------- image_convert.cpp

// count values of `type` at `in` to float; swap: the bytes of each are in the other order. Returns how many
// integers changed in value.
std::int64_t convert(ValueType type, const void* in, std::int64_t count, bool swap, float* out);

// ------------------------------------------------------------------------------------- image_check.cpp

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

    // count values, the first of which is voxel number `from`; pieces come in any order.
    void look(const float* values, std::int64_t count, std::int64_t from);
    void add(const NotFinite& other);
};
// Throws InputError that says where the first one is and how many there are.
void checkFinite(const std::string& file, const std::array<std::int64_t, 3>& size, const NotFinite& found);
// "12 of 300 int32 voxels are too large for float32 and were rounded"
std::string roundedText(std::int64_t inexact, const Image& image);

// One line of printable text, at most 200 characters, of whatever a library said.
std::string oneLine(std::string text);

}  // namespace isowave::imageio
