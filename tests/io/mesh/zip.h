// Zip archives written byte by byte, for tests of what reads them.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace isowave::test {

template <class T>
std::string rawBytes(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// A zip archive of parts that are stored as they are (PKWARE's APPNOTE.TXT 4.3).
inline std::string zipOf(const std::vector<std::pair<std::string, std::string>>& parts) {
    std::string out, directory;
    const auto u16 = [](unsigned v) {
        return rawBytes(std::vector<std::uint16_t>{static_cast<std::uint16_t>(v)});
    };
    const auto u32 = [](std::size_t v) {
        return rawBytes(std::vector<std::uint32_t>{static_cast<std::uint32_t>(v)});
    };
    for (const auto& [name, data] : parts) {
        const auto crc =
            crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size()));
        const std::string common = u16(20) + u16(0) + u16(0) + u16(0) + u16(0x21) + u32(crc) +
                                   u32(data.size()) + u32(data.size()) +
                                   u16(static_cast<unsigned>(name.size())) + u16(0);
        directory += "PK\1\2" + u16(20) + common + u16(0) + u16(0) + u16(0) + u32(0) + u32(out.size()) + name;
        out += "PK\3\4" + common + name + data;
    }
    const auto count = static_cast<unsigned>(parts.size());
    return out + directory + "PK\5\6" + u16(0) + u16(0) + u16(count) + u16(count) + u32(directory.size()) +
           u32(out.size()) + u16(0);
}

}  // namespace isowave::test
