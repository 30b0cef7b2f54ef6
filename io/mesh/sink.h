// Bytes on their way to a file, in big pieces.
#pragma once

#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "isowave/mesh.h"

namespace isowave {

class Sink {
  public:
    // To a file that appears at finish(), whole, or not at all. Throws OperationError.
    explicit Sink(const std::filesystem::path& path);
    // To memory, for take().
    Sink() = default;

    void text(std::string_view s) {
        buffer_.append(s);
        flushPiece();
    }
    // The values' bytes as the memory has them.
    template <class... T>
    void binary(const T&... values) {
        (buffer_.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
        flushPiece();
    }
    // `before`, then the shortest decimal that reads back exactly.
    template <class Number>
    void number(char before, Number value) {
        char digits[32];
        digits[0] = before;
        const auto end = std::to_chars(digits + 1, digits + sizeof digits, value).ptr;
        text({digits, end});
    }
    template <class Number>
    void number(std::string_view before, Number value) {
        char digits[32];
        text(before);
        text({digits, std::to_chars(digits, digits + sizeof digits, value).ptr});
    }
    // The three such decimals of a point, with blanks between; plain: without exponents from 1e-4 up to 1e16.
    void point(const Point& p, bool plain);
    // Throws OperationError where the disk is full.
    void finish();
    std::string take() { return std::move(buffer_); }

  private:
    static constexpr std::size_t kPiece = 1 << 20;
    void flushPiece() {
        if (file_ && buffer_.size() >= kPiece) write();
    }
    void write();

    std::filesystem::path path_;
    std::optional<AtomicFile> file_;  // none: to memory
    std::string buffer_;
};

}  // namespace isowave
