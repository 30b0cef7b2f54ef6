#include "io/picture/tiff.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include "base/text.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// ---- libtiff reads through this, and tells its errors to the file that they are about

struct TiffBytes {
    TiffFile::ReadAt readAt;
    std::uint64_t size = 0, at = 0;
    char error[160] = "";  // the first one
};

TiffBytes& fileOf(thandle_t handle) { return *static_cast<TiffBytes*>(handle); }

tmsize_t onRead(thandle_t handle, void* to, tmsize_t count) {
    TiffBytes& file = fileOf(handle);
    if (file.at >= file.size || count <= 0) return 0;
    const auto wanted = std::min(static_cast<std::uint64_t>(count), file.size - file.at);
    const std::size_t got = file.readAt(file.at, static_cast<char*>(to), static_cast<std::size_t>(wanted));
    file.at += got;
    return static_cast<tmsize_t>(got);
}
tmsize_t onWrite(thandle_t, void*, tmsize_t) { return 0; }
toff_t onSeek(thandle_t handle, toff_t offset, int from) {
    TiffBytes& file = fileOf(handle);
    file.at = offset + (from == SEEK_CUR ? file.at : from == SEEK_END ? file.size : 0);
    return file.at;
}
int onClose(thandle_t) { return 0; }
toff_t onSize(thandle_t handle) { return fileOf(handle).size; }

int onError(TIFF*, void* file, const char*, const char* format, va_list arguments) {
    char* error = static_cast<TiffBytes*>(file)->error;
    if (*error) return 1;  // nobody else need know
    std::vsnprintf(error, sizeof TiffBytes::error, format, arguments);
    for (char* c = error; *c; ++c) {  // some of libtiff's messages are two lines
        if (*c == '\n') *c = ' ';
    }
    return 1;
}
int onWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

using TiffPtr = std::unique_ptr<TIFF, void (*)(TIFF*)>;

// ---- what the tags of a page say

// What one byte can become.
double mostExpansion(int compression, double width) {
    switch (compression) {
        case COMPRESSION_NONE:
            return 1;
        case COMPRESSION_PACKBITS:
            return 64;
        case COMPRESSION_LZW:
            return 4096;  // a string of the whole table for a code of more than a byte
        case COMPRESSION_DEFLATE:
        case COMPRESSION_ADOBE_DEFLATE:
            return 1032;
        case COMPRESSION_JPEG:
        case COMPRESSION_OJPEG:
            return 2048;  // a bit for 64 samples, of which chroma has a quarter
        case COMPRESSION_CCITTRLE:
        case COMPRESSION_CCITTRLEW:
        case COMPRESSION_CCITTFAX3:
        case COMPRESSION_CCITTFAX4:
            return width;  // a bit for a row that is like the one above
        default:
            return 65536;
    }
}

std::optional<ValueType> typeFor(int bits, int format) {
    if (format == SAMPLEFORMAT_IEEEFP)  // 16: made 32 when read
        return bits == 16 || bits == 32 ? std::optional(ValueType::float32)
               : bits == 64             ? std::optional(ValueType::float64)
                                        : std::nullopt;
    if (format > SAMPLEFORMAT_VOID) return std::nullopt;
    const bool isSigned = format == SAMPLEFORMAT_INT;
    switch (bits) {
        case 1:
        case 2:
        case 4:
            return isSigned ? std::nullopt : std::optional(ValueType::uint8);
        case 8:
            return isSigned ? ValueType::int8 : ValueType::uint8;
        case 16:
            return isSigned ? ValueType::int16 : ValueType::uint16;
        case 32:
            return isSigned ? ValueType::int32 : ValueType::uint32;
        case 64:
            return isSigned ? ValueType::int64 : ValueType::uint64;
        default:
            return std::nullopt;
    }
}

// IEEE 754 binary16: 1 sign, 5 exponent, 10 fraction bits; every value is one of float32.
float floatOfHalf(std::uint16_t half) {
    const int exponent = half >> 10 & 31, fraction = half & 1023;
    const float sign = half >> 15 ? -1.0f : 1.0f;
    if (exponent == 31)
        return fraction ? std::numeric_limits<float>::quiet_NaN()
                        : sign * std::numeric_limits<float>::infinity();
    if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
    return sign * std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
}

