// The bytes of a file, for several threads at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <streambuf>
#include <string_view>

namespace isowave {

// A file opened for reading. Every reader that gives its own messages begins with it.
class FileDescriptor {
  public:
    // expected: what the file should be, "a mesh file". Throws InputError, one line, when there is nothing of
    // that name, when it is a folder, and when it may not be opened.
    FileDescriptor(const std::filesystem::path& path, std::string_view expected);
    ~FileDescriptor();
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;

    int get() const { return descriptor_; }

  private:
    int descriptor_;
};

class FileBytes {
  public:
    // Throws InputError as FileDescriptor does, and for a device or a pipe.
    FileBytes(const std::filesystem::path& path, std::string_view expected);

    std::int64_t size() const { return size_; }
    // Bytes [at, at + count) as far as there are any; returns how many. Any number of threads may call it at
    // once.
    std::size_t read(std::int64_t at, char* to, std::size_t count) const;
    // Whether the file system says that bytes begin .. end - 1 were never written (a hole of a sparse file:
    // all 0).
    bool isHole(std::int64_t begin, std::int64_t end) const;

  private:
    FileDescriptor file_;
    std::int64_t size_ = 0;
};

// A stream over a FileBytes, with a position and a buffer of its own. It throws std::ios_base::failure where
// it is asked for bytes that are not there. std::ifstream makes a system call at each tellg() and empties its
// buffer at each seekg(), and OpenVDB calls both once a leaf; here a move within the buffer is a subtraction.
class FileStream : public std::istream {
  public:
    // REQUIRES: bytes outlives the stream.
    explicit FileStream(const FileBytes& bytes);

  private:
    class Buffer : public std::streambuf {
      public:
        explicit Buffer(const FileBytes& bytes);

      protected:
        int_type underflow() override;
        pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override;
        pos_type seekpos(pos_type place, std::ios_base::openmode which) override;

      private:
        const FileBytes& bytes_;
        std::unique_ptr<char[]> block_;
        std::int64_t end_ = 0;  // of the block in the file: where egptr() lies
    };
    Buffer buffer_;
};

}  // namespace isowave
