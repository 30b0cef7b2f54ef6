// The bytes of isowave's own binary files: a magic number, a version, and sections that each carry a checksum.
//
//   8 bytes magic, u32 version, then sections:  u32 kind, u64 length, u32 CRC-32 of kind, length and content, content
//
// All numbers are little endian. Functions throw std::runtime_error with the rest of a message, for the caller to put the
// file's name before it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isowave {

class ByteWriter {
  public:
    void u32(std::uint32_t value) { put(value, 4); }
    void u64(std::uint64_t value) { put(value, 8); }
    void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
    void f64(double value);
    void text(std::string_view value);      // u32 length, bytes
    void varint(std::uint64_t value);       // 7 bits a byte, the low ones first
    void signedVarint(std::int64_t value);  // 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
    void bytes(std::string_view value) { out_ += value; }
    const std::string& str() const { return out_; }

  private:
    void put(std::uint64_t value, int count);
    std::string out_;
};

// Throws std::runtime_error past the end.
class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
    std::uint32_t u32() { return static_cast<std::uint32_t>(take(4)); }
    std::uint64_t u64() { return take(8); }
    std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
    double f64();
    std::string_view text() { return bytes(u32()); }
    std::uint64_t varint();
    std::int64_t signedVarint();
    std::string_view bytes(std::uint64_t count);
    bool atEnd() const { return bytes_.empty(); }

  private:
    std::uint64_t take(int count);
    std::string_view bytes_;
};

struct SectionFormat {
    std::string_view magic;  // 8 bytes
    std::uint32_t version;
    std::string_view thing;   // "packed solid"
    std::string_view maker;   // the command that writes one: "isowave pack INPUT -o OUT.iwz"
    std::string_view remedy;  // "pack it again"
};

struct Section {
    std::uint32_t kind;
    std::string content;
};

std::string fileOf(const SectionFormat& format, const std::vector<Section>& sections);
// Throws: another magic number or version, truncated, a checksum that differs.
std::vector<Section> sectionsOf(const SectionFormat& format, std::string_view file);

// A zlib stream.
std::string deflated(std::string_view bytes);
// REQUIRES: nothing. Throws when `bytes` is no zlib stream of `size` bytes; memory is set aside only where so few bytes can
// hold that many.
std::string inflated(std::string_view bytes, std::uint64_t size);

// Numbers, to the bit: all first bytes, then all second ones, ..., as a zlib stream.
std::string deflatedDoubles(std::span<const double> values);
// Throws as inflated() does, and for a number that is not finite.
std::vector<double> inflatedDoubles(std::string_view bytes, std::uint64_t count);

}  // namespace isowave
