// The formats of images, and which of them a file is: by its name or, where that says nothing, by its first bytes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace isowave::imageio {

enum class FileKind { none, nifti, nrrd, meta, mgh, mrc, npy, vti, zarr, tiff, png, bmp, jpeg, dicom };

// The one list of formats: readers, messages, help and documentation go by it.
struct ImageFormat {
    FileKind kind;
    std::string_view name;                     // as Header::format begins
    std::vector<std::string_view> extensions;  // lower case, with the dot
    bool gzip;     // the file may be compressed by gzip as a whole; its name then ends in .gz
    bool volumes;  // a file may hold several volumes, of which --volume chooses one
};
const std::vector<ImageFormat>& imageFormats();

// "NIfTI, NRRD, MetaImage, ..."
std::string imageFormatNames();

// By the extension alone, in capitals too; the file need not be there.
FileKind kindByName(const std::filesystem::path& path);

// By the extension, or else by what the file begins with: scanners name DICOM files as they like. Where a name says NIfTI,
// NRRD or MetaImage and the first bytes say another of these formats or DICOM, the bytes are right; and where it says one kind
// of picture and they say another. What is no file, such as a pipe, is not looked into.
FileKind kindOf(const std::filesystem::path& path);

}  // namespace isowave::imageio
