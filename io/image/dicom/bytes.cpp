#include "io/image/dicom/bytes.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/inflate.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

constexpr std::int64_t kWindow = 1 << 16;
constexpr std::size_t kMostInflated = std::size_t(1) << 31;

// The end of a raw deflate stream may be followed by anything. Returns false for one that breaks off or is damaged.
bool inflateRaw(std::string_view in, std::string& out) {
    InflateStream stream(DeflateWrapper::none);
    std::string block(1 << 18, '\0');
    auto state = InflateStream::State::going;
    for (std::size_t came = 1;
         state == InflateStream::State::going && came > 0 && out.size() < kMostInflated;) {
        std::span<char> room(block);
        state = stream.inflate(in, room);
        came = block.size() - room.size();
        out.append(block, 0, came);
    }
    return state == InflateStream::State::ended;
}

}  // namespace

DicomBytes::DicomBytes(const std::filesystem::path& path)
    : path_(path),
      file_(path, std::ios::binary),
      size_(static_cast<std::int64_t>(std::filesystem::file_size(path))) {
    if (!file_) throw InputError(path.string(), "cannot be opened; check its permissions");
}

std::string DicomBytes::read(std::int64_t at, std::int64_t count) {
    if (at < 0 || count < 0 || count > size_ - at)
        throw InputError(path_.string(),
                         fmt::format("{} bytes are expected at byte {} of {}; it is truncated or damaged",
                                     count, at, size_));
    if (whole_) return window_.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(count));
    std::string bytes(static_cast<std::size_t>(count), '\0');
    file_.clear();
    file_.seekg(at);
    file_.read(bytes.data(), count);
    if (file_.gcount() != count)
        throw InputError(path_.string(), fmt::format("cannot be read at byte {}; try again", at));
    return bytes;
}

std::string_view DicomBytes::peek(std::int64_t at, std::int64_t count) {
    if (at < 0 || at >= size_) return {};
    count = std::min(count, size_ - at);
    const auto held = static_cast<std::int64_t>(window_.size());
    if (at < windowAt_ || at + count > windowAt_ + held) {
        window_ = read(at, std::min(std::max(kWindow, count), size_ - at));
        windowAt_ = at;
    }
    return std::string_view(window_).substr(static_cast<std::size_t>(at - windowAt_),
                                            static_cast<std::size_t>(count));
}

void DicomBytes::inflateFrom(std::int64_t at) {
    std::string all = read(0, at);
    const std::string deflated = read(at, size_ - at);
    if (!inflateRaw(deflated, all))
        throw InputError(path_.string(),
                         "its deflated data set breaks off, is damaged or inflates to more than 2 GB");
    window_ = std::move(all);
    windowAt_ = 0;
    whole_ = true;
    size_ = static_cast<std::int64_t>(window_.size());
}

}  // namespace isowave::imageio
