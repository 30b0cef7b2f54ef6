// A file that appears whole or not at all: written under a temporary name beside its place, renamed at the
// end.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>

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
    std::ostream& stream() { return stream_; }
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& place() const { return place_; }

    // Flushes to the disk, closes, renames. Throws OperationError and leaves the place untouched when the
    // disk is full or the rename fails.
    void commit();

  private:
    // Has the disk begin with what was written while the rest is being made, for commit() waits for the disk (137 MB: 120 ms
    // of 440), and gathers small writes.
    class Buffer : public std::filebuf {
      public:
        Buffer();
        ~Buffer() override;
        // From now on the disk begins early. Where this does not succeed it begins, and ends, when it likes.
        void watchDisk(const std::filesystem::path& file);
        // Returns when all that was written to the file is on the disk; false where the disk is full or broken.
        bool waitForDisk() const;

      protected:
        std::streamsize xsputn(const char* bytes, std::streamsize count) override;

      private:
        std::unique_ptr<char[]> block_;
        int descriptor_ = -1;
        std::streamsize notBegun_ = 0;  // bytes
    };

    std::filesystem::path place_, temporary_;
    Buffer buffer_;
    std::ostream stream_{&buffer_};
    bool direct_ = false;  // place_ is no regular file: nothing to rename
    bool committed_ = false;
};

}  // namespace isowave
