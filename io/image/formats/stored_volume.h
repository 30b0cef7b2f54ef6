// What NIfTI, NRRD, MetaImage and MGH headers have in common: they place three axes by an affine map and say how numbers
// are stored. Each reader makes a StoredVolume of its header; what follows is the same for all of them.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "io/image/formats/voxel_bytes.h"
#include "io/image/source.h"

namespace isowave::imageio {

struct StoredVolume {
    Header
        header;  // of one volume: size, place; type is that of the stored numbers, before slope and intercept
    VoxelLayout voxels;
    std::string promise;      // where the header says how large it is, for messages: "'sizes' says 4 x 3 x 2"
    std::string volumesText;  // what the volumes are, where the header names them: "volume 1: liver"
};

// Opens it; options.volume chooses one of several volumes. Voxels that lie in one file as they are can be read a few slices
// at a time by several threads. Throws InputError for files that do not hold what the header promises, and for several
// volumes of which none is chosen.
SourcePtr openStored(const std::filesystem::path& path, StoredVolume volume, const ImageReadOptions& options);

// step[a]: one voxel along axis a, LPS, mm, of any direction and length.
void place(Header& header, const std::array<Vec3, 3>& step, const Vec3& origin);

// Millimetres in a unit by its name or abbreviation ("um", "micron", "metre", ...); nothing for what is no length.
std::optional<double> millimetresIn(std::string unit);

// Says that lengths in another unit than mm were turned into mm.
void remarkUnit(Header& header, const std::string& unit, double millimetres);

[[noreturn]] void throwFlat(const std::filesystem::path& path, std::int64_t x, std::int64_t y,
                            const std::string& remedy);
[[noreturn]] void throwNotScalar(const std::filesystem::path& path, const std::string& kind,
                                 std::int64_t numbers);

}  // namespace isowave::imageio
