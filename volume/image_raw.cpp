// Headerless voxels.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <fstream>

#include "base/error.h"
#include "volume/image_source.h"

namespace isowave::imageio {
namespace {

// ~64 MB of the file at a time.
constexpr std::int64_t kSlabBytes = std::int64_t(64) << 20;

class RawSource : public VoxelSource {
  public:
    RawSource(const std::filesystem::path& path, const RawLayout& layout)
        : name_(path.string()),
          file_(path, std::ios::binary),
          start_(layout.headerBytes),
          swap_(layout.bigEndian != (std::endian::native == std::endian::big)) {}

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        const auto bytes = static_cast<std::int64_t>(sizeOf(header.type));
        const std::int64_t count = (z1 - z0) * header.sliceVoxels();
        buffer_.resize(static_cast<std::size_t>(count * bytes));
        file_.seekg(start_ + z0 * header.sliceVoxels() * bytes);
        if (!file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size())))
            throw InputError(name_, "reading failed in the midst of the file; was it cut meanwhile?");
        return convert(header.type, buffer_.data(), count, swap_, out);
    }

  private:
    std::string name_;
    std::ifstream file_;
    std::int64_t start_;
    bool swap_;
    std::vector<char> buffer_;
};

}  // namespace

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
    auto source = std::make_unique<RawSource>(path, layout);
    Header& header = source->header;
    header.format = "raw";
    header.size = layout.size;
    header.type = *type;
    header.hasZSpacing = false;
    if (held > needed)
        header.warnings.push_back(
            fmt::format("the file holds {} bytes more than {} {} voxels take; is the size right?",
                        held - needed, sizeText(layout.size), nameOf(*type)));
    const std::int64_t sliceBytes = header.sliceVoxels() * static_cast<std::int64_t>(sizeOf(*type));
    source->slicesPerRead = std::clamp<std::int64_t>(kSlabBytes / sliceBytes, 1, header.size[2]);
    return source;
}

}  // namespace isowave::imageio
