// The bytes of a packed file: a magic number, a version, and sections that each carry a checksum.
//
//   "ISOWAVEZ", u32 version, then sections:  u32 kind, u64 length, u32 CRC-32 of kind, length and content, content
//
// All numbers are little endian.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isowave::compress {

inline constexpr std::string_view kMagic = "ISOWAVEZ";
inline constexpr std::uint32_t kPackedFormatVersion = 1;

class ByteWriter {
  public:
    void u32(std::uint32_t value) { put(value, 4); }
    void u64(std::uint64_t value) { put(value, 8); }
    void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
    void f64(double value);
    void text(std::string_view value);  // u32 length, bytes
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
    std::string_view bytes(std::uint64_t count);
    bool atEnd() const { return bytes_.empty(); }

  private:
    std::uint64_t take(int count);
    std::string_view bytes_;
};

enum class SectionKind : std::uint32_t { head = 1, nodes = 2, signs = 3, values = 4 };

struct Section {
    SectionKind kind;
    std::string content;
};

std::string fileOf(const std::vector<Section>& sections);
// Throws std::runtime_error with the rest of a message: "is no packed file: ...", "the section ... is damaged".
std::vector<Section> sectionsOf(std::string_view file);

std::string deflated(std::string_view bytes);
std::string inflated(std::string_view bytes);  // throws std::runtime_error; at most 16 MB

}  // namespace isowave::compress
