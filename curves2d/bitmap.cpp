#include "curves2d/bitmap.h"

#include <fmt/format.h>
#include <itkBMPImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 31;

void checkSize(const std::string& name, std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1)
        throw InputError(name,
                         fmt::format("an image of {} x {} pixels; there is nothing in it", width, height));
    if (width > kMostPixels / height)
        throw InputError(name,
                         fmt::format("an image of {} x {} pixels; at most 2^31 pixels are read. Cut it or "
                                     "give its outline as polygons",
                                     width, height));
}

void refuseNotFinite(const std::string& name, const Bitmap& bitmap) {
    const auto bad = std::find_if_not(bitmap.values.begin(), bitmap.values.end(),
                                      [](float v) { return std::isfinite(v); });
    if (bad == bitmap.values.end()) return;
    const std::int64_t i = bad - bitmap.values.begin();
    throw InputError(name,
                     fmt::format("pixel ({}, {}) is {}; {} of {} pixels are not finite. Replace them first",
                                 i % bitmap.width, i / bitmap.width, *bad,
                                 std::count_if(bitmap.values.begin(), bitmap.values.end(),
                                               [](float v) { return !std::isfinite(v); }),
                                 bitmap.values.size()));
}

// ---- PGM, PBM: "P" digit, numbers with comments between them, pixels as text or bytes
// ------------------------

class Pnm {
  public:
    Pnm(std::string name, std::string bytes) : name_(std::move(name)), bytes_(std::move(bytes)) {}

    // kind: the digit behind the P.
    Bitmap read(char kind) {
        const bool text = kind <= '3', bits = kind == '1' || kind == '4';
        Bitmap bitmap;
        bitmap.width = number("width");
        bitmap.height = number("height");
        checkSize(name_, bitmap.width, bitmap.height);
        const int most = bits ? 1 : number("largest value");
        if (most < 1 || most > 65535)
            throw InputError(name_,
                             fmt::format("its largest value is {}; between 1 and 65535 is possible", most));
        bitmap.values.resize(static_cast<std::size_t>(bitmap.width) *
                             static_cast<std::size_t>(bitmap.height));
        if (!text) ++at_;  // one white space behind the header
        if (text) {
            for (float& v : bitmap.values)
                v = bits ? (bit() ? 0.0f : 255.0f) : static_cast<float>(number("pixel"));
        } else if (bits) {
            readBits(bitmap);
        } else {
            readBytes(bitmap, most > 255 ? 2 : 1);
        }
        if (!bits) refuseAbove(bitmap, most);
        return bitmap;
    }

  private:
    [[noreturn]] void truncated() const {
        throw InputError(
            name_, fmt::format("ends after {} bytes, before its last pixel; it is truncated", bytes_.size()));
    }
    void refuseAbove(const Bitmap& bitmap, int most) const {
        const auto above = std::find_if(bitmap.values.begin(), bitmap.values.end(),
                                        [most](float v) { return v > static_cast<float>(most); });
        if (above != bitmap.values.end())
            throw InputError(name_,
                             fmt::format("pixel {} is {}; its header says that {} is the largest value",
                                         above - bitmap.values.begin(), *above, most));
    }
    void skipBlanks() {
        while (at_ < bytes_.size() &&
               (std::isspace(static_cast<unsigned char>(bytes_[at_])) || bytes_[at_] == '#')) {
            if (bytes_[at_] == '#')
                while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
            else
                ++at_;
        }
    }
    int number(const char* what) {
        skipBlanks();
        if (at_ == bytes_.size()) truncated();
        std::int64_t value = 0;
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && std::isdigit(static_cast<unsigned char>(bytes_[at_])) &&
               value < (1 << 30))
            value = 10 * value + (bytes_[at_++] - '0');
        if (at_ == begin || value >= (1 << 30))
            throw InputError(name_, fmt::format("no number at byte {}, where the {} should be", at_, what));
        return static_cast<int>(value);
    }
    bool bit() {
        skipBlanks();
        if (at_ == bytes_.size()) truncated();
        return bytes_[at_++] == '1';
    }
    void readBits(Bitmap& bitmap) {
        const std::size_t stride = (static_cast<std::size_t>(bitmap.width) + 7) / 8;
        if (bytes_.size() < at_ + stride * static_cast<std::size_t>(bitmap.height)) truncated();
        std::size_t i = 0;
        for (std::int32_t y = 0; y < bitmap.height; ++y)
            for (std::int32_t x = 0; x < bitmap.width; ++x) {
                const auto byte = static_cast<unsigned char>(
                    bytes_[at_ + stride * static_cast<std::size_t>(y) + static_cast<std::size_t>(x / 8)]);
                bitmap.values[i++] = (byte >> (7 - x % 8)) & 1 ? 0.0f : 255.0f;
            }
    }
    void readBytes(Bitmap& bitmap, std::size_t size) {
        if (bytes_.size() < at_ + size * bitmap.values.size()) truncated();
        for (float& v : bitmap.values) {
            int value = 0;
            for (std::size_t k = 0; k < size; ++k)
                value = 256 * value + static_cast<unsigned char>(bytes_[at_++]);
            v = static_cast<float>(value);
        }
    }

    std::string name_, bytes_;
    std::size_t at_ = 2;
};

