#include "io/mesh/sink.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <iterator>

#include "isowave/error.h"

namespace isowave {

static_assert(std::endian::native == std::endian::little,
              "binary formats are written as the memory has them");

Sink::Sink(const std::filesystem::path& path) : path_(path), file_(std::in_place, path) {
    buffer_.reserve(kPiece + 256);
}

void Sink::point(const Point& p, bool plain) {
    if (plain) {
        fmt::format_to(std::back_inserter(buffer_), "{} {} {}", p[0], p[1], p[2]);
        return flushPiece();
    }
    char line[96];
    char* at = line;
    for (const double x : p) {
        at = std::to_chars(at, line + sizeof line, x).ptr;
        *at++ = ' ';
    }
    text({line, at - 1});
}

void Sink::write() {
    errno = 0;
    try {
        file_->stream().write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    } catch (const std::ios_base::failure&) {
        throw OperationError(path_.string(), std::string("writing failed (") + std::strerror(errno) +
                                                 "); is the disk full? Nothing was left behind");
    }
    buffer_.clear();
}

void Sink::finish() {
    write();
    file_->commit();
}

}  // namespace isowave
