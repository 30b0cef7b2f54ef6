#include "compress/sections.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <stdexcept>

namespace isowave::compress {
namespace {

constexpr std::uint64_t kMostInflated = std::uint64_t{16} << 20;
constexpr const char* kRemedy = "the file is damaged; pack it again, or take another copy";

std::uint32_t checksum(std::uint32_t kind, std::string_view content) {
    ByteWriter head;
    head.u32(kind);
    head.u64(content.size());
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(head.str().data()), head.str().size());
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(content.data()), content.size());
    return static_cast<std::uint32_t>(crc);
}

void requireHead(std::string_view file) {
    if (!file.starts_with(kMagic))
        throw std::runtime_error(
            "is no packed solid: it does not begin with \"ISOWAVEZ\"; make one with: isowave pack "
            "INPUT -o OUT.iwz");
    ByteReader reader(file.substr(kMagic.size()));
    const std::uint32_t version = reader.u32();
    if (version != kPackedFormatVersion)
        throw std::runtime_error(
            fmt::format("is a packed solid of format version {}, expected {}; pack it again with this "
                        "version of isowave, or read it with the one that wrote it",
                        version, kPackedFormatVersion));
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

std::uint64_t ByteReader::take(int count) {
    const std::string_view some = bytes(static_cast<std::uint64_t>(count));
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i)
        value |= std::uint64_t{static_cast<std::uint8_t>(some[static_cast<std::size_t>(i)])} << (8 * i);
    return value;
}
double ByteReader::f64() { return std::bit_cast<double>(u64()); }
std::string_view ByteReader::bytes(std::uint64_t count) {
    if (count > bytes_.size())
        throw std::runtime_error(
            fmt::format("ends where {} more bytes were expected; it is truncated", count - bytes_.size()));
    const std::string_view some = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return some;
}

std::string fileOf(const std::vector<Section>& sections) {
    ByteWriter writer;
    writer.bytes(kMagic);
    writer.u32(kPackedFormatVersion);
    for (const Section& section : sections) {
        const auto kind = static_cast<std::uint32_t>(section.kind);
        writer.u32(kind);
        writer.u64(section.content.size());
        writer.u32(checksum(kind, section.content));
        writer.bytes(section.content);
    }
    return writer.str();
}

std::vector<Section> sectionsOf(std::string_view file) {
    requireHead(file);
    ByteReader reader(file.substr(kMagic.size() + 4));
    std::vector<Section> sections;
    while (!reader.atEnd()) {
        const std::uint32_t kind = reader.u32();
        const std::uint64_t length = reader.u64();
        const std::uint32_t expected = reader.u32();
        const std::string_view content = reader.bytes(length);
        if (checksum(kind, content) != expected)
            throw std::runtime_error(
                fmt::format("section {} does not have the checksum that it was written with; {}",
                            sections.size(), kRemedy));
        sections.push_back({static_cast<SectionKind>(kind), std::string(content)});
    }
    return sections;
}

std::string deflated(std::string_view bytes) {
    uLongf size = compressBound(bytes.size());
    std::string out(size, '\0');
    compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
              bytes.size(), 9);
    out.resize(size);
    ByteWriter writer;
    writer.u32(static_cast<std::uint32_t>(bytes.size()));
    return writer.str() + out;
}

std::string inflated(std::string_view bytes) {
    ByteReader reader(bytes);
    uLongf size = reader.u32();
    if (size > kMostInflated) throw std::runtime_error(std::string("its head is too large; ") + kRemedy);
    std::string out(size, '\0');
    const std::string_view packed = bytes.substr(4);
    if (uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                   packed.size()) != Z_OK ||
        size != out.size())
        throw std::runtime_error(std::string("its head does not unpack; ") + kRemedy);
    return out;
}

}  // namespace isowave::compress
