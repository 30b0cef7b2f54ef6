// The names and colours that a label image gives its labels.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/segment.h"

namespace isowave::imageio {

// Of a .seg.nrrd as 3D Slicer writes it, and of a DICOM segmentation's file, without colours; nothing of other formats, of folders and
// of what cannot be read.
std::vector<ImageSegment> segmentsOf(const std::filesystem::path& path);

}  // namespace isowave::imageio
