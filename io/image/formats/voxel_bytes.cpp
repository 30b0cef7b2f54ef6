#include "io/image/formats/voxel_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>

#include "base/cad_model.h"
#include "base/file_bytes.h"
#include "base/inflate.h"
#include "base/text.h"
#include "io/image/check.h"
#include "io/image/header.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void throwBrokenOff(const fs::path& file) {
    throw InputError(file.string(), "its voxels break off; it is truncated or its header is wrong");
}

class RawBytes : public VoxelBytes {
  public:
    explicit RawBytes(const VoxelPiece& piece)
        : path_(piece.file), file_(piece.file, "voxels"), start_(piece.start + piece.skip) {}

    void read(std::int64_t at, char* to, std::int64_t count) override {
        const auto wanted = static_cast<std::size_t>(count);
        if (file_.read(start_ + at, to, wanted) < wanted) throwBrokenOff(path_);
    }

  private:
    fs::path path_;
    FileBytes file_;
    std::int64_t start_;
};

// What can be read forwards only.
class ForwardBytes : public VoxelBytes {
  public:
    ForwardBytes(const VoxelPiece& piece, std::int64_t total) : piece_(piece), total_(total) {}

    void read(std::int64_t at, char* to, std::int64_t count) override {
        if (!begun_ || at < at_) {
            restart();
            begun_ = true;
            at_ = 0;
            leaveOut(piece_.skip);
        }
        leaveOut(at - at_);
        next(to, count);
        at_ = at + count;
        if (at_ == total_) finish();
    }

  protected:
    virtual void restart() = 0;
    virtual void next(char* to, std::int64_t count) = 0;
    virtual void finish() {}
    const VoxelPiece& piece() const { return piece_; }

  private:
    void leaveOut(std::int64_t count) {
        std::array<char, 1 << 14> nowhere;
        for (std::int64_t n; count > 0; count -= n) {
            n = std::min<std::int64_t>(count, nowhere.size());
            next(nowhere.data(), n);
        }
    }

    VoxelPiece piece_;
    std::int64_t total_, at_ = 0;
    bool begun_ = false;
};

// zlib or gzip, whichever the first bytes say; several gzip streams one after another are one.
class DeflatedBytes : public ForwardBytes {
  public:
    using ForwardBytes::ForwardBytes;

  private:
    void restart() override {
        file_ = std::ifstream(piece().file, std::ios::binary);
        file_.seekg(piece().start);
        stream_ = InflateStream();
        ended_ = false;
        in_.resize(1 << 16);
        left_ = {};
    }

    // Whether there is anything left to inflate.
    bool fill() {
        if (!left_.empty()) return true;
        file_.read(in_.data(), static_cast<std::streamsize>(in_.size()));
        left_ = {in_.data(), static_cast<std::size_t>(file_.gcount())};
        return !left_.empty();
    }

    // Inflates to the front of `to`, which is shortened by what came.
    void inflateSome(std::span<char>& to) {
        if (!fill()) throwBrokenOff(piece().file);
        if (ended_) stream_.restart();
        const InflateStream::State state = stream_.inflate(left_, to);
        ended_ = state == InflateStream::State::ended;
        if (state == InflateStream::State::damaged)
            throw InputError(piece().file.string(),
                             fmt::format("its compressed voxels are damaged ({})", stream_.complaint()));
    }

    void next(char* to, std::int64_t count) override {
        for (std::span<char> room(to, static_cast<std::size_t>(count)); !room.empty();) inflateSome(room);
    }

    // The end of the stream holds its checksum.
    void finish() override {
        std::array<char, 1 << 14> nowhere;
        while (!ended_) {
            std::span<char> room(nowhere);
            inflateSome(room);
        }
    }

    std::ifstream file_;
    std::vector<char> in_;
    std::string_view left_;  // of in_
    InflateStream stream_;
    bool ended_ = false;
};

// Characters of a file, with the number of each line's first one forgotten: only what is wrong is said.
class TextBytes : public ForwardBytes {
  public:
    TextBytes(const VoxelPiece& piece, ValueType type, std::int64_t total)
        : ForwardBytes({piece.file, piece.start, 0}, total), type_(type) {}

  private:
    void restart() override {
        file_ = std::ifstream(piece().file, std::ios::binary);
        file_.seekg(piece().start);
        number_ = 0;
    }

    static bool separates(int c) { return c <= ' ' || c == ',' || c == '{' || c == '}' || c == ';'; }

    // The next word; at most as long as a number may be.
    std::string word() {
        std::streambuf& in = *file_.rdbuf();
        int c = in.sbumpc();
        while (c != EOF && separates(c)) c = in.sbumpc();
        std::string text;
        for (; c != EOF && !separates(c) && text.size() < 400; c = in.sbumpc()) text += static_cast<char>(c);
        if (text.empty()) throwBrokenOff(piece().file);
        return text;
    }

    [[noreturn]] void refuse(const std::string& text) const {
        throw InputError(piece().file.string(),
                         fmt::format("number {} of its voxels is '{}'; expected {}", number_,
                                     oneLine(text).substr(0, 40), nameOf(type_)));
    }

