#include "isowave/image.h"

#include <algorithm>

#include "io/image/check.h"
#include "io/image/kind.h"
#include "io/image/metaimage.h"
#include "io/image/nrrd.h"
#include "io/image/open_source.h"
#include "isowave/error.h"

namespace isowave {
namespace fs = std::filesystem;
using namespace imageio;

std::array<double, 3> Image::spacing() const {
    std::array<double, 3> result;
    for (int a = 0; a < 3; ++a) {
        const auto& [x, y, z] = indexToWorld.axis[a];
        result[a] = length(Vec3{x, y, z});
    }
    return result;
}

namespace {

// Adds the files of `folder` that a pattern such as "slice%03d.raw 1 90 1" fits: what stands before and after
// its %.
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
    notFinite.countIn(image.values.data(), image.voxelCount(), 0);
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
