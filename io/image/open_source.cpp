#include "io/image/open_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include "io/image/check.h"
#include "io/image/dicom/open.h"
#include "io/image/fill_nan.h"
#include "io/image/formats/foreign.h"
#include "io/image/formats/metaimage.h"
#include "io/image/formats/mgh.h"
#include "io/image/formats/mrc.h"
#include "io/image/formats/nifti.h"
#include "io/image/formats/npy_volume.h"
#include "io/image/formats/nrrd.h"
#include "io/image/formats/vti.h"
#include "io/image/header.h"
#include "io/image/kind.h"
#include "io/image/plain.h"
#include "io/image/slices.h"
#include "io/image/zarr/multiscale.h"
#include "io/image/zarr/open.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;

namespace {

// "slice_2" before "slice_10": runs of digits compare as numbers; ties (01, 1) by the plain text.
bool naturalLess(const fs::path& a, const fs::path& b) {
    const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    const std::string s = a.filename().string(), t = b.filename().string();
    std::size_t i = 0, j = 0;
    while (i < s.size() && j < t.size()) {
        if (digit(s[i]) && digit(t[j])) {
            while (i < s.size() && s[i] == '0') ++i;
            while (j < t.size() && t[j] == '0') ++j;
            std::size_t m = i, n = j;
            while (m < s.size() && digit(s[m])) ++m;
            while (n < t.size() && digit(t[n])) ++n;
            if (m - i != n - j) return m - i < n - j;
            if (const int order = s.compare(i, m - i, t, j, n - j); order != 0) return order < 0;
            i = m;
            j = n;
        } else if (s[i] != t[j]) {
            return s[i] < t[j];
        } else {
            ++i;
            ++j;
        }
    }
    if (s.size() - i != t.size() - j) return s.size() - i < t.size() - j;
    return a < b;
}

template <class Iterator>
std::map<FileKind, std::vector<fs::path>> filesByKind(Iterator files) {
    std::map<FileKind, std::vector<fs::path>> result;
    for (const fs::directory_entry& entry : files) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_regular_file() || name.starts_with('.') || name == "DICOMDIR") continue;
        result[kindOf(entry.path())].push_back(entry.path());
    }
    for (auto& [kind, paths] : result) std::sort(paths.begin(), paths.end(), naturalLess);
    return result;
}

std::string_view nameOf(FileKind kind) {
    const auto is = [kind](const ImageFormat& format) { return format.kind == kind; };
    return std::find_if(imageFormats().begin(), imageFormats().end(), is)->name;
}

// Those of the one kind that is there; null where there is none. Beside TIFF and PNG there may be a BMP or JPEG: scanners put a preview
// there.
const std::vector<fs::path>* slicesAmong(const fs::path& folder,
                                         const std::map<FileKind, std::vector<fs::path>>& files) {
    for (const auto& [kind, other] :
         {std::pair{FileKind::tiff, FileKind::png}, {FileKind::bmp, FileKind::jpeg}}) {
        const auto these = files.find(kind), others = files.find(other);
        if (these != files.end() && others != files.end())
            throw InputError(folder.string(), fmt::format("holds {} {} and {} {} slices; expected one kind",
                                                          others->second.size(), nameOf(other),
                                                          these->second.size(), nameOf(kind)));
        if (these != files.end()) return &these->second;
        if (others != files.end()) return &others->second;
    }
    return nullptr;
}

// Files lie in the folder itself, or, where none does, in folders below.
SourcePtr openFolder(const fs::path& folder, const ImageReadOptions& options) {
    if (isZarr(folder)) return openZarr(folder, options);
    const auto here = filesByKind(fs::directory_iterator(folder));
    if (const auto dicom = here.find(FileKind::dicom); dicom != here.end())
        return openDicomFolder(folder, dicom->second, options);
    if (const std::vector<fs::path>* slices = slicesAmong(folder, here))
        return openSliceFiles(folder, *slices, options);
    const auto below = filesByKind(fs::recursive_directory_iterator(folder));
    if (const auto dicom = below.find(FileKind::dicom); dicom != below.end())
        return openDicomFolder(folder, dicom->second, options);
    if (const std::vector<fs::path>* slices = slicesAmong(folder, below))
        return openSliceFiles(folder, *slices, options);
    throw InputError(folder.string(), foreignText(folder).value_or(
                                          "is a folder without DICOM, TIFF, PNG, BMP or JPEG slices"));
}

