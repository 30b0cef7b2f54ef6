// Images: voxels with spacing, orientation and origin, as ITK reads them. No ITK type appears here.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "volume/vdb.h"

namespace isowave {

// x is fastest: voxel (x,y,z) is values[x + size[0]*(y + size[1]*z)]; index 0 is the first stored voxel whatever
// extent the file was cropped from.
struct Image {
    std::array<std::int64_t, 3> size{};
    std::vector<float> values;
    openvdb::math::Mat4d indexToWorld = openvdb::math::Mat4d::identity();  // row vectors: world = (i,j,k,1) * M; LPS, mm
    std::string componentType;      // as stored: "int16", "uint8", "float32", ...
    bool integral = false;          // componentType is an integer type
    std::string format;             // "NRRD", "NIfTI", "DICOM series", ...
    std::vector<std::string> warnings;  // one line each: "TIFF holds no z spacing; 1 assumed, give --spacing"

    std::int64_t voxelCount() const { return size[0] * size[1] * size[2]; }
};

// What a headerless file needs, and what --spacing overrides in formats that lose it.
struct RawLayout {
    std::optional<std::array<std::int64_t, 3>> size;  // voxels, x fastest
    std::string type;                                 // int8 uint8 int16 uint16 int32 uint32 float32 float64
    std::optional<std::array<double, 3>> spacing;     // mm
    bool bigEndian = false;
    std::int64_t headerBytes = 0;                     // skipped at the start of the file
};

// Reads NIfTI, NRRD, MetaImage, a folder of DICOM or TIFF or PNG slices, a multi-page TIFF, or (when raw.size is
// given) a headerless file. Throws InputError for: missing, empty or truncated file, a 2D image, RGB voxels,
// NaN or infinite voxels (says where), spacing <= 0, a direction matrix that cannot be inverted, a folder with
// several series (lists them).
Image readImage(const std::filesystem::path& path, const RawLayout& raw = {}, const Progress& progress = {});

// Header only: everything but `values`.
Image readImageHeader(const std::filesystem::path& path, const RawLayout& raw = {});

// Whether a path looks like something readImage() reads (by extension, or a folder).
bool isImagePath(const std::filesystem::path& path);

}  // namespace isowave
