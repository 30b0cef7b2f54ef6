// NRRD (teem.sourceforge.net/nrrd/format.html): raw, gzip, text and hexadecimal voxels, in the file or beside it.
//
// Where voxels lie: 'space directions' and 'space origin', turned to LPS from whichever of right/left, anterior/posterior,
// superior/inferior the space names, in its 'space units'; without a space 'spacings', 'axis mins' and 'units'. A space
// that names no side of the body (scanner-xyz, 3D-right-handed) is taken as it is, with a remark.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/image/formats/stored_volume.h"
#include "io/image/segment.h"

namespace isowave::imageio {

// An axis of kind 'list' or 'time' and axes behind the third one are volumes to choose from: layers of a segmentation,
// times. Throws InputError for what is no NRRD header, colours and vectors, 2D images, lengths that are no numbers.
StoredVolume readNrrdHeader(const std::filesystem::path& path);

// Of a segmentation of 3D Slicer: "Segment0_Name", "Segment0_LabelValue", "Segment0_Color" (three numbers from 0 to 1),
// "Segment0_Layer". Throws InputError.
std::vector<ImageSegment> nrrdSegments(const std::filesystem::path& path);

// The files of the voxels as the header names them, relative to it; nothing when the voxels are in the file itself.
// Throws InputError.
std::vector<std::string> nrrdVoxelFiles(const std::filesystem::path& path);

}  // namespace isowave::imageio
