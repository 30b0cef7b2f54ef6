#include "io/picture/png.h"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::string_view kMagic = "\x89PNG\r\n\x1a\n";
// What one byte of a deflate stream can become: 258 bytes for 2 bits of a code (RFC 1951, 3.2.5).
constexpr double kMostExpansion = 1032;

std::uint32_t bigEndian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
}

// Every chunk, before libpng sees one: length, four letters, content, checksum of the last two. Returns the bytes of
// compressed pixels.
std::size_t checkChunks(std::string_view bytes, const std::string& name) {
    std::size_t at = kMagic.size(), pixels = 0;
    for (bool end = false; !end;) {
        if (bytes.size() < at + 12 || bytes.size() - at - 12 < bigEndian(bytes, at))
            throw InputError(
                name, fmt::format("this PNG ends after {} bytes, before its last chunk; it is truncated",
                                  bytes.size()));
        const std::size_t size = bigEndian(bytes, at);
        const std::string_view kind = bytes.substr(at + 4, 4);
        const auto* body = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
        if (crc32_z(0, body, size + 4) != bigEndian(bytes, at + 8 + size))
            throw InputError(
                name, fmt::format("the PNG chunk at byte {} has a wrong checksum; the file is damaged", at));
        if ((at == kMagic.size()) != (kind == "IHDR"))
            throw InputError(name, "this PNG does not begin with its header");
        if (kind == "IDAT") pixels += size;
        end = kind == "IEND";
        at += size + 12;
    }
    return pixels;
}

// What libpng's callbacks are given: the rest of the file that is read, or what was written, and its last words.
struct Transfer {
    std::string_view rest;
    std::string written;
    char error[120] = "damaged";
};

