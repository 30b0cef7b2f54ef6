#include "io/picture/bmp.h"

#include <fmt/format.h>

#include <cstdlib>

#include "isowave/error.h"

namespace isowave {
namespace {

// Microsoft's BITMAPFILEHEADER and BITMAPINFOHEADER; offsets from the beginning of the file.
constexpr std::size_t kFileHeader = 14, kHeaders = 54;
enum Compression : std::uint32_t { kPlain = 0, kRuns8 = 1, kMasks = 3 };

class BmpReader {
  public:
    BmpReader(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes) {
        if (bytes.size() < kHeaders)
            throw InputError(name, "this BMP ends within its header; it is truncated");
        if (number(kFileHeader, 4) < 40)
            throw InputError(name, "is a BMP of OS/2, which is not read; save it as PNG");
        begin_ = number(10, 4);
        bits_ = static_cast<int>(number(28, 2));
        compression_ = number(30, 4);
    }

    Picture picture() {
        Picture picture;
        picture.width = signedNumber(18);
        const std::int64_t rows = signedNumber(22);
        picture.height = std::abs(rows);
        checkSize(picture, name_);
        requireKnownKind();
        const auto width = static_cast<std::size_t>(picture.width),
                   height = static_cast<std::size_t>(picture.height);
        const std::size_t stride = (width * static_cast<std::size_t>(bits_) + 31) / 32 * 4,
                          needed = begin_ + stride * height;
        if (compression_ != kRuns8 && bytes_.size() < needed)
            throw InputError(
                name_, fmt::format("this BMP holds {} bytes of {}; it is truncated", bytes_.size(), needed));
        picture.isColour = true;
        picture.hasOpacity = bits_ == 32;
        picture.channels = picture.hasOpacity ? 4 : 3;
        // A run of at most 255 pixels takes two bytes; what no run names stays as it is.
        allocate(picture, name_, compression_ == kRuns8 ? 8 : bits_, bytes_.size(),
                 compression_ == kRuns8 ? 128 : 1);
        const std::string unpacked = compression_ == kRuns8 ? withoutRuns(width, height) : std::string();
        const std::string_view data = unpacked.empty() ? bytes_.substr(begin_) : unpacked;
        const std::size_t step = unpacked.empty() ? stride : width;
        for (std::size_t y = 0; y < height; ++y)  // from the bottom, unless the height is negative
            takeRow(data.substr(step * (rows < 0 ? y : height - 1 - y)), y, picture);
        if (picture.hasOpacity) dropPadding(picture);
        return picture;
    }

  private:
    std::uint32_t number(std::size_t at, std::size_t size) const {
        std::uint32_t value = 0;
        for (std::size_t k = size; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[at + k]);
        return value;
    }
    std::int64_t signedNumber(std::size_t at) const { return static_cast<std::int32_t>(number(at, 4)); }

    void requireKnownKind() const {
        const bool palette = bits_ == 1 || bits_ == 4 || bits_ == 8;
        // Masks of 32 bits: those of blue, green, red, as without masks.
        const bool usualMasks = bits_ == 32 && bytes_.size() >= kHeaders + 12 &&
                                number(kHeaders, 4) == 0xff0000 && number(kHeaders + 4, 4) == 0xff00 &&
                                number(kHeaders + 8, 4) == 0xff;
        if ((compression_ == kPlain && (palette || bits_ == 24 || bits_ == 32)) ||
            (compression_ == kRuns8 && bits_ == 8) || (compression_ == kMasks && usualMasks))
            return;
        throw InputError(name_, fmt::format("is a BMP of {} bits a pixel in encoding {}, which is not read; "
                                            "save it as PNG",
                                            bits_, compression_));
    }

    void takeRow(std::string_view row, std::size_t y, Picture& picture) const {
        const auto width = static_cast<std::size_t>(picture.width),
                   channels = static_cast<std::size_t>(picture.channels);
        auto* to = reinterpret_cast<unsigned char*>(picture.samples.data()) + y * width * channels;
        const auto bits = static_cast<std::size_t>(bits_);
        for (std::size_t x = 0; x < width; ++x, to += channels) {
            if (bits_ > 8) {
                const char* from = row.data() + x * channels;
                for (std::size_t c = 0; c < channels; ++c)
                    to[c] = static_cast<unsigned char>(from[c < 3 ? 2 - c : c]);
            } else {
                const auto byte = static_cast<unsigned char>(row[x * bits / 8]);
                const std::size_t shift = 8 - bits - x * bits % 8;
                putColour((static_cast<std::size_t>(byte) >> shift) & ((1u << bits_) - 1), to);
            }
        }
    }

    // The palette follows the headers: blue, green, red, nothing.
    void putColour(std::size_t index, unsigned char* to) const {
        const std::size_t colours = number(46, 4) ? number(46, 4) : std::size_t{1} << bits_;
        const std::size_t at = kFileHeader + number(14, 4) + 4 * index;
        if (index >= colours || at + 4 > bytes_.size())
            throw InputError(name_, fmt::format("a pixel has colour {}, which its palette has not", index));
        for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<unsigned char>(bytes_[at + 2 - c]);
    }

    // RLE8: a count and a value; or 0 and 0: end of the row, 1: end, 2: a move, n: n values as they are.
    std::string withoutRuns(std::size_t width, std::size_t height) const {
        std::string pixels(width * height, '\0');
        std::size_t x = 0, y = 0;
        const auto put = [&](char value) {
            if (x < width && y < height) pixels[y * width + x] = value;
            ++x;
        };
        for (std::size_t at = begin_; y < height;) {
            if (at + 2 > bytes_.size())
                throw InputError(name_, "this BMP ends within its runs; it is truncated");
            const auto count = static_cast<unsigned char>(bytes_[at]),
                       value = static_cast<unsigned char>(bytes_[at + 1]);
            at += 2;
            if (count > 0) {
                for (int k = 0; k < count; ++k) put(static_cast<char>(value));
            } else if (value == 0) {
                x = 0;
                ++y;
            } else if (value == 1) {
                break;
            } else if (const std::size_t size = value == 2 ? 2 : value + value % 2u;
                       at + size > bytes_.size()) {
                throw InputError(name_, "this BMP ends within its runs; it is truncated");
            } else {
                if (value == 2) {
                    x += static_cast<unsigned char>(bytes_[at]);
                    y += static_cast<unsigned char>(bytes_[at + 1]);
                } else {
                    for (std::size_t k = 0; k < value; ++k) put(bytes_[at + k]);
                }
                at += size;
            }
        }
        return pixels;
    }

    static void dropPadding(Picture& picture) {
        auto& samples = picture.samples;
        for (std::size_t k = 3; k < samples.size(); k += 4)
            if (samples[k] != std::byte{0}) return;
        for (std::size_t k = 3; k < samples.size(); k += 4) samples[k] = std::byte{255};
    }

    const std::string& name_;
    std::string_view bytes_;
    std::size_t begin_ = 0;  // of the pixels
    int bits_ = 0;           // of a pixel
    std::uint32_t compression_ = 0;
};

}  // namespace

bool isBmp(std::string_view bytes) { return bytes.starts_with("BM"); }

Picture readBmp(std::string_view bytes, const std::string& name) {
    if (!isBmp(bytes)) throw InputError(name, "is no BMP");
    return BmpReader(bytes, name).picture();
}

}  // namespace isowave
