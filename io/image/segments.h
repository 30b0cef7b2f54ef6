// The names and colours that a label image gives its labels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace isowave::imageio {

struct ImageSegment {
    double label = 0;                                        // of its voxels
    std::string name;                                        // one line; may be empty
    std::optional<std::array<std::uint8_t, 3>> colour = {};  // red, green, blue, sRGB
    int layer = 0;                                           // which of several volumes it is in, from 0 on
};

// Of a .seg.nrrd as 3D Slicer writes it, and of a DICOM segmentation's file, without colours; nothing of other formats, of folders and
// of what cannot be read.
std::vector<ImageSegment> segmentsOf(const std::filesystem::path& path);

}  // namespace isowave::imageio