// One allocation of libtiff's at most; a tag's array in a damaged file asks for any number.
tmsize_t mostAtOnce(std::uint64_t fileBytes) {
    constexpr std::uint64_t kAtLeast = std::uint64_t(256) << 20;
    return static_cast<tmsize_t>(std::max(kAtLeast, 2 * fileBytes));
}

std::string textOf(const char* text) { return text ? text : ""; }

// A strip or a tile: where it lies, and its decoded size.
struct Block {
    std::size_t left = 0, top = 0, width = 0, height = 0, rowBytes = 0;
    std::size_t plane = 0;
};

}  // namespace

class TiffFile::Reader {
  public:
    Reader(ReadAt readAt, std::uint64_t size, const std::string& name)
        : name_(name), file_{std::move(readAt), size}, tiff_(open(), TIFFClose) {
        if (!tiff_) giveUp();
        findPages();
    }

    const std::vector<TiffPage>& pages() const { return pages_; }

    Picture picture(std::size_t page, Samples samples) {
        if (!TIFFSetSubDirectory(tiff_.get(), pages_[page].directory)) giveUp();
        isStored_ = samples == Samples::stored;
        Picture picture;
        picture.pages = static_cast<int>(std::max<std::ptrdiff_t>(
            1,
            std::count_if(pages_.begin(), pages_.end(), [](const TiffPage& p) { return !p.isThumbnail; })));
        picture.width = pages_[page].width;
        picture.height = pages_[page].height;
        picture.bits = pages_[page].bits;
        samples_ = pages_[page].samples;
        photometric_ = pages_[page].photometric;
        const auto code = tag<std::uint16_t>(TIFFTAG_COMPRESSION);
        if (!TIFFIsCODECConfigured(code))
            throw InputError(name_,
                             fmt::format("cannot be read as a picture: its compression {} is unknown", code));
        const auto type = pages_[page].type;
        if (!type || !isDirect(picture.bits)) {
            if (isStored_) throw InputError(name_, "holds no numbers but colours; convert it to grey");
            return shown(std::move(picture));
        }
        picture.type = *type;
        isHalf_ = picture.bits == 16 && picture.type == ValueType::float32;
        takeChannels(picture);
        // Halves become twice as large.
        allocate(picture, name_, bitsEach(picture), file_.size, isHalf_ ? 2 * expansion() : expansion());
        readBlocks(picture);
        finish(picture);
        if (photometric_ == PHOTOMETRIC_MINISBLACK && picture.bits >= 8)
            picture.noData = noData(picture.type);
        return picture;
    }

