// The bytes of a DICOM file from its first element on, at random places, inflated where its transfer syntax is
// deflated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace isowave::imageio {

class DicomBytes {
  public:
    // Throws InputError when the file cannot be opened.
    explicit DicomBytes(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    std::int64_t size() const { return size_; }
    // `count` bytes from byte `at`. Throws InputError where the file does not hold them.
    std::string read(std::int64_t at, std::int64_t count);
    // The same for a few bytes, through a window of 64 kB; fewer where the file ends.
    std::string_view peek(std::int64_t at, std::int64_t count);

    // From byte `at` on the file is a raw deflate stream (PS3.5 A.5): puts what it inflates to in its place. Throws
    // InputError for a stream that is damaged, breaks off or inflates to more than 2 GB.
    void inflateFrom(std::int64_t at);

  private:
    std::filesystem::path path_;
    std::ifstream file_;
    std::int64_t size_ = 0;
    std::string window_;  // what the file holds from byte windowAt_ on
    std::int64_t windowAt_ = 0;
    bool whole_ = false;  // the window is all there is
};

}  // namespace isowave::imageio
