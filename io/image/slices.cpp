#include "io/image/slices.h"

#include <fmt/format.h>

#include <cstring>
#include <functional>

#include "base/read_file.h"
#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/kind.h"
#include "io/image/tiff/stack.h"
#include "io/picture/png.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr const char* kGiveFolder = "; give the folder of its slices";

// A file that is one slice, or a TIFF of several pages.
struct Slice {
    std::string format;
    Header header;
    std::function<void(void*)> read;  // its voxels
};

// What the bytes of a PNG say of its one slice.
Header pngHeader(const fs::path& path, const Picture& picture) {
    if (picture.channels != 1)
        throwNotScalar(path,
                       picture.channels == 3   ? "RGB"
                       : picture.channels == 4 ? "RGBA"
                                               : "scalar",
                       picture.channels);
    Header header;
    header.type = picture.type;
    header.size = {picture.width, picture.height, 1};
    header.space = Space::unspecified;
    if (picture.pixelSize) header.spacing = {(*picture.pixelSize)[0], (*picture.pixelSize)[1], 1};
    return header;
}

Slice openPngSlice(const fs::path& path) {
    const auto bytes = std::make_shared<const std::string>(readFile(path, "a slice"));
    return {"PNG", pngHeader(path, readPngHeader(*bytes, path.string())), [bytes, path](void* out) {
                const Picture picture = readPng(*bytes, path.string());
                std::memcpy(out, picture.samples.data(), picture.samples.size());
            }};
}

Slice openTiffSlice(const fs::path& path, const ImageReadOptions& options) {
    const std::shared_ptr<VoxelSource> stack = openTiffStack(path, options);
    return {"TIFF", stack->header, [stack](void* out) { stack->readNative(0, 1, out); }};
}

Slice openSlice(const fs::path& path, const ImageReadOptions& options) {
    if (fs::file_size(path) == 0) throw InputError(path.string(), "is empty; expected a slice");
    return kindOf(path) == FileKind::png ? openPngSlice(path) : openTiffSlice(path, options);
}

class SlicesSource : public VoxelSource {
  public:
    SlicesSource(std::vector<fs::path> slices, const ImageReadOptions& options)
        : slices_(std::move(slices)), options_(options) {
        native = true;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* bytes = static_cast<char*>(out);
        for (std::int64_t z = z0; z < z1; ++z) {
            const fs::path& path = slices_[static_cast<std::size_t>(z)];
            const Slice slice = openSlice(path, options_);
            requireLikeFirst(path, slice.header);
            slice.read(bytes);
            bytes += static_cast<std::size_t>(header.sliceVoxels()) * sizeOf(header.type);
        }
    }

  private:
    void requireLikeFirst(const fs::path& path, const Header& slice) const {
        if (slice.size[0] != header.size[0] || slice.size[1] != header.size[1] || slice.size[2] != 1)
            throw InputError(path.string(), fmt::format("is a slice of {} but the first, {}, is {} x {} x 1",
                                                        sizeText(slice.size), slices_[0].filename().string(),
                                                        header.size[0], header.size[1]));
        if (slice.type != header.type)
            throw InputError(path.string(), fmt::format("is a slice of {} voxels but the first, {}, holds {}",
                                                        nameOf(slice.type), slices_[0].filename().string(),
                                                        nameOf(header.type)));
    }

    std::vector<fs::path> slices_;
    ImageReadOptions options_;
};

// PNG and most TIFF slices say at most how large a pixel is; a voxel is taken to be as high as it is wide.
void assumeHeight(Header& header) {
    header.hasZSpacing = false;
    header.spacing[2] = header.spacing[0];
}

}  // namespace

SourcePtr openPictureFile(const fs::path& path, const ImageReadOptions& options) {
    if (kindOf(path) == FileKind::png) {
        const Header flat = openPngSlice(path).header;
        throwFlat(path, flat.size[0], flat.size[1], kGiveFolder);
    }
    SourcePtr stack = openTiffStack(path, options);
    if (stack->header.size[2] == 1)
        throwFlat(path, stack->header.size[0], stack->header.size[1], kGiveFolder);
    return stack;
}

SourcePtr openSliceFiles(const fs::path& folder, const std::vector<fs::path>& slices,
                         const ImageReadOptions& options) {
    const Slice first = openSlice(slices.front(), options);
    if (first.header.size[2] > 1) {  // pages
        if (slices.size() == 1) return openPictureFile(slices.front(), options);
        throw InputError(folder.string(),
                         fmt::format("holds {} TIFF files of several pages; expected slices; give one "
                                     "of the files",
                                     slices.size()));
    }
    auto source = std::make_unique<SlicesSource>(slices, options);
    source->header = first.header;
    source->header.format = first.format + " slices";
    source->header.size[2] = static_cast<std::int64_t>(slices.size());
    if (first.format == "PNG" || !first.header.hasZSpacing) assumeHeight(source->header);
    return source;
}

}  // namespace isowave::imageio
