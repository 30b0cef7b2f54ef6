// Headerless voxels.
#include <fmt/format.h>

#include <algorithm>

#include "isowave/error.h"
#include "io/image/source.h"

namespace isowave::imageio {
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
    if (held > needed)
        header.warnings.push_back(
            fmt::format("the file holds {} bytes more than {} {} voxels take; is the size right?",
                        held - needed, sizeText(layout.size), nameOf(*type)));
    return openPlain({path, layout.headerBytes, layout.bigEndian}, header);
}

}  // namespace isowave::imageio