SourcePtr openFile(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    if (fs::file_size(path) == 0) throw InputError(name, "is empty; expected an image");
    if (!std::ifstream(path)) throw InputError(name, "cannot be opened; check its permissions");
    if (options.raw) return openRaw(path, options);
    checkGzipStart(path);
    const FileKind kind = kindOf(path);
    if (kind == FileKind::nifti) return openStored(path, readNiftiHeader(path), options);
    if (kind == FileKind::mgh) return openStored(path, readMghHeader(path), options);
    if (kind == FileKind::nrrd) return openStored(path, readNrrdHeader(path), options);
    if (kind == FileKind::meta) return openStored(path, readMetaHeader(path), options);
    if (kind == FileKind::mrc) return openMrc(path, options);
    if (kind == FileKind::npy) return openNpyVolume(path, options);
    if (kind == FileKind::vti) return openVti(path, options);
    if (kind == FileKind::zarr)
        throw InputError(name, "is a file; a Zarr store is a folder; unzip it, if it is one in a file");
    if (kind == FileKind::none)
        throw InputError(name,
                         foreignText(path).value_or("is of no known image format (" + imageFormatNames() +
                                                    "); for headerless voxels give their size and type"));
    return kind == FileKind::dicom ? openDicomFile(path, options) : openPictureFile(path, options);
}

// Lattice points are numbered with 32 bits an axis, with room for a border and for the dilation of I.
void checkAxes(const std::string& name, const Header& header) {
    constexpr std::int64_t kMostOnAxis = (std::int64_t(1) << 31) - 1024;
    for (const std::int64_t n : header.size)
        if (n > kMostOnAxis)
            throw InputError(name, fmt::format("its size is {}; at most {} voxels along an axis are handled; "
                                               "crop or downsample it",
                                               sizeText(header.size), kMostOnAxis));
}

std::vector<std::string> formatsOfVolumes() {
    std::vector<std::string> names;
    for (const ImageFormat& format : imageFormats())
        if (format.volumes) names.emplace_back(format.name);
    return names;
}

// Readers do not look at options that choose among what their format cannot hold.
void refuseForeignOptions(const std::string& name, const Header& header, const ImageReadOptions& options) {
    struct Choice {
        const char* option;
        bool given;
        std::vector<std::string> formats;  // Header::format begins with one of these
    };
    const Choice choices[] = {
        {"--volume", options.volume.has_value(), formatsOfVolumes()},
        {"--series", options.series.has_value(), {"DICOM"}},
        {"--stack", options.stack.has_value(), {"DICOM"}},
        {"--time", options.time.has_value(), {"DICOM", "TIFF", "OME-Zarr", "Zarr"}},
        {"--channel", options.channel.has_value(), {"TIFF", "OME-Zarr", "Zarr"}},
        {"--resample-slices", options.resampleSlices, {"DICOM"}},
    };
    for (const Choice& choice : choices) {
        const auto fits = [&](const std::string& format) { return header.format.starts_with(format); };
        if (choice.given && std::none_of(choice.formats.begin(), choice.formats.end(), fits))
            throw UsageError(fmt::format("{} is for {}; {} is {}; leave it out", choice.option,
                                         fmt::join(choice.formats, ", "), name, header.format));
    }
}

}  // namespace

SourcePtr openSource(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status))
        throw InputError(name, status.type() == fs::file_type::none
                                   ? "cannot be looked at (" + error.message() + ")"
                                   : "no such file or folder");
    const bool folder = fs::is_directory(status);
    if (!folder && !fs::is_regular_file(status)) throw InputError(name, "is neither a file nor a folder");
    if (folder && options.raw)
        throw InputError(name,
                         "is a folder; size and type describe one headerless file; give that file, or leave "
                         "them out for a folder of slices");
    try {
        SourcePtr source = folder ? openFolder(path, options) : openFile(path, options);
        refuseForeignOptions(name, source->header, options);
        settleGeometry(name, source->header, options);
        checkAxes(name, source->header);
        return options.nan ? fillNan(std::move(source), *options.nan) : std::move(source);
    } catch (const fs::filesystem_error& e) {
        throw InputError(name, "cannot be read: " + oneLine(e.code().message()));
    }
}

}  // namespace isowave::imageio
