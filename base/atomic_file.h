// A file that appears whole or not at all: written under a temporary name beside its place, renamed at the
// end.
#pragma once

#include <filesystem>
#include <fstream>

namespace isowave {

// Use:   AtomicFile file("out/part.ply");  file.stream() << ...;  file.commit();
// Without commit() (an exception, a cancelled job) the temporary file is removed and the place is untouched.
class AtomicFile {
  public:
    // Opens PLACE.part-PID for writing; links are followed. Throws OperationError when that fails (folder missing or
    // unwritable). Where PLACE is a device or a pipe (/dev/null, /dev/stdout) it is written to directly.
    explicit AtomicFile(std::filesystem::path place);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // Throws std::ios_base::failure on a failed write (disk full); commit() turns its own into
    // OperationError.
    std::ofstream& stream() { return stream_; }
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& place() const { return place_; }

    // Flushes to the disk, closes, renames. Throws OperationError and leaves the place untouched when the
    // disk is full or the rename fails.
    void commit();

  private:
    std::filesystem::path place_, temporary_;
    std::ofstream stream_;
    bool direct_ = false;  // place_ is no regular file: nothing to rename
    bool committed_ = false;
};

}  // namespace isowave