// ---- files that ITK's readers would abort on, or read as black where they end ----

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
}

std::uint32_t littleEndian(const std::string& bytes, std::size_t at, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t k = size; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
}

// The checksum of PNG's chunks: the reflected polynomial 0xEDB88320 (ISO 3309).
std::uint32_t checksum(const std::string& bytes, std::size_t begin, std::size_t end) {
    std::uint32_t crc = 0xffffffffu;
    for (std::size_t i = begin; i < end; ++i) {
        crc ^= static_cast<unsigned char>(bytes[i]);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0u);
    }
    return ~crc;
}

void checkPngHeader(const std::string& name, const std::string& bytes, std::size_t content) {
    checkSize(name, bigEndian(bytes, content), bigEndian(bytes, content + 4));
    const int depth = bytes[content + 8], colour = bytes[content + 9];
    const bool power = depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
    const bool whole = depth == 8 || depth == 16;
    const bool good = (colour == 0 && power) || (colour == 3 && power && depth < 16) ||
                      ((colour == 2 || colour == 4 || colour == 6) && whole);
    if (!good)
        throw InputError(
            name, fmt::format("PNG of colour type {} with {} bits; there is none such", colour, depth));
}

// ITK 5.2 gives libpng no way out of an error in the header, so libpng aborts the process: every chunk is
// checked first. Chunks: length, four letters, content, checksum of the last two.
void checkPng(const std::string& name, const std::string& bytes) {
    std::size_t at = 8;
    for (bool end = false; !end;) {
        if (bytes.size() < at + 12 || bytes.size() - at - 12 < bigEndian(bytes, at))
            throw InputError(name, fmt::format("this PNG ends after {} bytes, before its last chunk; it is "
                                               "truncated",
                                               bytes.size()));
        const std::size_t size = bigEndian(bytes, at), body = at + 4, last = body + 4 + size;
        const std::string kind = bytes.substr(body, 4);
        if (checksum(bytes, body, last) != bigEndian(bytes, last))
            throw InputError(
                name, fmt::format("the PNG chunk at byte {} has a wrong checksum; the file is damaged", at));
        if (at == 8) {
            if (kind != "IHDR" || size != 13)
                throw InputError(name, "this PNG does not begin with its header");
            checkPngHeader(name, bytes, body + 4);
        }
        end = kind == "IEND";
        at = last + 4;
    }
}

void checkBmp(const std::string& name, const std::string& bytes) {
    if (bytes.size() < 54) throw InputError(name, "this BMP ends within its header; it is truncated");
    const std::int64_t width = static_cast<std::int32_t>(littleEndian(bytes, 18, 4)),
                       height = std::abs(std::int64_t{static_cast<std::int32_t>(littleEndian(bytes, 22, 4))}),
                       bits = littleEndian(bytes, 28, 2);
    checkSize(name, width, height);
    const std::int64_t needed = littleEndian(bytes, 10, 4) + (width * bits + 31) / 32 * 4 * height;
    if (littleEndian(bytes, 30, 4) == 0 && static_cast<std::int64_t>(bytes.size()) < needed)
        throw InputError(name,
                         fmt::format("this BMP holds {} bytes of {}; it is truncated", bytes.size(), needed));
}

// ---- PNG, TIFF, BMP
// ------------------------------------------------------------------------------------------

// Components of a pixel -> one number. full: the value of full opacity.
template <class T>
float luminance(const T* pixel, unsigned components, double full) {
    const double grey = components < 3
                            ? static_cast<double>(pixel[0])
                            : 0.299 * static_cast<double>(pixel[0]) + 0.587 * static_cast<double>(pixel[1]) +
                                  0.114 * static_cast<double>(pixel[2]);
    if (components % 2 == 1) return static_cast<float>(grey);
    const double opacity = static_cast<double>(pixel[components - 1]) / full;
    return static_cast<float>(opacity * grey + (1 - opacity) * full);
}

