#include "io/image/zarr/unpack.h"

#include <blosc.h>
#include <fmt/format.h>
#include <lz4.h>
#include <zstd.h>

#include <cstring>
#include <limits>
#include <optional>

#include "base/inflate.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

// What there is of a chunk: how many bytes were made, or nothing where the packed ones are damaged.
using Made = std::optional<std::size_t>;

Made copied(std::string_view packed, std::span<char> out) {
    if (packed.size() == out.size()) std::memcpy(out.data(), packed.data(), out.size());
    return packed.size();
}

Made inflated(std::string_view packed, std::span<char> out) {
    InflateStream stream;
    std::span<char> room = out;
    auto state = InflateStream::State::going;
    while (state == InflateStream::State::going && (!packed.empty() || !room.empty())) {
        const auto before = std::pair(packed.size(), room.size());
        state = stream.inflate(packed, room);
        if (before == std::pair(packed.size(), room.size())) break;
    }
    if (state == InflateStream::State::ended) return out.size() - room.size();
    if (state == InflateStream::State::going && room.empty()) return out.size() + 1;  // there is more
    return std::nullopt;
}

// A frame says in its header how many bytes it makes.
Made fromBlosc(std::string_view packed, std::span<char> out) {
    std::size_t bytes = 0;
    if (packed.size() < BLOSC_MIN_HEADER_LENGTH ||
        blosc_cbuffer_validate(packed.data(), packed.size(), &bytes) < 0)
        return std::nullopt;
    if (bytes != out.size()) return bytes;
    const int made = blosc_decompress_ctx(packed.data(), out.data(), out.size(), 1);
    if (made < 0) return std::nullopt;
    return static_cast<std::size_t>(made);
}

Made fromZstd(std::string_view packed, std::span<char> out) {
    const unsigned long long said = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (said == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
    if (said != ZSTD_CONTENTSIZE_UNKNOWN && said > out.size()) return said;
    const std::size_t made = ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
    if (ZSTD_isError(made)) return std::nullopt;
    return made;
}

// numcodecs puts the number of bytes in front, 32 bits, little-endian.
Made fromLz4(std::string_view packed, std::span<char> out) {
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    std::uint32_t said = 0;
    if (packed.size() <= sizeof said || packed.size() > kMost) return std::nullopt;
    std::memcpy(&said, packed.data(), sizeof said);
    if (said != out.size() || said > kMost) return said;
    const int made =
        LZ4_decompress_safe(packed.data() + sizeof said, out.data(),
                            static_cast<int>(packed.size() - sizeof said), static_cast<int>(said));
    if (made < 0) return std::nullopt;
    return static_cast<std::size_t>(made);
}

Made made(ZarrCodec codec, std::string_view packed, std::span<char> out) {
    switch (codec) {
        case ZarrCodec::none:
            return copied(packed, out);
        case ZarrCodec::zlib:
            return inflated(packed, out);
        case ZarrCodec::blosc:
            return fromBlosc(packed, out);
        case ZarrCodec::zstd:
            return fromZstd(packed, out);
        case ZarrCodec::lz4:
            break;
    }
    return fromLz4(packed, out);
}

}  // namespace

void unpackChunk(ZarrCodec codec, std::string_view packed, const std::string& name, std::span<char> out) {
    const Made bytes = made(codec, packed, out);
    if (!bytes) throw InputError(name, "is a damaged chunk; copy the store again");
    if (*bytes != out.size())
        throw InputError(
            name, fmt::format("holds {}{} bytes; a chunk of this array has {}; it is truncated, or "
                              "of another array",
                              *bytes == out.size() + 1 && codec == ZarrCodec::zlib ? "at least " : "", *bytes,
                              out.size()));
}

}  // namespace isowave::imageio
