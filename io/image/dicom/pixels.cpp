#include "io/image/dicom/pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "io/image/dicom/codec.h"
#include "io/image/source.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

std::string readRange(DicomBytes& bytes, const DicomRange& range) {
    return bytes.read(range.start, range.length);
}

// Bit k of the stream is bit k % 8 of byte k / 8 (PS3.5 section 8.1.1, annex D). Values of 1 or 12 bits from bit `from`
// on, each as a value of T.
template <class T>
std::string unpacked(const std::string& bytes, std::int64_t from, std::int64_t count, int bits) {
    std::string out(static_cast<std::size_t>(count) * sizeof(T), '\0');
    for (std::int64_t i = 0; i < count; ++i) {
        unsigned value = 0;
        for (int b = 0; b < bits; ++b) {
            const std::int64_t k = from + i * bits + b;
            value |= (static_cast<unsigned char>(bytes[static_cast<std::size_t>(k / 8)]) >> (k % 8) & 1u)
                     << b;
        }
        const T stored = static_cast<T>(value);
        std::memcpy(out.data() + static_cast<std::size_t>(i) * sizeof(T), &stored, sizeof(T));
    }
    return out;
}

void swapEach(std::string& bytes, std::size_t size) {
    if (size == 1) return;
    for (std::size_t at = 0; at + size <= bytes.size(); at += size)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
}

// Bits beside the value, overlays once, are cut off, and the sign is drawn into them.
template <class T>
void tidyBits(std::string& bytes, int stored, int highBit) {
    using U = std::make_unsigned_t<T>;
    constexpr int kBits = 8 * sizeof(T);
    for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
        U raw;
        std::memcpy(&raw, bytes.data() + at, sizeof(T));
        const T value =
            static_cast<T>(static_cast<T>(static_cast<U>(raw << (kBits - 1 - highBit))) >> (kBits - stored));
        std::memcpy(bytes.data() + at, &value, sizeof(T));
    }
}

void tidy(std::string& bytes, const DicomObject& o) {
    if (!isIntegral(o.type) || o.allocated == 1) return;
    if (o.stored == static_cast<int>(8 * sizeOf(o.type))) return;
    withType(o.type, [&]<class T>(T) {
        if constexpr (std::is_integral_v<T>) tidyBits<T>(bytes, o.stored, o.highBit);
    });
}

// In double: slope * v + intercept of a 16-bit value is exact there where it is a whole number.
void rescale(const std::string& bytes, ValueType type, double slope, double intercept, float* out) {
    withType(type, [&]<class T>(T) {
        for (std::size_t i = 0; i < bytes.size() / sizeof(T); ++i) {
            T value;
            std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
            out[i] = static_cast<float>(slope * static_cast<double>(value) + intercept);
        }
    });
}

// The pieces of a frame: as the table of offsets says, or one each, or all of a single frame.
std::vector<DicomRange> piecesOf(const DicomFrame& frame) {
    const DicomFile& file = frame.object->file;
    const auto i = static_cast<std::size_t>(frame.index),
               frames = static_cast<std::size_t>(frame.object->frames);
    if (frames == 1) return file.fragments;
    if (file.fragments.size() == frames) return {file.fragments[i]};
    std::vector<DicomRange> pieces;
    if (file.offsets.size() != frames || file.fragments.empty()) return pieces;
    // Offsets count from the first byte of the first item, whose head takes 8.
    const std::int64_t first = file.fragments[0].start - 8;
    const std::int64_t from = first + file.offsets[i];
    const std::int64_t to = i + 1 < frames ? first + file.offsets[i + 1] : INT64_MAX;
    for (const DicomRange& piece : file.fragments)
        if (piece.start - 8 >= from && piece.start - 8 < to) pieces.push_back(piece);
    return pieces;
}

}  // namespace

DicomBytes& DicomPixels::open(const DicomFrame& frame) {
    const auto& path = frame.object->file.path;
    if (!bytes_ || bytes_->path() != path) bytes_.emplace(openDicomBytes(path));
    return *bytes_;
}

std::string DicomPixels::uncompressed(const DicomFrame& frame) {
    const DicomObject& o = *frame.object;
    const std::int64_t bits = o.pixels() * o.allocated, from = frame.index * bits;
    const std::int64_t first = from / 8, last = (from + bits + 7) / 8;
    std::string bytes = open(frame).read(o.file.pixels.start + first, last - first);
    if (o.allocated == 1) return unpacked<std::uint8_t>(bytes, from % 8, o.pixels(), 1);
    if (o.allocated == 12) return unpacked<std::uint16_t>(bytes, from % 8, o.pixels(), 12);
    // Bytes in words of the other order (PS3.5 section 8.1.1).
    const bool words = o.file.bigEndian && o.allocated == 8 && o.file.pixelVr == "OW";
    if (o.file.bigEndian) swapEach(bytes, words ? 2 : sizeOf(o.type));
    return bytes;
}

std::string DicomPixels::storedBytes(const DicomFrame& frame) {
    if (!frame.object->file.encapsulated) return uncompressed(frame);
    std::vector<std::string> pieces;
    for (const DicomRange& piece : piecesOf(frame)) pieces.push_back(readRange(open(frame), piece));
    if (pieces.empty())
        throw InputError(
            frame.object->file.path.string(),
            fmt::format("which of its {} compressed pieces make up frame {} is not said; it is damaged",
                        frame.object->file.fragments.size(), frame.index + 1));
    return decodeFrame(frame, pieces);
}

std::int64_t DicomPixels::read(const DicomFrame& frame, float* out) {
    const DicomObject& o = *frame.object;
    std::string bytes = storedBytes(frame);
    tidy(bytes, o);
    if (frame.slope == 1 && frame.intercept == 0)
        return convert(o.type, bytes.data(), o.pixels(), false, out);
    rescale(bytes, o.type, frame.slope, frame.intercept, out);
    return 0;
}

}  // namespace isowave::imageio
