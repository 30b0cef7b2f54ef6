#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/links.h"

namespace isowave {

AtomicFile::AtomicFile(std::filesystem::path place) : place_(behindLinks(place)) {
    std::error_code error;
    const auto status = std::filesystem::status(place_, error);
    if (std::filesystem::is_directory(status))
        throw OperationError(place_.string(), "is a folder; give the name of a file to write");
    direct_ = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    temporary_ = place_;
    if (!direct_) temporary_ += ".part-" + std::to_string(::getpid());
    errno = 0;
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    if (!stream_)
        throw OperationError(place_.string(), std::string("cannot write here (") + std::strerror(errno) +
                                                  "); check that the folder exists and is writable");
    stream_.exceptions(std::ios::badbit | std::ios::failbit);
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    stream_.exceptions(std::ios::goodbit);
    stream_.close();
    if (direct_) return;
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    errno = 0;
    try {
        stream_.flush();
        stream_.close();
    } catch (const std::ios_base::failure&) {
        throw OperationError(place_.string(), std::string("writing failed (") + std::strerror(errno) +
                                                  "); is the disk full? Nothing was left behind");
    }
    committed_ = direct_;
    if (direct_) return;
    // Data on the disk before the name: a power cut must not leave an empty file under the good name.
    if (const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC); fd >= 0) {
        const int failed = ::fsync(fd);
        ::close(fd);
        if (failed != 0 && errno != EINVAL && errno != EROFS)
            throw OperationError(place_.string(), std::string("writing failed (") + std::strerror(errno) +
                                                      "); is the disk full?");
    }
    std::error_code error;
    std::filesystem::rename(temporary_, place_, error);
    if (error)
        throw OperationError(place_.string(), "cannot put the finished file here (" + error.message() + ")");
    committed_ = true;
}

}  // namespace isowave
