// The bytes of a chunk, as numcodecs has packed them.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace isowave::imageio {

enum class ZarrCodec { none, zlib, blosc, zstd, lz4 };  // zlib: gzip too

// Fills `out`. Throws InputError with `name`: the bytes are damaged, or make more or fewer than out.size().
void unpackChunk(ZarrCodec codec, std::string_view packed, const std::string& name, std::span<char> out);

}  // namespace isowave::imageio
