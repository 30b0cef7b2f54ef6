// What kind of image a file is, by its name or, where that says nothing, by its first bytes.
#pragma once

#include <filesystem>

namespace isowave::imageio {

enum class FileKind { none, nrrd, meta, nifti, mgh, tiff, png, dicom };

// By the extension alone, in capitals too; the file need not be there.
FileKind kindByName(const std::filesystem::path& path);

// By the extension, or else by what the file begins with: scanners name DICOM files as they like. Where a name says NIfTI,
// NRRD or MetaImage and the first bytes say another of these formats or DICOM, the bytes are right.
FileKind kindOf(const std::filesystem::path& path);

}  // namespace isowave::imageio
