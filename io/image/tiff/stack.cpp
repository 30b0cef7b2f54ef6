#include "io/image/tiff/stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/file_bytes.h"
#include "base/number_text.h"
#include "io/image/check.h"
#include "io/image/plain.h"
#include "io/image/tiff/planes.h"
#include "io/image/tiff/tables.h"
#include "io/picture/tiff.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr int kRgb = 2, kMinIsWhite = 0;  // PHOTOMETRIC_* of libtiff

std::string sizeOfPage(const TiffPage& page) { return fmt::format("{} x {}", page.width, page.height); }

std::string kindOfPage(const TiffPage& page) {
    return page.type ? nameOf(*page.type) : fmt::format("{}-bit", page.bits);
}

// REQUIRES: pages and planes of one file; only the pages of the chosen planes count.
void requireAlike(const std::string& file, const std::vector<TiffPage>& pages,
                  const std::vector<std::int64_t>& chosen) {
    const TiffPage& first = pages[static_cast<std::size_t>(chosen.front())];
    for (const std::int64_t k : chosen) {
        const TiffPage& page = pages[static_cast<std::size_t>(k)];
        if (page.width != first.width || page.height != first.height)
            throw InputError(
                file, fmt::format("its page {} is {} pixels but page {} is {}; expected pages of one size; "
                                  "save the slices without the others",
                                  k + 1, sizeOfPage(page), chosen.front() + 1, sizeOfPage(first)));
        if (page.type != first.type || page.samples != first.samples || page.bits != first.bits)
            throw InputError(
                file,
                fmt::format("its page {} holds {} of {}, {} a sample, but page {} {} of {}, {} a sample; "
                            "expected pages of one type",
                            k + 1, kindOfPage(page), counted(page.samples, "sample"),
                            counted(page.bits, "bit"), chosen.front() + 1, kindOfPage(first),
                            counted(first.samples, "sample"), counted(first.bits, "bit")));
    }
}

void requireNumbers(const std::string& file, const TiffPage& page) {
    if (page.samples > 1) {
        const char* kind = page.photometric == kRgb ? (page.samples == 3 ? "RGB" : "RGBA")
                           : page.samples == 2      ? "grey and opacity"
                                                    : "vector";
        throw InputError(file,
                         fmt::format("holds {} voxels of {} numbers; expected one number a voxel; convert it "
                                     "to grey",
                                     kind, page.samples));
    }
    if (page.depth > 1)
        throw InputError(
            file, fmt::format("holds {} slices in one page (ImageDepth), which are not read; save them as "
                              "pages, or as OME-TIFF",
                              page.depth));
    if (!page.type)
        throw InputError(
            file, fmt::format("holds samples of {} bits; expected integers of 1, 2, 4, 8, 16, 32 or 64 "
                              "bits, or floats of 16, 32 or 64",
                              page.bits));
}

std::string listOfChannels(const TiffPlanes& planes) {
    std::string text;
    for (std::size_t c = 0; c < planes.channelNames.size(); ++c)
        text += fmt::format("{}{} '{}'", c ? ", " : " (", c + 1, planes.channelNames[c]);
    return text.empty() ? text : text + ")";
}

// The number, counted from 0, of one of `count`.
std::int64_t chosen(const std::string& file, const char* what, std::int64_t count,
                    const std::optional<std::int64_t>& wanted) {
    const std::int64_t number = wanted.value_or(1);
    if (number >= 1 && number <= count) return number - 1;
    throw InputError(file, fmt::format("has no {} {}; it holds {} of them", what, number, count));
}

void requireChoice(const std::string& file, const TiffPlanes& planes, const ImageReadOptions& options) {
    const bool channel = planes.channels > 1 && !options.channel, time = planes.times > 1 && !options.time;
    if (!channel && !time) return;
    std::string message = "holds ";
    if (planes.channels > 1) message += fmt::format("{} channels{}", planes.channels, listOfChannels(planes));
    if (planes.channels > 1 && planes.times > 1) message += " and ";
    if (planes.times > 1) message += fmt::format("{} times", planes.times);
    message += fmt::format(" of {} slices; choose one with", planes.slices);
    if (channel) message += fmt::format(" --channel 1 to {}", planes.channels);
    if (time) message += fmt::format("{} --time 1 to {}", channel ? " and" : "", planes.times);
    if (time && planes.slices == 1)
        message += "; if the times are slices, say so in the file (ImageJ: Image > Properties)";
    throw InputError(file, message);
}

// The pages of the slices that the options choose.
std::vector<std::int64_t> chosenPages(const std::string& file, const TiffPlanes& planes, std::int64_t pages,
                                      const ImageReadOptions& options) {
    requireChoice(file, planes, options);
    const std::int64_t c = chosen(file, "channel", planes.channels, options.channel),
                       t = chosen(file, "time", planes.times, options.time);
    const auto begin = planes.page.begin() + planes.slices * (c + planes.channels * t);
    const std::vector<std::int64_t> result(begin, begin + planes.slices);
    for (std::size_t z = 0; z < result.size() && !planes.behindOnePage; ++z)
        if (result[z] < 0 || result[z] >= pages)
            throw InputError(file,
                             fmt::format("its description puts slice {} of channel {}, time {} on no page of "
                                         "its {}; it is truncated or the description is not its own",
                                         z + 1, c + 1, t + 1, pages));
    return result;
}

