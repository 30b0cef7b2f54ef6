#include "base/read_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "base/file_bytes.h"
#include "base/inflate.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// To the end, from pipes too.
std::string everyByte(const FileDescriptor& file) {
    constexpr std::size_t kFirstBlock = 1 << 16;
    std::string bytes;
    for (std::size_t size = 0;;) {
        if (size == bytes.size()) bytes.resize(std::max(kFirstBlock, 2 * size));
        const ssize_t got = ::read(file.get(), bytes.data() + size, bytes.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got > 0) size += static_cast<std::size_t>(got);
        if (got <= 0) return bytes.resize(size), bytes;
    }
}

std::string filledFile(const std::filesystem::path& path, std::string_view expected) {
    std::string bytes = everyByte(FileDescriptor(path, expected));
    if (bytes.empty()) throw InputError(path.string(), fmt::format("is empty; expected {}", expected));
    return bytes;
}

}  // namespace

std::string readFile(const std::filesystem::path& path, std::string_view expected) {
    std::string bytes = filledFile(path, expected);
    if (isGzip(bytes)) throw InputError(path.string(), "is compressed by gzip; gunzip it first");
    return bytes;
}

std::string readInflatedFile(const std::filesystem::path& path, std::string_view expected, double most) {
    std::string bytes = filledFile(path, expected);
    return isGzip(bytes) ? gunzipped(bytes, path.string(), static_cast<std::size_t>(most)) : bytes;
}

}  // namespace isowave
