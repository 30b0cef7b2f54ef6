// Images: voxels with spacing, orientation and origin.
//
//   Image head = readImage("cranium.nhdr");                        // NIfTI, NRRD, MetaImage, TIFF, DICOM
//   Image scan = readImage("dicom/", {.series = "1.2.840"});       // a folder of slices
//   Image raw  = readImage("matrix.dat", {.spacing = {{0.957, 0.957, 1.5}},
//                                         .raw = RawLayout{.size = {256, 256, 108}, .type = "int16"}});
//
// World coordinates are millimetres, LPS (x to the patient's left, y to the back, z to the head), as in ITK
// and DICOM; NIfTI's RAS and the spaces of NRRD are turned.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave {

// Voxel (i,j,k), fractions too, lies at origin + i axis[0] + j axis[1] + k axis[2], in world units.
struct AffineTransform {
    std::array<std::array<double, 3>, 3> axis{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<double, 3> origin{};

    std::array<double, 3> operator()(const std::array<double, 3>& index) const {
        std::array<double, 3> world = origin;
        for (int a = 0; a < 3; ++a)
            for (int row = 0; row < 3; ++row) world[row] += index[a] * axis[a][row];
        return world;
    }
    friend bool operator==(const AffineTransform&, const AffineTransform&) = default;
};

// x is fastest: voxel (x,y,z) is values[x + size[0]*(y + size[1]*z)]; index 0 is the first stored voxel
// whatever extent the file was cropped from.
struct Image {
    std::array<std::int64_t, 3> size{};
    std::vector<float> values;
    AffineTransform indexToWorld;     // axis[a]: spacing[a] times the direction of axis a
    std::string componentType;        // as stored: "int16", "uint8", "float32", ...
    bool integral = false;            // componentType is an integer type
    double slope = 1, intercept = 0;  // values = slope * stored + intercept (NIfTI's scl_slope, scl_inter)
    std::string format;               // "NRRD", "NIfTI", "DICOM series", ...
    Space space = Space::lps;  // unspecified: the file names no anatomical axes; coordinates are its own
    std::string unit = "mm";   // of world coordinates; "angstrom" of MRC maps
    std::vector<std::string> warnings;  // one line each: "no z spacing in TIFF; 1 x 1 x 1 mm is assumed; ..."

    std::int64_t voxelCount() const { return size[0] * size[1] * size[2]; }
    // Lengths of the three axes of indexToWorld, in mm.
    ISOWAVE_EXPORT std::array<double, 3> spacing() const;
};

// Voxels in memory of the caller's: a view, of which nothing is copied but a slab at a time while it is looked at.
//
//   std::vector<std::int16_t> scan(...);   // z fastest
//   Solid bone = open(VoxelView{.data = scan.data(), .type = "int16", .size = {nx, ny, nz},
//                               .stride = {2 * ny * nz, 2 * nz, 2}}, {.iso = 300});
//
// REQUIRES: all voxels are readable for as long as a function that takes the view has not returned.
struct VoxelView {
    const void* data = nullptr;          // voxel (0,0,0)
    std::string type = {};               // int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64
    bool bigEndian = false;              // of the bytes of a voxel
    std::array<std::int64_t, 3> size{};  // voxels along x, y, z
    std::array<std::int64_t, 3> stride{};  // bytes from a voxel to the next along x, y, z; below 0: backwards
    AffineTransform indexToWorld = {};     // LPS, mm
};

// What a headerless file lacks.
struct RawLayout {
    std::array<std::int64_t, 3> size{};  // voxels, x fastest
    std::string type = {};               // int8 uint8 int16 uint16 int32 uint32 float32 float64
    bool bigEndian = false;
    std::int64_t headerBytes = 0;  // skipped at the start of the file
};

struct ImageReadOptions {
    // mm. For formats that hold none (raw, TIFF, PNG) it is the spacing; elsewhere it replaces the header's,
    // with a warning when the two differ by more than 0.1 %.
    std::optional<std::array<double, 3>> spacing = {};
    // Given: the file is headerless, whatever its name ends in.
    std::optional<RawLayout> raw = {};
    // Which series of a DICOM folder: any unique part of its UID or of its description.
    std::optional<std::string> series = {};
    // Which volume of a file that holds several, from 1 on: times of a 4D NIfTI, layers of a .seg.nrrd. Without it such a
    // file is refused.
    std::optional<std::int64_t> volume = {};
    // What voxels that are NaN, "not measured", are taken as. Without it they are refused.
    std::optional<float> nan = {};
    // Which stack of a DICOM folder or file, from 1 on, as the message about several lists them: frames of one series,
    // size, orientation and spacing. Of a segmentation: its how-manieth segment, alone.
    std::optional<std::int64_t> stack = {};
    // Which channel of a TIFF or OME-Zarr of several, from 1 on.
    std::optional<std::int64_t> channel = {};
    // Which of several volumes that lie at one place (times, echoes) in DICOM, TIFF or OME-Zarr, from 1 on.
    std::optional<std::int64_t> time = {};
    // DICOM slices in uneven steps along a line are interpolated, linearly, to even ones; without it they are refused.
    bool resampleSlices = false;
    // Bytes that the voxels may take while reading (stored type and float32 side by side); 0: what the
    // machine has. A header that asks for more is refused before anything is allocated.
    std::int64_t memoryLimit = 0;
};

// Reads NIfTI, NRRD, MetaImage, OME-Zarr, a folder of DICOM or TIFF or PNG slices, a multi-page TIFF, a multi-frame
// DICOM, or (when options.raw is given) a headerless file. Throws InputError, one line, for: missing, empty or truncated
// file, 2D image, several volumes of which none is chosen, RGB or vector voxels, voxels not finite (says where), spacing
// <= 0, a direction matrix that cannot be inverted, several series or stacks (lists them), slices that do not lie on one
// line in even steps within 1 %, a size that memory cannot hold; UsageError for an option that chooses in other formats
// (--series for NIfTI); Cancelled when progress says so.
ISOWAVE_EXPORT Image readImage(const std::filesystem::path& path, const ImageReadOptions& options = {},
                               const Progress& progress = {});

// Header only: everything but `values`. Truncation is found where file sizes show it.
ISOWAVE_EXPORT Image readImageHeader(const std::filesystem::path& path, const ImageReadOptions& options = {});

// The files beside an NRRD, MetaImage or NIfTI header that hold its voxels: one, a list, or what a pattern with a
// number names; for a NIfTI pair the other file. Nothing when the voxels are in the file itself, for other formats, and for a header that cannot be read.
ISOWAVE_EXPORT std::vector<std::filesystem::path> voxelFilesOf(const std::filesystem::path& path);

// Whether a path looks like something readImage() reads (by extension, or a folder).
ISOWAVE_EXPORT bool isImagePath(const std::filesystem::path& path);

}  // namespace isowave
