#include "tests/fuzz/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/image/stream.h"
#include "isowave/image.h"

namespace isowave::fuzz {
namespace {

constexpr std::int64_t kMemory = std::int64_t(64) << 20;

struct Format {
    const char* name;
    const char* file;
    // What chooses the first of several volumes.
    void (*chooseFirst)(ImageReadOptions&);
};
constexpr auto kVolume = [](ImageReadOptions& o) { o.volume = 1; };
constexpr auto kFrames = [](ImageReadOptions& o) { o.stack = o.time = 1; };
constexpr Format kFormats[] = {
    {"nifti", "image.nii", kVolume},
    {"nrrd", "image.nrrd", kVolume},
    {"metaimage", "image.mha", kVolume},
    {"mgh", "image.mgh", kVolume},
    {"mrc", "image.mrc", kVolume},
    {"npy-volume", "image.npy", kVolume},
    {"vti", "image.vti", kVolume},
    {"tiff", "image.tif", [](ImageReadOptions& o) { o.channel = o.time = 1; }},
    {"dicom", "image.dcm", kFrames},
    {"dicom-compressed", "image.dcm", kFrames},
};

void check(const Image& image) {
    require(image.voxelCount() == static_cast<std::int64_t>(image.values.size()), "voxels are missing");
    for (const float value : image.values) require(std::isfinite(value), "a voxel that is not finite");
    for (int a = 0; a < 3; ++a) {
        require(image.size[a] > 0, "a size that is not positive");
        require(std::isfinite(image.indexToWorld.origin[a]), "an origin that is not finite");
        for (const double x : image.indexToWorld.axis[a])
            require(std::isfinite(x), "an axis that is not finite");
        require(image.spacing()[a] > 0, "a spacing that is not positive");
    }
    for (const std::string& warning : image.warnings) requireOneLine(warning);
}

// Both ways to read give the same.
void checkSlices(const std::filesystem::path& path, const ImageReadOptions& options, const Image& whole) {
    ImageStream stream(path, options, 1);
    const std::int64_t slice = whole.size[0] * whole.size[1];
    stream.pass("reading", {}, [&](const Slab& slab) {
        const float* expected = whole.values.data() + slab.z0 * slice;
        std::visit(
            [&](const auto& voxels) {
                require(voxels.size() == static_cast<std::size_t>((slab.z1 - slab.z0) * slice),
                        "a slab of another size");
                for (std::size_t i = 0; i < voxels.size(); ++i)
                    require(static_cast<float>(voxels[i]) == expected[i],
                            "a voxel differs between the image as a whole and its slabs");
            },
            slab.voxels);
    });
}

// A transfer syntax (PS3.5 section 10) whose pixels GDCM decodes.
bool isCompressedDicom(std::string_view bytes) {
    for (const char* syntax : {"1.2.840.10008.1.2.4", "1.2.840.10008.1.2.5"})
        if (bytes.find(syntax) != bytes.npos) return true;
    return false;
}

Answer read(std::string_view bytes, const Format& format) {
    if (format.name == std::string_view("dicom") && isCompressedDicom(bytes)) return Answer::refused;
    const auto path = fileOf(bytes, format.file);
    ImageReadOptions options = imageOptions();
    voxelFilesOf(path);
    if (answerOf(path.string(), [&] { readBothWays(path, options); }) == Answer::read) return Answer::read;
    format.chooseFirst(options);
    options.nan = 0.0f;
    options.resampleSlices = std::string_view(format.name).starts_with("dicom");
    return answerOf(path.string(), [&] { readBothWays(path, options); });
}

}  // namespace

ImageReadOptions imageOptions() {
    ImageReadOptions options;
    options.memoryLimit = kMemory;
    return options;
}

void readBothWays(const std::filesystem::path& path, const ImageReadOptions& options) {
    const Image image = readImage(path, options);
    check(image);
    checkSlices(path, options, image);
}

std::vector<Target> imageTargets() {
    std::vector<Target> targets;
    for (const Format& format : kFormats)
        targets.push_back({format.name, [&format](std::string_view bytes) { return read(bytes, format); }});
    return targets;
}

}  // namespace isowave::fuzz