template <class T>
void convert(const std::vector<char>& bytes, unsigned components, Bitmap& bitmap) {
    const double full = std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1.0;
    const T* pixel = reinterpret_cast<const T*>(bytes.data());
    for (float& v : bitmap.values) {
        v = luminance(pixel, components, full);
        pixel += components;
    }
}

itk::ImageIOBase::Pointer readerFor(const std::string& name) {
    const std::vector<itk::ImageIOBase::Pointer> readers = {itk::PNGImageIO::New().GetPointer(),
                                                            itk::TIFFImageIO::New().GetPointer(),
                                                            itk::BMPImageIO::New().GetPointer()};
    for (const auto& reader : readers)
        if (reader->CanReadFile(name.c_str())) return reader;
    throw InputError(name,
                     "neither PNG, TIFF, BMP, PGM nor PBM; expected an image, or polygons in .geojson, "
                     ".json or .txt");
}

Bitmap readWithItk(const std::string& name) {
    const itk::ImageIOBase::Pointer io = readerFor(name);
    io->SetFileName(name);
    io->ReadImageInformation();
    if (io->GetNumberOfDimensions() > 2 && io->GetDimensions(2) > 1)
        throw InputError(name,
                         fmt::format("holds {} pages; a planar curve wants one. Save the page as an image",
                                     io->GetDimensions(2)));
    Bitmap bitmap;
    const auto width = static_cast<std::int64_t>(io->GetDimensions(0)),
               height = static_cast<std::int64_t>(io->GetDimensions(1));
    checkSize(name, width, height);
    bitmap.width = static_cast<std::int32_t>(width);
    bitmap.height = static_cast<std::int32_t>(height);
    bitmap.values.resize(static_cast<std::size_t>(width * height));
    itk::ImageIORegion region(io->GetNumberOfDimensions());
    for (unsigned d = 0; d < io->GetNumberOfDimensions(); ++d) region.SetSize(d, io->GetDimensions(d));
    io->SetIORegion(region);
    std::vector<char> bytes(static_cast<std::size_t>(io->GetImageSizeInBytes()));
    io->Read(bytes.data());
    const unsigned components = io->GetNumberOfComponents();
    switch (io->GetComponentType()) {
        case itk::ImageIOBase::UCHAR:
            convert<unsigned char>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::CHAR:
            convert<signed char>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::USHORT:
            convert<unsigned short>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::SHORT:
            convert<short>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::UINT:
            convert<unsigned>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::INT:
            convert<int>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::FLOAT:
            convert<float>(bytes, components, bitmap);
            break;
        case itk::ImageIOBase::DOUBLE:
            convert<double>(bytes, components, bitmap);
            break;
        default:
            throw InputError(name, "pixels of type " + io->GetComponentTypeAsString(io->GetComponentType()) +
                                       "; 8 to 32 bit integers and floats are read");
    }
    return bitmap;
}

// ---- iso line
// ------------------------------------------------------------------------------------------------

// Values relative to the iso value, positive outside. Outside the image there is the mirror image of the
// nearest pixel's value where that is inside, so the line passes half a pixel beyond the border, and the
// value itself where it is outside.
class Levels {
  public:
    Levels(const Bitmap& bitmap, double iso, bool invert)
        : bitmap_(bitmap), iso_(iso), sign_(invert ? -1 : 1) {}
    bool inside(std::int32_t x, std::int32_t y) const { return (bitmap_.at(x, y) > iso_) != (sign_ < 0); }
    double at(std::int32_t x, std::int32_t y) const {
        const std::int32_t cx = std::clamp(x, 0, bitmap_.width - 1),
                           cy = std::clamp(y, 0, bitmap_.height - 1);
        const double size = std::abs(static_cast<double>(bitmap_.at(cx, cy)) - iso_);
        const bool here = cx == x && cy == y && inside(x, y);
        return here ? -size : size;
    }

  private:
    const Bitmap& bitmap_;
    double iso_;
    int sign_;
};

