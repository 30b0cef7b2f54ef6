// Deflate streams inflated: piece by piece, and gzip files whole, in memory (RFC 1950, 1951, 1952).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace isowave {

// What stands around the deflated bytes.
enum class DeflateWrapper {
    zlibOrGzip,  // whichever the first bytes say; either has a checksum
    none
};

class InflateStream {
  public:
    enum class State {
        going,    // wants more bytes, or more room
        ended,    // the end mark was there and its checksum right; bytes behind it are not touched
        damaged,  // goes no further
    };

    explicit InflateStream(DeflateWrapper wrapper = DeflateWrapper::zlibOrGzip);
    ~InflateStream();
    InflateStream(InflateStream&&) noexcept;
    InflateStream& operator=(InflateStream&&) noexcept;

    // Inflates from the front of `in` to the front of `out` until one of them is empty or the stream ends; both are shortened by
    // what was taken. May leave bytes in both for the next call.
    State inflate(std::string_view& in, std::span<char>& out);
    // What comes next is the begin of another stream: gzip files are often several, one after another.
    void restart();
    // What zlib says of the damage: "incorrect data check".
    std::string complaint() const;

  private:
    struct Zlib;
    std::unique_ptr<Zlib> zlib_;
};

// Deflate's longest match, 258 bytes, takes two bits at least: 1032 to 1 (zlib's technical details).
inline constexpr std::size_t kBestDeflateRatio = 1032;

// Whether bytes begin as gzip does.
inline bool isGzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

// "part.stl.gz" -> "part.stl", in any case; other names as they are.
std::filesystem::path withoutGz(const std::filesystem::path& path);

// What a gzip file inflates to; several streams after one another are one, as gunzip has it. Zeros behind the last are padding
// (tape blocks). Throws InputError, with `name`: a stream that breaks off or is damaged, other bytes behind its end, and
// what inflates to more than `most` bytes or, above 256 MiB, to more than 250 times the file's size.
std::string gunzipped(std::string_view packed, const std::string& name, std::size_t most);

}  // namespace isowave
