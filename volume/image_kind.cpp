#include "volume/image_kind.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <string>

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

FileKind kindByContent(const fs::path& path) {
    char start[132] = {};
    std::ifstream(path, std::ios::binary).read(start, sizeof start);
    const std::string text(start, sizeof start);
    if (text.compare(128, 4, "DICM") == 0) return FileKind::dicom;
    if (text.compare(0, 4, "NRRD") == 0) return FileKind::nrrd;
    if (text.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0) return FileKind::png;
    if (text.compare(0, 4, std::string("II*\0", 4)) == 0 || text.compare(0, 4, std::string("MM\0*", 4)) == 0)
        return FileKind::tiff;
    return FileKind::none;
}

}  // namespace

FileKind kindByName(const fs::path& path) {
    static const std::map<std::string, FileKind> kinds = {
        {".nrrd", FileKind::nrrd},  {".nhdr", FileKind::nrrd}, {".mha", FileKind::meta},
        {".mhd", FileKind::meta},   {".nii", FileKind::nifti}, {".tif", FileKind::tiff},
        {".tiff", FileKind::tiff},  {".png", FileKind::png},   {".dcm", FileKind::dicom},
        {".dicom", FileKind::dicom}};
    const std::string name = lower(path.filename().string());
    if (name.ends_with(".nii.gz")) return FileKind::nifti;
    const auto found = kinds.find(lower(path.extension().string()));
    return found == kinds.end() ? FileKind::none : found->second;
}

FileKind kindOf(const fs::path& path) {
    const FileKind kind = kindByName(path);
    return kind == FileKind::none ? kindByContent(path) : kind;
}

}  // namespace isowave::imageio
