#include "io/image/kind.h"

#include <fstream>
#include <map>
#include <string>

#include "base/text.h"
#include "io/image/dicom/data_set.h"
#include "io/image/formats/nifti.h"
#include "io/picture/tiff.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

FileKind kindByContent(const fs::path& path) {
    char start[132] = {};
    std::ifstream(path, std::ios::binary).read(start, sizeof start);
    const std::string text(start, sizeof start);
    if (text.compare(128, 4, "DICM") == 0) return FileKind::dicom;
    if (text.compare(0, 4, "NRRD") == 0) return FileKind::nrrd;
    if (text.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0) return FileKind::png;
    if (isTiff(text)) return FileKind::tiff;
    for (const char* key : {"ObjectType =", "NDims =", "Comment ="})
        if (text.starts_with(key)) return FileKind::meta;
    if (beginsAsNifti(niftiHeaderOf(path))) return FileKind::nifti;
    return looksLikeDicom(path) ? FileKind::dicom : FileKind::none;  // without a preamble
}

bool isHeaderFormat(FileKind kind) {
    return kind == FileKind::nifti || kind == FileKind::nrrd || kind == FileKind::meta;
}

}  // namespace

FileKind kindByName(const fs::path& path) {
    static const std::map<std::string, FileKind> kinds = {
        {".nrrd", FileKind::nrrd}, {".nhdr", FileKind::nrrd}, {".mha", FileKind::meta},
        {".mhd", FileKind::meta},  {".mgh", FileKind::mgh},   {".mgz", FileKind::mgh},
        {".nii", FileKind::nifti}, {".tif", FileKind::tiff},  {".tiff", FileKind::tiff},
        {".png", FileKind::png},   {".dcm", FileKind::dicom}, {".dicom", FileKind::dicom}};
    const std::string name = toLower(path.filename().string());
    if (name.ends_with(".nii.gz")) return FileKind::nifti;
    const auto found = kinds.find(toLower(path.extension().string()));
    return found == kinds.end() ? FileKind::none : found->second;
}

FileKind kindOf(const fs::path& path) {
    const FileKind kind = kindByName(path);
    if (kind != FileKind::none && !isHeaderFormat(kind)) return kind;
    const FileKind found = kindByContent(path);
    const bool wins = kind == FileKind::none || isHeaderFormat(found) || found == FileKind::dicom;
    return wins && found != FileKind::none ? found : kind;
}

}  // namespace isowave::imageio