// libpng's frames lie between here and run(): nothing in them has a destructor.
[[noreturn]] void onError(png_structp png, png_const_charp message) {
    auto* transfer = static_cast<Transfer*>(png_get_error_ptr(png));
    std::strncpy(transfer->error, message, sizeof transfer->error - 1);
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void onRead(png_structp png, png_bytep to, std::size_t count) {
    auto* transfer = static_cast<Transfer*>(png_get_io_ptr(png));
    if (transfer->rest.size() < count) png_error(png, "it ends too early");
    std::memcpy(to, transfer->rest.data(), count);
    transfer->rest.remove_prefix(count);
}

void onWrite(png_structp png, png_bytep from, std::size_t count) {
    bool full = false;
    try {
        static_cast<Transfer*>(png_get_io_ptr(png))
            ->written.append(reinterpret_cast<const char*>(from), count);
    } catch (const std::bad_alloc&) {
        full = true;
    }
    if (full) png_error(png, "there is no memory left");
}

// Runs f(), which calls libpng and makes nothing that has a destructor; false when libpng gave up.
template <class F>
bool run(png_structp png, const F& f) {
    if (setjmp(png_jmpbuf(png))) return false;
    f();
    return true;
}

class PngReader {
  public:
    enum class Palette { colours, numbers };  // what its pixels become

    PngReader(std::string_view bytes, const std::string& name, Palette palette)
        : name_(name), palette_(palette), compressed_((requireMagic(bytes), checkChunks(bytes, name))) {
        transfer_.rest = bytes;
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &transfer_, onError, onWarning);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw OperationError(name, "libpng cannot be started; is there memory left?");
        }
        png_set_read_fn(png_, &transfer_, onRead);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    Picture header() {
        Picture picture;
        if (!run(png_, [&] { takeHeader(picture); })) giveUp();
        return picture;
    }

    Picture picture() {
        Picture picture = header();
        allocate(picture, name_, bitsEach_, compressed_, kMostExpansion);
        const std::size_t stride = picture.samples.size() / static_cast<std::size_t>(picture.height);
        std::vector<png_bytep> rows;
        for (std::size_t at = 0; at < picture.samples.size(); at += stride)
            rows.push_back(reinterpret_cast<png_bytep>(picture.samples.data()) + at);
        const bool read = run(png_, [&] {
            if (png_get_rowbytes(png_, info_) != stride) png_error(png_, "its rows have another length");
            png_read_image(png_, rows.data());
            png_read_end(png_, nullptr);
        });
        if (!read) giveUp();
        return picture;
    }

  private:
    void requireMagic(std::string_view bytes) const {
        if (!isPng(bytes)) throw InputError(name_, "is no PNG");
    }

    [[noreturn]] void giveUp() const {
        throw InputError(name_, std::string("cannot be read as a picture: ") + transfer_.error);
    }

    // Sets what pixels shall become, too. Runs under run().
    void takeHeader(Picture& picture) {
        png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        png_read_info(png_, info_);
        picture.bits = png_get_bit_depth(png_, info_);
        bitsEach_ = picture.bits * png_get_channels(png_, info_);
        if (palette_ == Palette::numbers && png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE)
            takeNumbers(picture);
        else
            png_set_expand(png_);  // palettes, fewer than 8 bits, tRNS
        if (std::endian::native == std::endian::little) png_set_swap(png_);
        png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        picture.width = png_get_image_width(png_, info_);
        picture.height = png_get_image_height(png_, info_);
        picture.channels = png_get_channels(png_, info_);
        picture.isColour = picture.channels > 2;
        picture.hasOpacity = picture.channels % 2 == 0;
        picture.type = png_get_bit_depth(png_, info_) == 16 ? ValueType::uint16 : ValueType::uint8;
        picture.isSrgb = png_get_valid(png_, info_, PNG_INFO_sRGB) != 0;
        int unit = 0;
        double across = 0, down = 0;
        if (png_get_sCAL(png_, info_, &unit, &across, &down) != 0) picture.pixelSize = {across, down};
    }

    // Of a palette. Runs under run().
    void takeNumbers(Picture& picture) {
        png_colorp colours = nullptr;
        int count = 0;
        png_get_PLTE(png_, info_, &colours, &count);
        const bool isGrey = std::all_of(colours, colours + count, [](const png_color& c) {
            return c.red == c.green && c.green == c.blue;
        });
        if (isGrey) {
            png_set_palette_to_rgb(png_);
            png_set_strip_alpha(png_);
            png_set_rgb_to_gray_fixed(png_, PNG_ERROR_ACTION_NONE, PNG_RGB_TO_GRAY_DEFAULT,
                                      PNG_RGB_TO_GRAY_DEFAULT);
            return;
        }
        png_set_packing(png_);
        for (const png_color* c = colours; c != colours + count; ++c)
            for (const png_byte part : {c->red, c->green, c->blue})
                picture.palette.push_back(static_cast<char>(part));
    }

    const std::string& name_;
    Palette palette_;
    std::size_t compressed_;
    int bitsEach_ = 0;  // of a pixel in the file
    Transfer transfer_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

// Runs under run().
void write(png_structp png, png_infop info, const Picture& picture, png_bytepp rows) {
    constexpr int kColourTypes[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                    PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height),
                 static_cast<int>(8 * sizeOf(picture.type)), kColourTypes[picture.channels],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (picture.isSrgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (picture.pixelSize)
        png_set_sCAL(png, info, PNG_SCALE_METER, (*picture.pixelSize)[0], (*picture.pixelSize)[1]);
    png_write_info(png, info);
    if (std::endian::native == std::endian::little) png_set_swap(png);
    png_write_image(png, rows);
    png_write_end(png, info);
}

}  // namespace

bool isPng(std::string_view bytes) { return bytes.starts_with(kMagic); }

Picture readPng(std::string_view bytes, const std::string& name) {
    return PngReader(bytes, name, PngReader::Palette::colours).picture();
}

Picture readPngNumbers(std::string_view bytes, const std::string& name) {
    return PngReader(bytes, name, PngReader::Palette::numbers).picture();
}
Picture readPngNumbersHeader(std::string_view bytes, const std::string& name) {
    return PngReader(bytes, name, PngReader::Palette::numbers).header();
}

std::string pngBytes(const Picture& picture) {
    Transfer transfer;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &transfer, onError, onWarning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    const std::size_t stride = picture.samples.size() / static_cast<std::size_t>(picture.height);
    std::vector<png_bytep> rows;
    for (std::size_t at = 0; at < picture.samples.size(); at += stride)
        rows.push_back(reinterpret_cast<png_bytep>(const_cast<std::byte*>(picture.samples.data())) + at);
    bool done = false;
    if (info) {
        png_set_write_fn(png, &transfer, onWrite, nullptr);
        done = run(png, [&] { write(png, info, picture, rows.data()); });
    }
    png_destroy_write_struct(&png, &info);
    if (!done) throw OperationError("picture", std::string("cannot be made a PNG: ") + transfer.error);
    return std::move(transfer.written);
}

}  // namespace isowave