  private:
    TIFF* open() {
        const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
        if (!options) return nullptr;
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), onError, &file_);
        TIFFOpenOptionsSetWarningHandlerExtR(options.get(), onWarning, nullptr);
        TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), mostAtOnce(file_.size));
        // m: not mapped.
        return TIFFClientOpenExt(name_.c_str(), "rm", &file_, onRead, onWrite, onSeek, onClose, onSize,
                                 nullptr, nullptr, options.get());
    }
    [[noreturn]] void giveUp() const {
        throw InputError(name_, std::string("cannot be read as a picture: ") +
                                    (*file_.error ? file_.error : "it is damaged or truncated"));
    }

    template <class T>
    T tag(std::uint32_t which, T value = {}) const {
        TIFFGetFieldDefaulted(tiff_.get(), which, &value);
        return value;
    }
    // Of GDAL's tag, a number as text. libtiff does not know it, and hands out tags that it does not know with their size.
    std::optional<double> noData(ValueType type) const {
        constexpr std::uint32_t kTag = 42113;
        const TIFFField* const field = TIFFFindField(tiff_.get(), kTag, TIFF_ANY);
        if (!field || TIFFFieldDataType(field) != TIFF_ASCII || !TIFFFieldPassCount(field) ||
            TIFFFieldReadCount(field) != TIFF_VARIABLE2)
            return std::nullopt;
        std::uint32_t size = 0;
        const char* text = nullptr;
        if (!TIFFGetField(tiff_.get(), kTag, &size, &text) || !text) return std::nullopt;
        const std::string_view all(text, size);
        std::size_t at = std::min(all.find_first_not_of(' '), all.size());
        const std::optional<double> value = takeNumber(all, at);
        const bool isRounded = value && type == ValueType::float32 &&
                               std::abs(*value) <= static_cast<double>(std::numeric_limits<float>::max());
        return isRounded ? std::optional(static_cast<double>(static_cast<float>(*value))) : value;
    }
    double expansion() const {
        return mostExpansion(tag<std::uint16_t>(TIFFTAG_COMPRESSION), tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH));
    }
    bool isSeparate() const { return tag<std::uint16_t>(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE; }
    int bitsEach(const Picture& picture) const { return picture.bits * samples_; }

    void findPages() {
        do {
            pages_.push_back(pageHere());
        } while (TIFFReadDirectory(tiff_.get()));
        if (*file_.error) giveUp();
    }

    TiffPage pageHere() {
        TiffPage page;
        page.directory = TIFFCurrentDirOffset(tiff_.get());
        page.width = static_cast<std::int64_t>(tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH));
        page.height = static_cast<std::int64_t>(tag<std::uint32_t>(TIFFTAG_IMAGELENGTH));
        page.depth = static_cast<std::int64_t>(tag<std::uint32_t>(TIFFTAG_IMAGEDEPTH, 1));
        page.bits = tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE);
        page.samples = tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL);
        page.photometric = tag<std::uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        page.type = typeFor(page.bits, tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT));
        page.isThumbnail =
            (tag<std::uint32_t>(TIFFTAG_SUBFILETYPE) & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0;
        page.perUnit = {tag<float>(TIFFTAG_XRESOLUTION), tag<float>(TIFFTAG_YRESOLUTION)};
        page.unit = tag<std::uint16_t>(TIFFTAG_RESOLUTIONUNIT);
        // Long ones only once: ImageJ and OME write them into the first page.
        if (pages_.empty()) page.description = textOf(tag<const char*>(TIFFTAG_IMAGEDESCRIPTION));
        if (tag<std::uint16_t>(TIFFTAG_COMPRESSION) == COMPRESSION_NONE && !TIFFIsTiled(tiff_.get()))
            page.firstByte = TIFFGetStrileOffset(tiff_.get(), 0);
        return page;
    }

    // Whether samples are grey values, colours or places in a palette as they stand.
    bool isDirect(int bits) const {
        if (photometric_ == PHOTOMETRIC_PALETTE) return (bits <= 8 || isStored_) && samples_ == 1;
        if (photometric_ == PHOTOMETRIC_RGB) return samples_ >= 3;
        return photometric_ <= PHOTOMETRIC_MINISBLACK && samples_ >= 1;
    }

    void takeChannels(Picture& picture) {
        picture.isColour = photometric_ == PHOTOMETRIC_RGB;
        const int colours = picture.isColour ? 3 : 1;
        std::uint16_t count = 0, *kinds = nullptr;
        TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_EXTRASAMPLES, &count, &kinds);
        const int kind = count > 0 && kinds ? kinds[0] : EXTRASAMPLE_UNSPECIFIED;
        picture.hasOpacity =
            samples_ == colours + 1 || (samples_ > colours && kind != EXTRASAMPLE_UNSPECIFIED);
        picture.channels = colours + (picture.hasOpacity ? 1 : 0);
        isMultiplied_ = picture.hasOpacity && kind == EXTRASAMPLE_ASSOCALPHA;
    }

    // ---- pixels

    void readBlocks(Picture& picture) {
        TIFF* const tiff = tiff_.get();
        const bool tiled = TIFFIsTiled(tiff) != 0;
        Block block;
        block.width = tiled ? tag<std::uint32_t>(TIFFTAG_TILEWIDTH) : static_cast<std::size_t>(picture.width);
        block.height = tiled ? tag<std::uint32_t>(TIFFTAG_TILELENGTH)
                             : std::min<std::size_t>(tag<std::uint32_t>(TIFFTAG_ROWSPERSTRIP),
                                                     static_cast<std::size_t>(picture.height));
        block.rowBytes = static_cast<std::size_t>(tiled ? TIFFTileRowSize64(tiff) : TIFFScanlineSize64(tiff));
        const auto size = static_cast<std::size_t>(tiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff));
        const std::size_t rowBits =
            block.width * static_cast<std::size_t>(isSeparate() ? picture.bits : bitsEach(picture));
        if (block.width == 0 || block.height == 0 || block.rowBytes * 8 < rowBits ||
            size / block.height < block.rowBytes ||
            static_cast<double>(size) > static_cast<double>(file_.size) * expansion() + 65536)
            giveUp();
        std::vector<unsigned char> decoded(size);
        const std::uint32_t count = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
        for (std::uint32_t k = 0; k < count; ++k) {
            place(block, k, picture);
            if (block.plane >= static_cast<std::size_t>(picture.channels)) break;
            const auto whole = static_cast<tmsize_t>(size);
            if ((tiled ? TIFFReadEncodedTile(tiff, k, decoded.data(), whole)
                       : TIFFReadEncodedStrip(tiff, k, decoded.data(), -1)) < 0)
                giveUp();
            takeBlock(block, decoded.data(), picture);
        }
    }

    // Blocks are counted along rows, then down, then by planes.
    void place(Block& block, std::size_t number, const Picture& picture) const {
        const auto width = static_cast<std::size_t>(picture.width),
                   height = static_cast<std::size_t>(picture.height);
        const std::size_t across = (width + block.width - 1) / block.width,
                          down = (height + block.height - 1) / block.height;
        block.left = number % across * block.width;
        block.top = number / across % down * block.height;
        block.plane = isSeparate() ? number / across / down : 0;
    }

    void takeBlock(const Block& block, const unsigned char* decoded, Picture& picture) const {
        const auto width = static_cast<std::size_t>(picture.width),
                   channels = static_cast<std::size_t>(picture.channels), each = sizeOf(picture.type);
        const std::size_t rows = std::min(block.height, static_cast<std::size_t>(picture.height) - block.top),
                          columns = std::min(block.width, width - block.left);
        const bool separate = isSeparate();
        const std::size_t step = separate ? 1 : static_cast<std::size_t>(samples_);
        for (std::size_t y = 0; y < rows; ++y) {
            const unsigned char* from = decoded + y * block.rowBytes;
            std::byte* to = picture.samples.data() +
                            (((block.top + y) * width + block.left) * channels + block.plane) * each;
            for (std::size_t x = 0; x < columns; ++x, to += channels * each)
                for (std::size_t c = 0; c < (separate ? 1 : channels); ++c)
                    takeSample(from, x * step + c, picture.bits, to + c * each);
        }
    }

    void takeSample(const unsigned char* row, std::size_t k, int bits, std::byte* to) const {
        const auto size = static_cast<std::size_t>(bits);
        if (isHalf_) {
            std::uint16_t half;
            std::memcpy(&half, row + 2 * k, 2);
            const float value = floatOfHalf(half);
            std::memcpy(to, &value, sizeof value);
            return;
        }
        if (bits >= 8) {
            std::memcpy(to, row + k * size / 8, size / 8);
            return;
        }
        const int most = (1 << bits) - 1, value = row[k * size / 8] >> (8 - size - k * size % 8) & most;
        const bool asItIs = isStored_ || photometric_ == PHOTOMETRIC_PALETTE;
        *to = static_cast<std::byte>(asItIs ? value : value * 255 / most);
    }

    // ---- samples as they are meant

    void finish(Picture& picture) {
        if (photometric_ == PHOTOMETRIC_PALETTE && !isStored_) putColours(picture);
        if (photometric_ == PHOTOMETRIC_MINISWHITE && !isStored_) turnOver(picture);
        if (isMultiplied_) divide(picture);
        turn(picture, tag<std::uint16_t>(TIFFTAG_ORIENTATION));
    }

    void putColours(Picture& picture) const {
        std::uint16_t* map[3] = {};
        if (!TIFFGetField(tiff_.get(), TIFFTAG_COLORMAP, &map[0], &map[1], &map[2]))
            throw InputError(name_, "cannot be read as a picture: its palette is missing");
        const std::vector<std::byte> places = std::move(picture.samples);
        picture.type = ValueType::uint16;
        picture.isColour = true;
        picture.channels = 3;
        picture.samples.resize(places.size() * 6);
        for (std::size_t k = 0; k < 3 * places.size(); ++k)
            std::memcpy(picture.samples.data() + 2 * k, map[k % 3] + std::to_integer<int>(places[k / 3]), 2);
    }

    static void turnOver(Picture& picture) {
        withType(picture.type, [&]<class T>(T) {
            if constexpr (std::is_unsigned_v<T>) {
                T* const samples = reinterpret_cast<T*>(picture.samples.data());
                const auto step = static_cast<std::size_t>(picture.channels);
                for (std::size_t k = 0; k < picture.sampleCount(); k += step)
                    samples[k] = static_cast<T>(std::numeric_limits<T>::max() - samples[k]);
            }
        });
    }

    static void divide(Picture& picture) {
        const double full = picture.fullValue();
        withType(picture.type, [&]<class T>(T) {
            T* pixel = reinterpret_cast<T*>(picture.samples.data());
            const int last = picture.channels - 1;
            for (std::size_t k = 0; k < picture.sampleCount(); k += last + 1u, pixel += last + 1) {
                const double opacity = static_cast<double>(pixel[last]);
                for (int c = 0; c < last && opacity > 0; ++c) {
                    const double value = static_cast<double>(pixel[c]) * full / opacity;
                    pixel[c] = std::is_integral_v<T> ? static_cast<T>(std::lround(std::min(value, full)))
                                                     : static_cast<T>(value);
                }
            }
        });
    }

    // Rows from the top, pixels from the left. What is turned by a quarter stays, as in libtiff's own viewer.
    static void turn(Picture& picture, int orientation) {
        const bool right = orientation == ORIENTATION_TOPRIGHT || orientation == ORIENTATION_BOTRIGHT,
                   bottom = orientation == ORIENTATION_BOTLEFT || orientation == ORIENTATION_BOTRIGHT;
        const std::size_t pixel = static_cast<std::size_t>(picture.channels) * sizeOf(picture.type),
                          row = pixel * static_cast<std::size_t>(picture.width);
        const auto swapRuns = [](std::byte* begin, std::size_t size, std::size_t count) {
            for (std::size_t k = 0; k < count / 2; ++k)
                std::swap_ranges(begin + k * size, begin + (k + 1) * size, begin + (count - 1 - k) * size);
        };
        std::byte* const samples = picture.samples.data();
        if (bottom) swapRuns(samples, row, static_cast<std::size_t>(picture.height));
        for (std::size_t at = 0; right && at < picture.samples.size(); at += row)
            swapRuns(samples + at, pixel, static_cast<std::size_t>(picture.width));
    }

    // What libtiff can turn into colours of 8 bits.
    Picture shown(Picture picture) {
        char why[1024] = "";
        if (!TIFFRGBAImageOK(tiff_.get(), why))
            throw InputError(name_, std::string("cannot be read as a picture: ") + why);
        const int bits = std::max(1, bitsEach(picture));
        picture.isColour = true;
        picture.channels = 3;
        // Chroma may be coarser.
        allocate(picture, name_, bits, file_.size, 3 * expansion());
        std::vector<std::uint32_t> raster(picture.samples.size() / 3);
        if (!TIFFReadRGBAImageOriented(tiff_.get(), static_cast<std::uint32_t>(picture.width),
                                       static_cast<std::uint32_t>(picture.height), raster.data(),
                                       ORIENTATION_TOPLEFT, 1))
            giveUp();
        for (std::size_t k = 0; k < picture.samples.size(); ++k)
            picture.samples[k] = static_cast<std::byte>(raster[k / 3] >> 8 * (k % 3) & 255);
        return picture;
    }

    std::string name_;
    TiffBytes file_;
    TiffPtr tiff_;
    std::vector<TiffPage> pages_;
    // Of the page that is being read.
    int samples_ = 1, photometric_ = 0;
    bool isStored_ = false, isHalf_ = false;
    bool isMultiplied_ = false;  // with opacity
};

