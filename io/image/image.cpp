#include "isowave/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include "isowave/error.h"
#include "io/image/kind.h"
#include "io/image/source.h"

namespace isowave {
namespace fs = std::filesystem;
using namespace imageio;

std::array<double, 3> Image::spacing() const {
    std::array<double, 3> result;
    for (int a = 0; a < 3; ++a) {
        const openvdb::Vec4d row = indexToWorld.row(a);
        result[a] = openvdb::Vec3d(row[0], row[1], row[2]).length();
    }
    return result;
}

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

// Slices lie in the folder itself; DICOM, which names its series, may lie in folders below.
SourcePtr openFolder(const fs::path& folder, const ImageReadOptions& options) {
    auto files = filesByKind(fs::directory_iterator(folder));
    const std::size_t png = files[FileKind::png].size(), tiff = files[FileKind::tiff].size();
    if (files[FileKind::dicom].empty() && png == 0 && tiff == 0)
        files = filesByKind(fs::recursive_directory_iterator(folder));
    if (!files[FileKind::dicom].empty()) return openDicomFolder(folder, files[FileKind::dicom], options);
    if (png > 0 && tiff > 0)
        throw InputError(folder.string(),
                         fmt::format("holds {} PNG and {} TIFF slices; expected one kind", png, tiff));
    if (png + tiff == 0) throw InputError(folder.string(), "is a folder without DICOM, TIFF or PNG slices");
    return openSliceFiles(folder, png > 0 ? files[FileKind::png] : files[FileKind::tiff], options);
}

SourcePtr openFile(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    if (fs::file_size(path) == 0) throw InputError(name, "is empty; expected an image");
    if (!std::ifstream(path)) throw InputError(name, "cannot be opened; check its permissions");
    if (options.raw) return openRaw(path, options);
    const FileKind kind = kindOf(path);
    if (kind == FileKind::none)
        throw InputError(
            name,
            "is of no known image format (NIfTI, NRRD, MetaImage, TIFF, PNG, DICOM); for headerless "
            "voxels give their size and type");
    return kind == FileKind::dicom ? openDicomFile(path, options) : openVolumeFile(path, options);
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

}  // namespace

SourcePtr imageio::openSource(const fs::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(name, "no such file or folder");
    const bool folder = fs::is_directory(status);
    if (!folder && !fs::is_regular_file(status)) throw InputError(name, "is neither a file nor a folder");
    if (folder && options.raw)
        throw InputError(name,
                         "is a folder; size and type describe one headerless file; give that file, or leave "
                         "them out for a folder of slices");
    try {
        SourcePtr source = folder ? openFolder(path, options) : openFile(path, options);
        settleGeometry(name, source->header, options);
        checkAxes(name, source->header);
        return source;
    } catch (const fs::filesystem_error& e) {
        throw InputError(name, "cannot be read: " + oneLine(e.code().message()));
    }
}

Image imageio::imageOf(const Header& header) {
    Image image;
    image.size = header.size;
    for (int a = 0; a < 3; ++a) {
        const openvdb::Vec3d step = header.axis[a] * header.spacing[a] + openvdb::Vec3d(0);  // -0 + 0 = 0
        image.indexToWorld.setRow(a, openvdb::Vec4d(step[0], step[1], step[2], 0));
    }
    image.indexToWorld.setRow(3, openvdb::Vec4d(header.origin[0], header.origin[1], header.origin[2], 1));
    const ValueType stored = header.storedType.value_or(header.type);
    image.componentType = nameOf(stored);
    image.integral = header.integral.value_or(isIntegral(stored));
    image.slope = header.slope;
    image.intercept = header.intercept;
    image.format = header.format;
    image.warnings = header.warnings;
    return image;
}

namespace {

// Adds the files of `folder` that a pattern such as "slice%03d.raw 1 90 1" fits: what stands before and after its %.
void addFitting(const fs::path& folder, const std::string& pattern, std::vector<fs::path>& files) {
    const std::size_t percent = pattern.find('%');
    const fs::path before = folder / pattern.substr(0, percent);
    const std::size_t after = pattern.find_first_of("diu", percent), blank = pattern.find(' ', percent);
    const std::string tail =
        after == std::string::npos || blank <= after ? "" : pattern.substr(after + 1, blank - after - 1);
    std::error_code ignored;
    for (auto entry =
             fs::directory_iterator(before.parent_path().empty() ? "." : before.parent_path(), ignored);
         entry != fs::directory_iterator(); entry.increment(ignored)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with(before.filename().string()) && name.ends_with(tail))
            files.push_back(entry->path());
    }
}

}  // namespace

Image readImageHeader(const fs::path& path, const ImageReadOptions& options) {
    return imageOf(openSource(path, options)->header);
}

Image readImage(const fs::path& path, const ImageReadOptions& options, const Progress& progress) {
    const SourcePtr source = openSource(path, options);
    const std::size_t stored = sizeOf(source->header.type);
    checkMemory(path.string(), *source, options, sizeof(float), stored);
    Image image = imageOf(source->header);
    image.values.resize(static_cast<std::size_t>(image.voxelCount()));

    std::int64_t inexact = 0;
    for (std::int64_t z = 0, end; z < image.size[2]; z = end) {
        progress("reading", static_cast<double>(z) / static_cast<double>(image.size[2]));
        end = std::min(z + source->slicesPerRead, image.size[2]);
        inexact += source->read(z, end, image.values.data() + z * source->header.sliceVoxels());
    }
    NotFinite notFinite;
    notFinite.look(image.values.data(), image.voxelCount(), 0);
    checkFinite(path.string(), image.size, notFinite);
    if (inexact > 0) image.warnings.push_back(roundedText(inexact, image));
    progress("reading", 1);
    return image;
}

std::vector<fs::path> voxelFilesOf(const fs::path& path) {
    std::vector<std::string> names;
    try {
        const FileKind kind = kindByName(path);
        if (kind == FileKind::nrrd) names = nrrdVoxelFiles(path);
        if (kind == FileKind::meta) names = metaVoxelFiles(path);
    } catch (const InputError&) {
        return {};  // said when it is read
    }
    std::vector<fs::path> files;
    for (const std::string& name : names) {
        if (name.find('%') == std::string::npos)
            files.push_back(path.parent_path() / name);
        else
            addFitting(path.parent_path(), name, files);
    }
    return files;
}

bool isImagePath(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) return true;
    if (kindByName(path) != FileKind::none) return true;
    return fs::is_regular_file(path, error) && kindOf(path) != FileKind::none;
}

}  // namespace isowave
