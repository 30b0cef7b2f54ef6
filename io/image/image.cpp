#include "isowave/image.h"

#include <algorithm>

#include "io/image/check.h"
#include "io/image/formats/metaimage.h"
#include "io/image/formats/nifti.h"
#include "io/image/formats/nrrd.h"
#include "io/image/kind.h"
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
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return {};  // a pipe would be waited for
    try {
        const FileKind kind = kindOf(path);
        if (kind == FileKind::nrrd) names = nrrdVoxelFiles(path);
        if (kind == FileKind::meta) names = metaVoxelFiles(path);
        if (kind == FileKind::nifti) names = niftiVoxelFiles(path);
    } catch (const InputError&) {
        return {};  // said when it is read
    }
    std::vector<fs::path> files;
    for (const std::string& name : names) files.push_back(path.parent_path() / name);
    return files;
}

bool isImagePath(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) return true;
    if (kindByName(path) != FileKind::none) return true;
    return fs::is_regular_file(path, error) && kindOf(path) != FileKind::none;
}

}  // namespace isowave
