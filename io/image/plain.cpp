// Voxels that lie in a file as they are: headerless ones, and those of uncompressed NRRD, MetaImage and NIfTI.
//
// Read with pread(), not mapped: pages of a mapped file count as the process's own memory until the kernel
// takes them back, and a file that is cut meanwhile ends the program.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include "isowave/error.h"
#include "io/image/source.h"

namespace isowave::imageio {
namespace {

// ~64 MB of the file at a time.
constexpr std::int64_t kMostBytes = std::int64_t(64) << 20;

class File {
  public:
    explicit File(const std::filesystem::path& path)
        : name_(path.string()), file_(::open(path.c_str(), O_RDONLY)) {
        if (file_ < 0) throw InputError(name_, std::string("cannot be opened: ") + std::strerror(errno));
    }
    ~File() { ::close(file_); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    void read(std::int64_t start, std::size_t count, char* out) const {
        while (count > 0) {
            const ssize_t got = ::pread(file_, out, count, start);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) throw InputError(name_, std::string("cannot be read: ") + std::strerror(errno));
            if (got == 0)
                throw InputError(name_, "reading failed in the midst of the file; was it cut meanwhile?");
            out += got;
            start += got;
            count -= static_cast<std::size_t>(got);
        }
    }
    // Whether the file system says that the bytes were never written.
    bool isHole(std::int64_t start, std::int64_t end) const {
        if (::lseek(file_, 0, SEEK_END) < end) return false;
        const off_t data = ::lseek(file_, start, SEEK_DATA);
        return data < 0 ? errno == ENXIO : data >= end;
    }

  private:
    std::string name_;
    int file_;
};

template <std::size_t kBytes>
void reverseEach(char* values, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i, values += kBytes) std::reverse(values, values + kBytes);
}

void reverseBytes(std::size_t bytesEach, char* values, std::int64_t count) {
    if (bytesEach == 2) reverseEach<2>(values, count);
    if (bytesEach == 4) reverseEach<4>(values, count);
    if (bytesEach == 8) reverseEach<8>(values, count);
}

class PlainSource : public VoxelSource {
  public:
    PlainSource(const PlainData& data, const Header& from)
        : file_(data.file),
          start_(data.start),
          swap_(data.bigEndian != (std::endian::native == std::endian::big)) {
        header = from;
        native = plain = true;
        slicesPerRead = std::clamp<std::int64_t>(kMostBytes / sliceBytes(), 1, header.size[2]);
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* values = static_cast<char*>(out);
        file_.read(start_ + z0 * sliceBytes(), static_cast<std::size_t>((z1 - z0) * sliceBytes()), values);
        if (swap_) reverseBytes(sizeOf(header.type), values, (z1 - z0) * header.sliceVoxels());
    }

    bool isZero(std::int64_t z0, std::int64_t z1) override {
        return file_.isHole(start_ + z0 * sliceBytes(), start_ + z1 * sliceBytes());
    }

  private:
    std::int64_t sliceBytes() const {
        return header.sliceVoxels() * static_cast<std::int64_t>(sizeOf(header.type));
    }

    File file_;
    std::int64_t start_;
    bool swap_;
};

}  // namespace

SourcePtr openPlain(const PlainData& data, const Header& header) {
    return std::make_unique<PlainSource>(data, header);
}

}  // namespace isowave::imageio
