// Bytes as a web page holds them: deflated (zlib, which browsers call "deflate"), then base64.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isowave::view {

using Bytes = std::vector<std::uint8_t>;

// RFC 1950. Throws OperationError when memory does not suffice.
Bytes deflated(const Bytes& bytes);

// RFC 4648, padded, without line breaks.
std::string base64(const Bytes& bytes);

// Little-endian groups of seven bits, each but the last with bit 7 set.
void putVarint(Bytes& bytes, std::uint64_t value);

// 0, -1, 1, -2, ... -> 0, 1, 2, 3, ...
inline std::uint64_t zigzag(std::int64_t value) {
    return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}

}  // namespace isowave::view