// Marching squares on the bilinear interpolation; a square with two pieces is decided by its mean.
void isoSegments(const Levels& levels, std::int32_t x, std::int32_t y, const std::array<bool, 4>& in,
                 std::vector<Segment>& out) {
    constexpr int dx[] = {0, 1, 1, 0}, dy[] = {0, 0, 1, 1};
    std::array<double, 4> v;
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        v[k] = levels.at(x + dx[k], y + dy[k]);
        sum += v[k];
    }
    std::array<Point, 4> p{};
    std::array<bool, 4> crossed{};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t to = (k + 1) % 4;
        crossed[k] = in[k] != in[to];
        // A pixel exactly at the iso value counts as outside: the crossing is there, or half-way if both are.
        const double t = v[k] != v[to] ? std::clamp(v[k] / (v[k] - v[to]), 0.0, 1.0) : 0.5;
        p[k] = {x + dx[k] + t * (dx[to] - dx[k]), y + dy[k] + t * (dy[to] - dy[k])};
    }
    const bool two = in[0] == in[2] && in[1] == in[3] && in[0] != in[1];
    for (std::size_t k = 0; k < 4; ++k) {
        if (!crossed[k] || !in[k]) continue;
        std::size_t to = (k + 1) % 4;
        if (two && sum >= 0) to = (k + 3) % 4;
        while (!crossed[to]) to = (to + 1) % 4;
        out.push_back({p[k], p[to]});
    }
}

}  // namespace

ValueRange valueRange(const Bitmap& bitmap) {
    const auto [low, high] = std::minmax_element(bitmap.values.begin(), bitmap.values.end());
    ValueRange range{*low, *high, true};
    range.twoValues = std::all_of(bitmap.values.begin(), bitmap.values.end(),
                                  [&](float v) { return v == range.low || v == range.high; });
    return range;
}

Bitmap readBitmap(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::ifstream stream(path, std::ios::binary);
    if (!stream || std::filesystem::is_directory(path)) throw InputError(name, "cannot be read");
    char magic[3] = {};
    stream.read(magic, 3);
    if (stream.gcount() == 0) throw InputError(name, "is empty; expected an image or polygons");
    stream.clear();
    stream.seekg(0);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    Bitmap bitmap;
    const bool blank = std::isspace(static_cast<unsigned char>(magic[2])) || magic[2] == '#';
    if (magic[0] == 'P' && blank &&
        (magic[1] == '1' || magic[1] == '2' || magic[1] == '4' || magic[1] == '5')) {
        bitmap = Pnm(name, bytes).read(magic[1]);
    } else {
        if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n", 8) == 0) checkPng(name, bytes);
        if (bytes.compare(0, 2, "BM") == 0) checkBmp(name, bytes);
        try {
            bitmap = readWithItk(name);
        } catch (const itk::ExceptionObject& error) {
            std::string what = error.GetDescription();
            std::replace(what.begin(), what.end(), '\n', ' ');
            throw InputError(name, "cannot be read as an image, it is damaged or truncated: " + what);
        }
    }
    refuseNotFinite(name, bitmap);
    return bitmap;
}

Shape shapeOf(const Bitmap& bitmap, double iso, bool invert, const std::string& name) {
    const Levels levels(bitmap, iso, invert);
    Shape shape;
    shape.inside.rows.resize(static_cast<std::size_t>(bitmap.height));
    bool any = false;
    for (std::int32_t y = 0; y < bitmap.height; ++y) {
        Spans& row = shape.inside.rows[static_cast<std::size_t>(y)];
        for (std::int32_t x = 0; x < bitmap.width; ++x) {
            if (!levels.inside(x, y)) continue;
            if (!row.empty() && row.back().last == x - 1)
                row.back().last = x;
            else
                row.push_back({x, x});
        }
        any = any || !row.empty();
    }
    if (!any) {
        const ValueRange range = valueRange(bitmap);
        throw InputError(name,
                         fmt::format("no pixel is inside: values run from {} to {}, inside is {} {}; choose "
                                     "another --iso{}",
                                     range.low, range.high, invert ? "at most" : "above", iso,
                                     invert ? "" : " or --invert"));
    }
    for (std::int32_t y = -1; y < bitmap.height; ++y) {
        SpanCursor below(shape.inside.row(y)), above(shape.inside.row(y + 1));
        std::array<bool, 4> in{false, false, false, false};
        for (std::int32_t x = -1; x < bitmap.width; ++x) {
            in = {in[1], below.contains(x + 1), above.contains(x + 1), in[2]};
            if (in[0] != in[1] || in[1] != in[2] || in[2] != in[3])
                isoSegments(levels, x, y, in, shape.boundary);
        }
    }
    return shape;
}

}  // namespace isowave::curves2d
