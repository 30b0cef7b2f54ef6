#include "io/image/slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>

#include "base/read_file.h"
#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/kind.h"
#include "io/image/tiff/stack.h"
#include "io/picture/bmp.h"
#include "io/picture/jpeg.h"
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
    std::string palette = {};         // of a PNG of labels
};

[[noreturn]] void throwColours(const fs::path& path, int channels) {
    throwNotScalar(path, channels == 3 ? "RGB" : channels == 4 ? "RGBA" : "grey and opacity", channels);
}

Header headerOf(const Picture& picture) {
    Header header;
    header.type = picture.type;
    header.size = {picture.width, picture.height, 1};
    header.space = Space::unspecified;
    if (picture.pixelSize) header.spacing = {(*picture.pixelSize)[0], (*picture.pixelSize)[1], 1};
    return header;
}

Slice openPngSlice(const fs::path& path) {
    const auto bytes = std::make_shared<const std::string>(readFile(path, "a slice"));
    const Picture header = readPngNumbersHeader(*bytes, path.string());
    if (header.channels != 1) throwColours(path, header.channels);
    return {"PNG", headerOf(header),
            [bytes, path](void* out) {
                const Picture picture = readPngNumbers(*bytes, path.string());
                std::memcpy(out, picture.samples.data(), picture.samples.size());
            },
            header.palette};
}

// Grey values of a picture of colours that are none: red, green and blue differ by no more than `most`.
Picture greyOf(const Picture& picture, const fs::path& path, int most) {
    if (picture.channels == 1) return picture;
    Picture grey = picture;
    grey.channels = 1;
    grey.isColour = grey.hasOpacity = false;
    grey.samples.resize(static_cast<std::size_t>(picture.width * picture.height));
    const auto colours = picture.as<std::uint8_t>();
    const auto channels = static_cast<std::size_t>(picture.channels);
    for (std::size_t k = 0; k < grey.samples.size(); ++k) {
        const auto rgb = colours.subspan(k * channels, 3);
        const auto [least, greatest] = std::minmax({rgb[0], rgb[1], rgb[2]});
        if (greatest - least > most) throwColours(path, 3);
        grey.samples[k] = std::byte(std::lround(0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]));
    }
    return grey;
}

// BMP and JPEG are read whole: what they hold is known then.
Slice openWholeSlice(const fs::path& path, FileKind kind) {
    constexpr int kGreyOfJpeg = 8;  // of 255: colour differences are rounded on their own
    const std::string bytes = readFile(path, "a slice"), name = path.string();
    const auto picture = std::make_shared<const Picture>(
        kind == FileKind::bmp ? greyOf(readBmp(bytes, name), path, 0)
                              : greyOf(readJpeg(bytes, name), path, kGreyOfJpeg));
    return {kind == FileKind::bmp ? "BMP" : "JPEG", headerOf(*picture),
            [picture](void* out) { std::memcpy(out, picture->samples.data(), picture->samples.size()); }};
}

Slice openTiffSlice(const fs::path& path, const ImageReadOptions& options) {
    const std::shared_ptr<VoxelSource> stack = openTiffStack(path, options);
    return {"TIFF", stack->header, [stack](void* out) { stack->readNative(0, 1, out); }};
}

Slice openSlice(const fs::path& path, const ImageReadOptions& options) {
    if (fs::file_size(path) == 0) throw InputError(path.string(), "is empty; expected a slice");
    const FileKind kind = kindOf(path);
    if (kind == FileKind::bmp || kind == FileKind::jpeg) return openWholeSlice(path, kind);
    return kind == FileKind::png ? openPngSlice(path) : openTiffSlice(path, options);
}

class SlicesSource : public VoxelSource {
  public:
    // palette: of the first one.
    SlicesSource(std::vector<fs::path> slices, std::string palette, const ImageReadOptions& options)
        : slices_(std::move(slices)), palette_(std::move(palette)), options_(options) {
        native = true;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* bytes = static_cast<char*>(out);
        for (std::int64_t z = z0; z < z1; ++z) {
            const fs::path& path = slices_[static_cast<std::size_t>(z)];
            const Slice slice = openSlice(path, options_);
            requireLikeFirst(path, slice);
            slice.read(bytes);
            bytes += static_cast<std::size_t>(header.sliceVoxels()) * sizeOf(header.type);
        }
    }