    template <class T>
    T parsed(const std::string& text) const {
        if constexpr (std::is_integral_v<T>) {
            T value = 0;
            const char *begin = text.data() + (text[0] == '+'), *end = text.data() + text.size();
            if (const auto r = std::from_chars(begin, end, value); r.ptr == end && r.ec == std::errc())
                return value;
        }
        std::size_t at = 0;
        const std::optional<double> value = takeNumber(text, at);
        if (!value || at != text.size()) refuse(text);
        if constexpr (std::is_integral_v<T>) {
            // 2^63 and 2^64 are doubles; the largest integers below them are not.
            const bool fits = *value >= static_cast<double>(std::numeric_limits<T>::min()) &&
                              *value < std::ldexp(1.0, std::numeric_limits<T>::digits);
            if (!fits || *value != std::floor(*value)) refuse(text);
        }
        return static_cast<T>(*value);
    }

    void next(char* to, std::int64_t count) override {
        withType(type_, [&]<class T>(T) {
            for (; count > 0; count -= static_cast<std::int64_t>(sizeof(T)), to += sizeof(T), ++number_) {
                const T value = parsed<T>(word());
                std::memcpy(to, &value, sizeof(T));
            }
        });
    }

    ValueType type_;
    std::ifstream file_;
    std::int64_t number_ = 0;
};

class HexBytes : public ForwardBytes {
  public:
    using ForwardBytes::ForwardBytes;

  private:
    void restart() override {
        file_ = std::ifstream(piece().file, std::ios::binary);
        file_.seekg(piece().start);
    }

    int digit() {
        std::streambuf& in = *file_.rdbuf();
        int c = in.sbumpc();
        while (c != EOF && c <= ' ') c = in.sbumpc();
        if (c == EOF) throwBrokenOff(piece().file);
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        if (c >= 'A' && c <= 'F') return c - 'A' + 10;
        throw InputError(piece().file.string(),
                         fmt::format("'{}' stands among its voxels; expected hexadecimal digits",
                                     oneLine(std::string(1, static_cast<char>(c)))));
    }

    void next(char* to, std::int64_t count) override {
        for (; count > 0; --count, ++to) {
            const int high = digit();
            *to = static_cast<char>(high << 4 | digit());
        }
    }

    std::ifstream file_;
};

std::unique_ptr<VoxelBytes> openPiece(const VoxelLayout& layout, const VoxelPiece& piece, ValueType type,
                                      std::int64_t total) {
    switch (layout.encoding) {
        case Encoding::raw:
            return std::make_unique<RawBytes>(piece);
        case Encoding::deflated:
            return std::make_unique<DeflatedBytes>(piece, total);
        case Encoding::text:
            return std::make_unique<TextBytes>(piece, type, total);
        case Encoding::hex:
            break;
    }
    return std::make_unique<HexBytes>(piece, total);
}

// Files one after another; one of them is open at a time.
class JoinedBytes : public VoxelBytes {
  public:
    JoinedBytes(const VoxelLayout& layout, ValueType type, std::int64_t each)
        : layout_(layout), type_(type), each_(each) {}

    void read(std::int64_t at, char* to, std::int64_t count) override {
        for (std::int64_t n; count > 0; at += n, to += n, count -= n) {
            n = std::min(count, each_ - at % each_);
            piece(at / each_).read(at % each_, to, n);
        }
    }

  private:
    VoxelBytes& piece(std::int64_t number) {
        if (!open_ || number != number_)
            open_ = openPiece(layout_, layout_.pieces[static_cast<std::size_t>(number)], type_, each_);
        number_ = number;
        return *open_;
    }

    VoxelLayout layout_;
    ValueType type_;
    std::int64_t each_, number_ = 0;
    std::unique_ptr<VoxelBytes> open_;
};

// The fewest characters that hold so many numbers: a digit and a blank each, the last blank spared; two digits a byte.
std::int64_t leastCharacters(Encoding encoding, ValueType type, std::int64_t bytes) {
    if (encoding == Encoding::hex) return 2 * bytes;
    return 2 * (bytes / static_cast<std::int64_t>(sizeOf(type))) - 1;
}

}  // namespace

void putBehindHeader(VoxelLayout& voxels, const fs::path& file, std::int64_t start, bool asItIs) {
    if (!isGzip(file)) {
        voxels.pieces = {VoxelPiece{file, start, 0}};
        return;
    }
    if (voxels.encoding != Encoding::raw || !asItIs)
        throw InputError(
            file.string(),
            "is compressed by gzip, and its voxels do not lie in it as they are; gunzip it first: "
            "gunzip -k " +
                inShell(file.string()));
    voxels.encoding = Encoding::deflated;
    voxels.pieces = {VoxelPiece{file, 0, start}};
}

std::unique_ptr<VoxelBytes> openVoxelBytes(const VoxelLayout& layout, ValueType type, std::int64_t total) {
    if (layout.pieces.size() == 1) return openPiece(layout, layout.pieces[0], type, total);
    return std::make_unique<JoinedBytes>(layout, type,
                                         total / static_cast<std::int64_t>(layout.pieces.size()));
}

void checkVoxelBytes(const fs::path& header, const VoxelLayout& layout, ValueType type, std::int64_t total,
                     const std::string& promise) {
    const std::int64_t each = total / static_cast<std::int64_t>(layout.pieces.size());
    for (const VoxelPiece& piece : layout.pieces) {
        if (piece.file != header) requireFile(header, piece.file);
        if (layout.encoding == Encoding::raw)
            checkPlain(piece.file, piece.start, piece.skip + each, promise);
        else if (layout.encoding == Encoding::deflated)
            checkDeflated(piece.file, piece.start, piece.skip + each, promise);
        else
            checkPlain(piece.file, piece.start, leastCharacters(layout.encoding, type, each),
                       promise + " as text");
    }
}

}  // namespace isowave::imageio