Header headerOf(const TiffPage& page, const TiffPlanes& planes) {
    Header header;
    header.format = "TIFF";
    header.size = {page.width, page.height, planes.slices};
    header.type = *page.type;
    header.spacing = {planes.pixel[0], planes.pixel[1], planes.step.value_or(planes.pixel[0])};
    header.hasZSpacing = planes.step.has_value();
    header.space = Space::unspecified;
    header.warnings = planes.remarks;
    if (page.photometric == kMinIsWhite)
        header.warnings.push_back("0 is white in this TIFF; values are taken as they are stored");
    return header;
}

class TiffStack : public VoxelSource {
  public:
    TiffStack(const fs::path& path, std::shared_ptr<const FileBytes> bytes, TiffFile file)
        : path_(path), bytes_(std::move(bytes)), file_(std::move(file)) {
        native = true;
    }
    std::vector<std::int64_t> pages;  // of each slice

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        const std::size_t size = static_cast<std::size_t>(header.sliceVoxels()) * sizeOf(header.type);
        auto* to = static_cast<std::byte*>(out);
        for (std::int64_t z = z0; z < z1; ++z, to += size) {
            const auto page = static_cast<std::size_t>(pages[static_cast<std::size_t>(z)]);
            const Picture picture = pictureOf(page);
            if (picture.samples.size() != size || picture.type != header.type)
                throw InputError(path_.string(),
                                 fmt::format("its page {} is not what its tags said", page + 1));
            std::memcpy(to, picture.samples.data(), size);
        }
    }

  private:
    // What libtiff says does not say where.
    Picture pictureOf(std::size_t page) {
        try {
            return file_.picture(page, TiffFile::Samples::stored);
        } catch (const InputError& error) {
            const std::string name = path_.string() + ": ", text = error.what();
            throw InputError(path_.string(),
                             fmt::format("its page {} {}", page + 1,
                                         text.starts_with(name) ? text.substr(name.size()) : text));
        }
    }

    fs::path path_;
    std::shared_ptr<const FileBytes> bytes_;
    TiffFile file_;
};

// Images that ImageJ wrote one after another behind the one page.
SourcePtr openBehindOnePage(const fs::path& path, const FileBytes& bytes, const TiffPage& page,
                            const TiffPlanes& planes) {
    const std::string file = path.string();
    if (planes.channels * planes.times > 1)
        throw InputError(file,
                         "its channels or times lie behind one page, as ImageJ writes beyond 4 GB; save the "
                         "one wanted as a file of its own");
    const Header header = headerOf(page, planes);
    const std::int64_t needed = byteCount(file, {header.size.begin(), header.size.end()},
                                          static_cast<std::int64_t>(sizeOf(header.type)));
    if (page.bits < 8 || page.bits / 8 != static_cast<int>(sizeOf(header.type)) ||
        static_cast<std::int64_t>(page.firstByte) > bytes.size() - needed)
        throw InputError(
            file, fmt::format("ImageJ says {} images of {} ({} bytes) behind byte {} but the file holds "
                              "{}; it is truncated",
                              planes.slices, sizeOfPage(page), needed, page.firstByte, bytes.size()));
    char order = 'I';
    bytes.read(0, &order, 1);
    return openPlain({path, static_cast<std::int64_t>(page.firstByte), order == 'M'}, header);
}

}  // namespace

SourcePtr openTiffStack(const fs::path& path, const ImageReadOptions& options) {
    const std::string file = path.string();
    checkTiff(path);
    const auto bytes = std::make_shared<const FileBytes>(path, "a TIFF");
    TiffFile tiff(
        [bytes](std::uint64_t at, char* to, std::size_t count) {
            return bytes->read(static_cast<std::int64_t>(at), to, count);
        },
        static_cast<std::uint64_t>(bytes->size()), file);
    const TiffPlanes planes = planesOf(file, tiff.pages());
    const auto pages = chosenPages(file, planes, std::ssize(tiff.pages()), options);
    const TiffPage first = tiff.pages()[planes.behindOnePage ? 0 : static_cast<std::size_t>(pages.front())];
    requireNumbers(file, first);
    if (planes.behindOnePage) return openBehindOnePage(path, *bytes, first, planes);
    requireAlike(file, tiff.pages(), pages);
    auto source = std::make_unique<TiffStack>(path, bytes, std::move(tiff));
    source->header = headerOf(first, planes);
    source->pages = pages;
    source->slicesPerRead = 1;
    return source;
}

}  // namespace isowave::imageio
