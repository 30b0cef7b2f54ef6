// Readers of images: nifti, nrrd, metaimage, mgh, mrc, npy-volume, vti, tiff, dicom, dicom-compressed.
#pragma once

#include "isowave/image.h"
#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// readImage(), and ImageStream slice by slice, which must give the same values. A file of several volumes is read again with
// its first one chosen. Compressed DICOM pixels go to GDCM in a child process as in the program (io/image/dicom/codec.h), which takes
// most of the time; so they have a target of their own, and `dicom` passes them over.
std::vector<Target> imageTargets();

// 64 MB of memory.
ImageReadOptions imageOptions();
// As above.
void readBothWays(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::fuzz
