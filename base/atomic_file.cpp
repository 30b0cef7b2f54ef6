#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/links.h"
#include "isowave/error.h"

namespace isowave {

namespace {
constexpr std::streamsize kBlockBytes = 1 << 18, kWriteBackEach = 8 << 20;
}

AtomicFile::Buffer::Buffer() : block_(std::make_unique_for_overwrite<char[]>(kBlockBytes)) {
    pubsetbuf(block_.get(), kBlockBytes);
}

AtomicFile::Buffer::~Buffer() {
    close();  // while there is a block
    if (descriptor_ >= 0) ::close(descriptor_);
}

void AtomicFile::Buffer::writeBackEarly(const std::filesystem::path& file) {
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
}

bool AtomicFile::Buffer::waitForDisk() const {
    return descriptor_ < 0 || ::fsync(descriptor_) == 0 || errno == EINVAL || errno == EROFS;
}

std::streamsize AtomicFile::Buffer::xsputn(const char* bytes, std::streamsize count) {
    const std::streamsize written = std::filebuf::xsputn(bytes, count);
    notStarted_ += written;
    if (descriptor_ >= 0 && notStarted_ >= kWriteBackEach) {
#ifdef __linux__
        ::sync_file_range(descriptor_, 0, /*to the end*/ 0, SYNC_FILE_RANGE_WRITE);
#endif
        notStarted_ = 0;
    }
    return written;
}

AtomicFile::AtomicFile(std::filesystem::path place) : place_(behindLinks(place)) {
    std::error_code error;
    const auto status = std::filesystem::status(place_, error);
    if (std::filesystem::is_directory(status))
        throw OperationError(place_.string(), "is a folder; give the name of a file to write");
    direct_ = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    temporary_ = place_;
    if (!direct_) temporary_ += ".part-" + std::to_string(::getpid());
    errno = 0;
    if (!buffer_.open(temporary_, std::ios::binary | std::ios::trunc | std::ios::out))
        throw OperationError(place_.string(), std::string("cannot write here (") + std::strerror(errno) +
                                                  "); check that the folder exists and is writable");
    if (!direct_) buffer_.writeBackEarly(temporary_);
    stream_.exceptions(std::ios::badbit | std::ios::failbit);
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    buffer_.close();
    if (direct_) return;
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit(bool wait) {
    errno = 0;
    if (!stream_ || buffer_.pubsync() != 0 || !buffer_.close())
        throw OperationError(place_.string(), std::string("writing failed (") + std::strerror(errno) +
                                                  "); is the disk full? Nothing was left behind");
    committed_ = direct_;
    if (direct_) return;
    // Data on the disk before the name: a power cut must not leave an empty file under the good name.
    if (wait && !buffer_.waitForDisk())
        throw OperationError(place_.string(),
                             std::string("writing failed (") + std::strerror(errno) + "); is the disk full?");
    std::error_code error;
    std::filesystem::rename(temporary_, place_, error);
    if (error)
        throw OperationError(place_.string(), "cannot put the finished file here (" + error.message() + ")");
    committed_ = true;
}

}  // namespace isowave
