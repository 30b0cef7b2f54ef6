#include "io/image/kind.h"

#include <algorithm>

#include "base/text.h"
#include "io/image/dicom/data_set.h"
#include "io/image/formats/mrc.h"
#include "io/image/formats/nifti.h"
#include "io/image/header.h"
#include "io/picture/jpeg.h"
#include "io/picture/tiff.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

FileKind pictureByContent(const std::string& text) {
    if (text.starts_with("\x89PNG\r\n\x1a\n")) return FileKind::png;
    if (isTiff(text)) return FileKind::tiff;
    return isJpeg(text) ? FileKind::jpeg : FileKind::none;
}

FileKind kindByContent(const fs::path& path) {
    const std::string text = firstBytes(path, 1024);
    if (text.starts_with("NRRD")) return FileKind::nrrd;
    if (text.starts_with("\x93NUMPY")) return FileKind::npy;
    for (const char* key : {"ObjectType =", "NDims =", "Comment ="})
        if (text.starts_with(key)) return FileKind::meta;
    if (beginsAsNifti(niftiHeaderOf(path))) return FileKind::nifti;
    if (beginsAsMrc(text)) return FileKind::mrc;
    if (isGzip(path)) return FileKind::none;
    if (text.size() > 131 && text.compare(128, 4, "DICM") == 0) return FileKind::dicom;
    if (const FileKind picture = pictureByContent(text); picture != FileKind::none) return picture;
    return looksLikeDicom(path) ? FileKind::dicom : FileKind::none;  // without a preamble
}

bool isHeaderFormat(FileKind kind) {
    return kind == FileKind::nifti || kind == FileKind::nrrd || kind == FileKind::meta;
}

bool isPicture(FileKind kind) {
    return kind == FileKind::png || kind == FileKind::tiff || kind == FileKind::jpeg || kind == FileKind::bmp;
}

}  // namespace

const std::vector<ImageFormat>& imageFormats() {
    static const std::vector<ImageFormat> formats = {
        {FileKind::nifti, "NIfTI", {".nii"}, true, true},
        // With NIfTI's header and without its magic word.
        {FileKind::nifti, "Analyze", {}, true, true},
        {FileKind::nrrd, "NRRD", {".nrrd", ".nhdr"}, true, true},
        {FileKind::meta, "MetaImage", {".mha", ".mhd"}, true, true},
        {FileKind::mgh, "MGH", {".mgh", ".mgz"}, true, true},
        {FileKind::mrc, "MRC", {".mrc", ".mrcs", ".map", ".ccp4", ".rec", ".st", ".ali"}, true, true},
        {FileKind::npy, "NumPy", {".npy"}, true, true},
        {FileKind::vti, "VTK ImageData", {".vti"}, true, true},
        // A folder.
        {FileKind::zarr, "OME-Zarr", {".zarr"}, false, false},
        {FileKind::tiff, "TIFF", {".tif", ".tiff"}, false, false},
        {FileKind::png, "PNG", {".png"}, false, false},
        {FileKind::bmp, "BMP", {".bmp"}, false, false},
        {FileKind::jpeg, "JPEG", {".jpg", ".jpeg"}, false, false},
        {FileKind::dicom, "DICOM", {".dcm", ".dicom"}, false, false},
    };
    return formats;
}

std::string imageFormatNames() {
    std::string names;
    for (const ImageFormat& format : imageFormats())
        names += (names.empty() ? "" : ", ") + std::string(format.name);
    return names;
}

FileKind kindByName(const fs::path& path) {
    std::string extension = toLower(path.extension().string());
    const bool gzip = extension == ".gz";
    if (gzip) extension = toLower(path.stem().extension().string());
    for (const ImageFormat& format : imageFormats()) {
        const auto& known = format.extensions;
        if (std::find(known.begin(), known.end(), extension) != known.end() && (!gzip || format.gzip))
            return format.kind;
    }
    return FileKind::none;
}

FileKind kindOf(const fs::path& path) {
    const FileKind kind = kindByName(path);
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return kind;  // to look into a pipe is to wait for who writes it
    if (isPicture(kind)) {
        const std::string start = firstBytes(path, 16);
        const FileKind found = pictureByContent(start);
        return found != FileKind::none ? found : start.starts_with("BM") ? FileKind::bmp : kind;
    }
    if (kind != FileKind::none && !isHeaderFormat(kind)) return kind;
    const FileKind found = kindByContent(path);
    const bool wins = kind == FileKind::none || isHeaderFormat(found) || found == FileKind::dicom;
    return wins && found != FileKind::none ? found : kind;
}

}  // namespace isowave::imageio
