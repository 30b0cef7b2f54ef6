#include "io/image/formats/npy_volume.h"

#include <fmt/format.h>

#include "io/image/check.h"
#include "io/image/formats/stored_volume.h"
#include "io/image/half.h"
#include "io/image/header.h"
#include "io/image/reversed_axes.h"
#include "io/picture/npy.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

void requireAxes(const fs::path& path, const NpyHeader& npy) {
    const std::size_t axes = npy.shape.size();
    if (axes == 2)
        throwFlat(path, static_cast<std::int64_t>(npy.shape[0]), static_cast<std::int64_t>(npy.shape[1]), "");
    if (axes != 3 && axes != 4)
        throw InputError(
            path.string(),
            fmt::format("has the shape {}; a volume has (x, y, z), or (x, y, z, volumes)", npy.shapeText));
}

// In C order the axes as they lie in the file: z fastest.
StoredVolume storedOf(const fs::path& path, const NpyHeader& npy) {
    StoredVolume volume;
    Header& header = volume.header;
    header.format = "NumPy";
    header.type = npy.type;
    for (std::size_t a = 0; a < 3; ++a)
        header.size[npy.fortran ? a : 2 - a] = static_cast<std::int64_t>(npy.shape[a]);
    const auto volumes = npy.shape.size() > 3 ? static_cast<std::int64_t>(npy.shape[3]) : 1;
    (npy.fortran ? volume.voxels.outer : volume.voxels.inner) = volumes;
    volume.voxels.bigEndian = npy.bigEndian;
    putBehindHeader(volume.voxels, path, static_cast<std::int64_t>(npy.data));
    volume.promise = "its shape says " + npy.shapeText;
    return volume;
}

}  // namespace

SourcePtr openNpyVolume(const fs::path& path, const ImageReadOptions& options) {
    const NpyHeader npy = readNpyHeader(headerFileText(path), path.string());
    requireAxes(path, npy);
    SourcePtr source = openStored(path, storedOf(path, npy), options);
    if (!npy.fortran) source = withAxesReversed(std::move(source));
    if (npy.half) source = halvesAsFloats(std::move(source));
    Header& header = source->header;
    header.axis = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    header.hasZSpacing = false;
    header.space = Space::unspecified;
    header.warnings.push_back(
        "its indices are taken as x, y, z, and may be mirrored: a NumPy array names no axes");
    return source;
}

}  // namespace isowave::imageio
