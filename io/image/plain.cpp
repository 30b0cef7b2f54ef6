#include "io/image/plain.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include "base/file_bytes.h"
#include "io/image/check.h"
#include "isowave/error.h"

// Read with pread(), not mapped: pages of a mapped file count as the process's own memory until the kernel
// takes them back, and a file that is cut meanwhile ends the program.

namespace isowave::imageio {
namespace {

// ~64 MB of the file at a time.
constexpr std::int64_t kMostBytes = std::int64_t(64) << 20;

template <std::size_t kBytes>
void reverseEach(char* values, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i, values += kBytes) std::reverse(values, values + kBytes);
}

}  // namespace

void reverseBytes(std::size_t bytesEach, char* values, std::int64_t count) {
    if (bytesEach == 2) reverseEach<2>(values, count);
    if (bytesEach == 4) reverseEach<4>(values, count);
    if (bytesEach == 8) reverseEach<8>(values, count);
}

namespace {

class PlainSource : public VoxelSource {
  public:
    PlainSource(const PlainData& data, const Header& from)
        : name_(data.file.string()),
          file_(data.file, "voxels"),
          start_(data.start),
          swap_(data.bigEndian != (std::endian::native == std::endian::big)) {
        header = from;
        native = plain = true;
        slicesPerRead = std::clamp<std::int64_t>(kMostBytes / sliceBytes(), 1, header.size[2]);
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        auto* values = static_cast<char*>(out);
        const auto count = static_cast<std::size_t>((z1 - z0) * sliceBytes());
        errno = 0;
        if (file_.read(start_ + z0 * sliceBytes(), values, count) < count)
            throw InputError(name_, errno != 0
                                        ? std::string("cannot be read: ") + std::strerror(errno)
                                        : "reading failed in the midst of the file; was it cut meanwhile?");
        if (swap_) reverseBytes(sizeOf(header.type), values, (z1 - z0) * header.sliceVoxels());
    }

    bool isZero(std::int64_t z0, std::int64_t z1) override {
        return file_.isHole(start_ + z0 * sliceBytes(), start_ + z1 * sliceBytes());
    }

  private:
    std::int64_t sliceBytes() const {
        return header.sliceVoxels() * static_cast<std::int64_t>(sizeOf(header.type));
    }

    std::string name_;
    FileBytes file_;
    std::int64_t start_;
    bool swap_;
};

}  // namespace

SourcePtr openPlain(const PlainData& data, const Header& header) {
    return std::make_unique<PlainSource>(data, header);
}

SourcePtr openRaw(const std::filesystem::path& path, const ImageReadOptions& options) {
    const std::string name = path.string();
    const RawLayout& layout = *options.raw;
    const std::optional<ValueType> type = valueTypeOf(layout.type);
    if (!type)
        throw InputError(
            name, fmt::format("its voxels are said to be '{}'; expected int8, uint8, int16, uint16, int32, "
                              "uint32, int64, uint64, float32 or float64",
                              oneLine(layout.type)));
    if (layout.headerBytes < 0)
        throw InputError(name, fmt::format("a header of {} bytes; expected 0 or more", layout.headerBytes));
    const auto held = static_cast<std::int64_t>(std::filesystem::file_size(path)) - layout.headerBytes;
    const std::int64_t needed = byteCount(name, {layout.size[0], layout.size[1], layout.size[2]},
                                          static_cast<std::int64_t>(sizeOf(*type)));
    if (held < needed)
        throw InputError(
            name, fmt::format("{} {} voxels take {} bytes but the file holds {} after a header of {}; it is "
                              "truncated, or size, type or header are wrong",
                              sizeText(layout.size), nameOf(*type), needed, std::max<std::int64_t>(held, 0),
                              layout.headerBytes));
    Header header;
    header.format = "raw";
    header.size = layout.size;
    header.type = *type;
    header.hasZSpacing = false;
    header.space = Space::unspecified;
    if (held > needed)
        header.warnings.push_back(
            fmt::format("the file holds {} bytes more than {} {} voxels take; is the size right?",
                        held - needed, sizeText(layout.size), nameOf(*type)));
    return openPlain({path, layout.headerBytes, layout.bigEndian}, header);
}

}  // namespace isowave::imageio
