#include "base/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

#include "isowave/error.h"

namespace isowave {

FileDescriptor::FileDescriptor(const std::filesystem::path& path, std::string_view expected) {
    const std::string name = path.string();
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        throw InputError(name, error ? "cannot be looked at (" + error.message() + ")" : "no such file");
    if (std::filesystem::is_directory(path, error))
        throw InputError(name, fmt::format("is a folder; expected {}", expected));
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw InputError(name, "cannot be opened; check its permissions");
}

FileDescriptor::~FileDescriptor() { ::close(descriptor_); }

FileBytes::FileBytes(const std::filesystem::path& path, std::string_view expected) : file_(path, expected) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError(path.string(), fmt::format("is not a file; expected {}", expected));
    size_ = static_cast<std::int64_t>(std::filesystem::file_size(path));
}

bool FileBytes::isHole(std::int64_t begin, std::int64_t end) const {
    if (::lseek(file_.get(), 0, SEEK_END) < end) return false;
    const off_t data = ::lseek(file_.get(), begin, SEEK_DATA);
    return data < 0 ? errno == ENXIO : data >= end;
}

std::size_t FileBytes::read(std::int64_t at, char* to, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
        const ssize_t got =
            ::pread(file_.get(), to + done, count - done, at + static_cast<std::int64_t>(done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

namespace {
constexpr std::size_t kBlockBytes = 1 << 18;  // fits the second-level cache; larger ones were no faster
}

FileStream::Buffer::Buffer(const FileBytes& bytes)
    : bytes_(bytes), block_(std::make_unique_for_overwrite<char[]>(kBlockBytes)) {}

FileStream::Buffer::int_type FileStream::Buffer::underflow() {
    const std::size_t count = bytes_.read(end_, block_.get(), kBlockBytes);
    end_ += static_cast<std::int64_t>(count);
    setg(block_.get(), block_.get(), block_.get() + count);
    return count > 0 ? traits_type::to_int_type(*gptr()) : traits_type::eof();
}

FileStream::Buffer::pos_type FileStream::Buffer::seekoff(off_type offset, std::ios_base::seekdir from,
                                                         std::ios_base::openmode which) {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::end ? bytes_.size()
                                                       : end_ - (egptr() - gptr());
    return seekpos(base + offset, which);
}

FileStream::Buffer::pos_type FileStream::Buffer::seekpos(pos_type place, std::ios_base::openmode) {
    const std::int64_t to = place, begin = end_ - (egptr() - eback());
    if (to < 0) return pos_type(off_type(-1));
    if (to >= begin && to <= end_) {
        setg(eback(), eback() + (to - begin), egptr());
    } else {
        setg(nullptr, nullptr, nullptr);
        end_ = to;
    }
    return place;
}

FileStream::FileStream(const FileBytes& bytes) : std::istream(nullptr), buffer_(bytes) {
    rdbuf(&buffer_);  // which also clears the failure that a null buffer is
    exceptions(std::ios::failbit | std::ios::badbit);
}

}  // namespace isowave
