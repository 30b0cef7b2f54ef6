#include "base/section_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <stdexcept>

namespace isowave {
namespace {

constexpr std::uint64_t kMostInflation = 1032;  // of deflate: 258 bytes in two bits

std::uint32_t checksum(std::uint32_t kind, std::string_view content) {
    ByteWriter head;
    head.u32(kind);
    head.u64(content.size());
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(head.str().data()), head.str().size());
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(content.data()), content.size());
    return static_cast<std::uint32_t>(crc);
}

void requireHead(const SectionFormat& format, std::string_view file) {
    if (!file.starts_with(format.magic))
        throw std::runtime_error(fmt::format("is no {}: it does not begin with \"{}\"; make one with: {}",
                                             format.thing, format.magic, format.maker));
    ByteReader reader(file.substr(format.magic.size()));
    const std::uint32_t version = reader.u32();
    if (version != format.version)
        throw std::runtime_error(fmt::format(
            "is a {} of format version {}, expected {}; {} with this version of isowave, or read it with the "
            "one that wrote it",
            format.thing, version, format.version, format.remedy));
}

}  // namespace

void ByteWriter::put(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) out_ += static_cast<char>(value >> (8 * i));
}
void ByteWriter::f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
void ByteWriter::text(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()));
    bytes(value);
}
void ByteWriter::varint(std::uint64_t value) {
    for (; value >= 128; value >>= 7) out_ += static_cast<char>(128 | (value & 127));
    out_ += static_cast<char>(value);
}
void ByteWriter::signedVarint(std::int64_t value) {
    varint((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
}

std::uint64_t ByteReader::take(int count) {
    const std::string_view some = bytes(static_cast<std::uint64_t>(count));
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i)
        value |= std::uint64_t{static_cast<std::uint8_t>(some[static_cast<std::size_t>(i)])} << (8 * i);
    return value;
}
double ByteReader::f64() { return std::bit_cast<double>(u64()); }
std::uint64_t ByteReader::varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
        const auto byte = static_cast<std::uint8_t>(bytes(1)[0]);
        value |= std::uint64_t{byte & 127u} << shift;
        if (byte < 128) return value;
    }
    throw std::runtime_error("has a number of more than 63 bits; the file is damaged");
}
std::int64_t ByteReader::signedVarint() {
    const std::uint64_t value = varint();
    return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}
std::string_view ByteReader::bytes(std::uint64_t count) {
    if (count > bytes_.size())
        throw std::runtime_error(
            fmt::format("ends where {} more bytes were expected; it is truncated", count - bytes_.size()));
    const std::string_view some = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return some;
}

std::string fileOf(const SectionFormat& format, const std::vector<Section>& sections) {
    ByteWriter writer;
    writer.bytes(format.magic);
    writer.u32(format.version);
    for (const Section& section : sections) {
        writer.u32(section.kind);
        writer.u64(section.content.size());
        writer.u32(checksum(section.kind, section.content));
        writer.bytes(section.content);
    }
    return writer.str();
}

std::vector<Section> sectionsOf(const SectionFormat& format, std::string_view file) {
    requireHead(format, file);
    ByteReader reader(file.substr(format.magic.size() + 4));
    std::vector<Section> sections;
    while (!reader.atEnd()) {
        const std::uint32_t kind = reader.u32();
        const std::uint64_t length = reader.u64();
        const std::uint32_t expected = reader.u32();
        const std::string_view content = reader.bytes(length);
        if (checksum(kind, content) != expected)
            throw std::runtime_error(
                fmt::format("section {} does not have the checksum that it was written with; the file is "
                            "damaged; {}, or take another copy",
                            sections.size(), format.remedy));
        sections.push_back({kind, std::string(content)});
    }
    return sections;
}

std::string deflated(std::string_view bytes) {
    uLongf size = compressBound(bytes.size());
    std::string out(size, '\0');
    compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
              bytes.size(), 9);
    out.resize(size);
    return out;
}

std::string inflated(std::string_view bytes, std::uint64_t size) {
    const char* const damaged = "does not unpack; the file is damaged";
    if (size > kMostInflation * bytes.size()) throw std::runtime_error(damaged);
    std::string out(size, '\0');
    uLongf found = size;
    if (uncompress(reinterpret_cast<Bytef*>(out.data()), &found, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) != Z_OK ||
        found != size)
        throw std::runtime_error(damaged);
    return out;
}

std::string deflatedDoubles(std::span<const double> values) {
    std::string planes(8 * values.size(), '\0');
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto bits = std::bit_cast<std::uint64_t>(values[i]);
        for (std::size_t b = 0; b < 8; ++b)
            planes[b * values.size() + i] = static_cast<char>(bits >> (8 * b));
    }
    return deflated(planes);
}

std::vector<double> inflatedDoubles(std::string_view bytes, std::uint64_t count) {
    if (count > UINT64_MAX / 8) throw std::runtime_error("holds too many numbers; the file is damaged");
    const std::string planes = inflated(bytes, 8 * count);
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t bits = 0;
        for (std::size_t b = 0; b < 8; ++b)
            bits |= std::uint64_t{static_cast<std::uint8_t>(planes[b * count + i])} << (8 * b);
        values[i] = std::bit_cast<double>(bits);
        if (!std::isfinite(values[i]))
            throw std::runtime_error("holds a number that is not finite; the file is damaged");
    }
    return values;
}

}  // namespace isowave