bool isTiff(std::string_view bytes) {
    const std::string_view start = bytes.substr(0, 4);
    return start == std::string_view("II*\0", 4) || start == std::string_view("MM\0*", 4) ||
           start == std::string_view("II+\0", 4) || start == std::string_view("MM\0+", 4);
}

Picture readTiff(std::string_view bytes, const std::string& name) {
    if (!isTiff(bytes)) throw InputError(name, "is no TIFF");
    const auto readAt = [bytes](std::uint64_t at, char* to, std::size_t count) {
        std::memcpy(to, bytes.data() + at, count);
        return count;
    };
    return TiffFile(readAt, bytes.size(), name).picture(0, TiffFile::Samples::shown);
}

TiffFile::TiffFile(ReadAt readAt, std::uint64_t size, const std::string& name)
    : reader_(std::make_unique<Reader>(std::move(readAt), size, name)) {}
TiffFile::~TiffFile() = default;
TiffFile::TiffFile(TiffFile&&) noexcept = default;
TiffFile& TiffFile::operator=(TiffFile&&) noexcept = default;
const std::vector<TiffPage>& TiffFile::pages() const { return reader_->pages(); }
Picture TiffFile::picture(std::size_t page, Samples samples) { return reader_->picture(page, samples); }

}  // namespace isowave
