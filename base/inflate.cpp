#include "base/inflate.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "base/number_text.h"
#include "base/text.h"
#include "isowave/error.h"

namespace isowave {

struct InflateStream::Zlib {
    explicit Zlib(DeflateWrapper wrapper) {
        constexpr int kWindowBits = 15, kEitherHeader = 32;
        opened = inflateInit2(&stream, wrapper == DeflateWrapper::none ? -kWindowBits
                                                                       : kWindowBits + kEitherHeader) == Z_OK;
    }
    ~Zlib() {
        if (opened) inflateEnd(&stream);
    }
    Zlib(const Zlib&) = delete;
    Zlib& operator=(const Zlib&) = delete;

    z_stream stream{};
    bool opened = false;
};

InflateStream::InflateStream(DeflateWrapper wrapper) : zlib_(std::make_unique<Zlib>(wrapper)) {}
InflateStream::~InflateStream() = default;
InflateStream::InflateStream(InflateStream&&) noexcept = default;
InflateStream& InflateStream::operator=(InflateStream&&) noexcept = default;

InflateStream::State InflateStream::inflate(std::string_view& in, std::span<char>& out) {
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // zlib counts in 32 bits
    z_stream& z = zlib_->stream;
    int status = zlib_->opened ? Z_OK : Z_MEM_ERROR;
    // Once at least: zlib may hold bytes back for want of room. Where nothing moves it says Z_BUF_ERROR.
    do {
        const std::size_t given = std::min(in.size(), kMostAtOnce), room = std::min(out.size(), kMostAtOnce);
        z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));  // zlib only reads it
        z.avail_in = static_cast<uInt>(given);
        z.next_out = reinterpret_cast<Bytef*>(out.data());
        z.avail_out = static_cast<uInt>(room);
        if (status == Z_OK) status = ::inflate(&z, Z_NO_FLUSH);
        in.remove_prefix(given - z.avail_in);
        out = out.subspan(room - z.avail_out);
    } while (status == Z_OK && !in.empty() && !out.empty());
    if (status == Z_STREAM_END) return State::ended;
    return status == Z_OK || status == Z_BUF_ERROR ? State::going : State::damaged;
}

void InflateStream::restart() { inflateReset(&zlib_->stream); }

std::string InflateStream::complaint() const {
    return zlib_->stream.msg ? zlib_->stream.msg : "no zlib or gzip stream";
}

std::filesystem::path withoutGz(const std::filesystem::path& path) {
    if (toLower(path.extension().string()) != ".gz") return path;
    return path.parent_path() / path.stem();
}

namespace {

class Gunzip {
  public:
    Gunzip(std::string_view packed, const std::string& name, std::size_t most)
        : packed_(packed), left_(packed), name_(name), most_(most) {}

    std::string run() {
        bytes_.resize(firstSize());
        while (!left_.empty()) {
            member();
            if (left_.find_first_not_of('\0') == left_.npos) break;
            if (!isGzip(left_))
                fail(
                    fmt::format("{} bytes behind the end of its gzip stream are none; it is damaged, or two "
                                "files in one",
                                left_.size()));
            stream_.restart();
        }
        refuseTooLarge();
        bytes_.resize(held_);
        return std::move(bytes_);
    }

  private:
    // Up to the end of one stream.
    void member() {
        for (auto state = InflateStream::State::going; state != InflateStream::State::ended;) {
            if (held_ == bytes_.size()) grow();
            std::span<char> room(bytes_.data() + held_, bytes_.size() - held_);
            const std::size_t before = room.size();
            state = stream_.inflate(left_, room);
            held_ += before - room.size();
            if (state == InflateStream::State::damaged)
                fail(fmt::format("its gzip stream is damaged ({}); copy or download it again",
                                 stream_.complaint()));
            if (state == InflateStream::State::going && left_.empty() && !room.empty())
                fail(
                    fmt::format("its gzip stream breaks off after {}; it is truncated: copy or download it "
                                "again",
                                bytesText(static_cast<double>(held_))));
        }
    }

    // The last 4 bytes are the length of the last stream modulo 2^32: of a whole file's, nearly always. One byte more, so that
    // the stream's end is found without growing. A length that few files have is not believed: the file may be damaged.
    std::size_t firstSize() const {
        constexpr std::size_t kShortest = 18, kUsualRatio = 16;
        std::size_t says = 0;
        for (std::size_t i = 4; packed_.size() >= kShortest && i > 0; --i)
            says = says << 8 | static_cast<unsigned char>(packed_[packed_.size() - 5 + i]);
        says = std::min(says, most_);
        return says / kUsualRatio > packed_.size() ? kFirstBlock : says + 1;
    }

    void refuseTooLarge() const {
        const auto refuse = [&](const std::string& what) {
            fail(fmt::format("is gzip of {} that inflates to more than {}",
                             bytesText(static_cast<double>(packed_.size())), what));
        };
        if (held_ > most_)
            refuse(bytesText(static_cast<double>(most_)) +
                   ", the limit of memory; give a larger --max-memory, or gunzip it first");
        if (held_ > kSuspicious && held_ / kMostRatio > packed_.size())
            refuse(fmt::format(
                "{} times as much, which no mesh and no image does; gunzip it and look whether it is "
                "what it should be",
                kMostRatio));
    }

    // REQUIRES: `bytes_` is full.
    void grow() {
        refuseTooLarge();
        const std::size_t wanted = std::max(2 * held_, kFirstBlock);
        bytes_.resize(std::max(held_ + 1, std::min(wanted, most_)));
    }

    [[noreturn]] void fail(const std::string& what) const { throw InputError(name_, what); }

    static constexpr std::size_t kFirstBlock = 1 << 16, kSuspicious = std::size_t{1} << 28, kMostRatio = 250;

    std::string_view packed_, left_;
    const std::string& name_;
    std::size_t most_, held_ = 0;
    InflateStream stream_;
    std::string bytes_;
};

}  // namespace

std::string gunzipped(std::string_view packed, const std::string& name, std::size_t most) {
    return Gunzip(packed, name, most).run();
}

}  // namespace isowave
