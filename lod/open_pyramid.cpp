#include "lod/open_pyramid.h"

#include <fmt/format.h>

#include "compress/packed_file.h"
#include "lod/packing/pack.h"
#include "lod/source.h"
#include "wavelets/pyramid_file.h"

namespace isowave::lod {
namespace {

using Source = std::map<std::string, std::string>;

// Puts the solid's field or pyramid in, and returns what its file says of where it came from.
Source read(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress,
            Solid::State& solid) {
    if (!compress::isPackedPath(path)) {
        solid.pyramid = wavelets::readPyramid(path, options.finestStep);
        return solid.pyramid->source;
    }
    compress::PackedField packed = compress::readPacked(path, mostPackedPoints(options.maxMemory), progress);
    if (packed.bound)
        progress.say(fmt::format("{}: level 0 is within {:g} voxels of what was packed, not to the bit",
                                 path.string(), *packed.bound));
    solid.field = std::move(packed.field);
    return packed.source;
}

}  // namespace

Solid::State openPyramid(const std::filesystem::path& path, const SolidOptions& options,
                         const Progress& progress, StageClock& clock) {
    const StageClock::Scope scope(clock, "read");
    Solid::State solid;
    const Source source = read(path, options, progress, solid);
    InputReport& input = solid.input;
    input.path = path.string();
    input.kind = InputReport::Kind::pyramid;
    input.source = source;
    input.madeFrom = inputOfSource(source);
    solid.fit = fitOfSource(source);
    if (!input.madeFrom) return solid;
    input.dimensions = input.madeFrom->dimensions;
    input.spacing = input.madeFrom->spacing;
    input.iso = input.madeFrom->iso;
    input.volume = input.madeFrom->volume;
    input.space = input.madeFrom->space;
    solid.openBorder = borderOf(*input.madeFrom);
    solid.space = input.space.value_or(Space::unspecified);
    return solid;
}

}  // namespace isowave::lod