  private:
    void requireLikeFirst(const fs::path& path, const Slice& opened) const {
        const Header& slice = opened.header;
        // A writer that lists only the colours in use, in their order, has another label in every place from slice to slice.
        const std::size_t common = std::min(opened.palette.size(), palette_.size());
        if (opened.palette.empty() != palette_.empty() ||
            opened.palette.compare(0, common, palette_, 0, common) != 0)
            throw InputError(
                path.string(),
                fmt::format(
                    "has another palette than the first slice, {}, so that its numbers are other labels; "
                    "expected one palette in all of them",
                    slices_[0].filename().string()));
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
    std::string palette_;
    ImageReadOptions options_;
};

// Pictures, but for some TIFF, say at most how large a pixel is; a voxel is taken to be as high as it is wide.
void assumeHeight(Header& header) {
    header.hasZSpacing = false;
    header.spacing[2] = header.spacing[0];
}

}  // namespace

// The numbers by which slices follow each other: the last one in the names that is not the same in all of them, as "IM0012_a.png"
// has 12. Nothing where a name has none.
std::vector<std::int64_t> numbersOf(const std::vector<fs::path>& slices) {
    std::vector<std::vector<std::int64_t>> runs;
    for (const fs::path& slice : slices) {
        std::vector<std::int64_t>& found = runs.emplace_back();
        const std::string name = slice.stem().string();
        for (std::size_t at = 0; (at = name.find_first_of("0123456789", at)) != std::string::npos;) {
            const std::size_t end = std::min(name.find_first_not_of("0123456789", at), name.size());
            if (end - at > 15) return {};
            found.push_back(std::stoll(name.substr(at, end - at)));
            at = end;
        }
        if (found.size() != runs.front().size()) return {};
    }
    for (std::size_t k = runs.front().size(); k-- > 0;) {
        const bool same =
            std::all_of(runs.begin(), runs.end(), [&](const auto& r) { return r[k] == runs[0][k]; });
        if (same) continue;
        std::vector<std::int64_t> numbers;
        for (const auto& run : runs) numbers.push_back(run[k]);
        return numbers;
    }
    return {};
}

// Slices that are numbered in even steps but for some that are not there are stacked as if nothing were missing.
std::optional<std::string> gapAmong(const std::vector<fs::path>& slices) {
    const std::vector<std::int64_t> numbers = numbersOf(slices);
    std::map<std::int64_t, std::size_t> steps;  // how often
    for (std::size_t k = 1; k < numbers.size(); ++k) ++steps[numbers[k] - numbers[k - 1]];
    if (steps.size() < 2 || steps.begin()->first < 1) return std::nullopt;
    const auto usual = std::max_element(steps.begin(), steps.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    // Names that say something else than an order have many steps.
    if (2 * usual->second < numbers.size() || steps.begin()->first < usual->first) return std::nullopt;
    std::size_t k = 1;
    while (numbers[k] - numbers[k - 1] == usual->first) ++k;
    return fmt::format(
        "numbers jump from {} to {} where they go up by {} otherwise: slices may be missing, and the "
        "others are stacked as if they were not",
        slices[k - 1].filename().string(), slices[k].filename().string(), usual->first);
}

SourcePtr openPictureFile(const fs::path& path, const ImageReadOptions& options) {
    if (kindOf(path) != FileKind::tiff) {
        const Header flat = openSlice(path, options).header;
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
    auto source = std::make_unique<SlicesSource>(slices, first.palette, options);
    source->header = first.header;
    source->header.format = first.format + " slices";
    source->header.size[2] = static_cast<std::int64_t>(slices.size());
    if (first.format != "TIFF" || !first.header.hasZSpacing) assumeHeight(source->header);
    if (const auto gap = gapAmong(slices)) source->header.warnings.push_back(*gap);
    if (first.format == "JPEG")
        source->header.warnings.emplace_back(
            "JPEG is lossy: edges have ripples of some grey values; take the slices as they were before, if "
            "there are any");
    return source;
}

}  // namespace isowave::imageio
