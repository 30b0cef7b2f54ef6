// The bytes of a file, for several readers at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <streambuf>
#include <string_view>

namespace isowave {

class FileBytes {
  public:
    // expected: what the file should be, "a mesh file". Throws InputError: missing, a folder or a device, not to be opened.
    FileBytes(const std::filesystem::path& path, std::string_view expected);
    ~FileBytes();
    FileBytes(const FileBytes&) = delete;
    FileBytes& operator=(const FileBytes&) = delete;

    std::int64_t size() const { return size_; }
    // Bytes [at, at + count) as far as there are any; returns how many. Any number of threads may call it at once.
    std::size_t read(std::int64_t at, char* to, std::size_t count) const;

  private:
    int descriptor_ = -1;
    std::int64_t size_ = 0;
};

// A stream over them with a place and a buffer of its own, that throws std::ios_base::failure where it is asked for
// bytes that are not there. std::ifstream asks the system where it is at each tellg() and empties its buffer at each
// seekg(); OpenVDB does both once a leaf. Here a move within the buffer is a subtraction.
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
