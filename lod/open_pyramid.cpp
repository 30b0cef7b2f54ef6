#include "lod/open_pyramid.h"

#include "lod/option_checks.h"
#include "lod/packing/pack.h"
#include "lod/source.h"
#include "wavelets/pyramid_file.h"

namespace isowave::lod {
namespace {

using Source = std::map<std::string, std::string>;

// Puts the solid's field or pyramid in, and returns what its file says of where it came from.
Source read(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress,
            Solid::State& solid) {
    requireAtLeast("finestStep", options.finestStep, 0);
    requireAtLeast("finestLevel", options.finestLevel, 0);
    if (!compress::isPackedPath(path)) {
        const int finest =
            options.finestLevel ? wavelets::readOrder(path).stepOf(*options.finestLevel) : options.finestStep;
        solid.pyramid = wavelets::readPyramid(path, finest);
        solid.order = solid.pyramid->order;
        return solid.pyramid->source;
    }
    PackedSolid packed = openPacked(path, options.maxMemory, progress);
    solid.field = std::move(packed.field);
    solid.order = std::move(packed.order);
    return packed.source;
}

// What its file says of where it came from.
void describe(Solid::State& solid, const std::string& name, const Source& source) {
    InputReport& input = solid.input;
    input.path = name;
    input.kind = InputReport::Kind::pyramid;
    input.source = source;
    input.madeFrom = inputOfSource(source);
    solid.fit = fitOfSource(source);
    if (!input.madeFrom) return;
    input.dimensions = input.madeFrom->dimensions;
    input.spacing = input.madeFrom->spacing;
    input.iso = input.madeFrom->iso;
    input.volume = input.madeFrom->volume;
    input.space = input.madeFrom->space;
    solid.openBorder = borderOf(*input.madeFrom);
    solid.space = input.space.value_or(Space::unspecified);
}

}  // namespace

Solid::State openPyramid(const std::filesystem::path& path, const SolidOptions& options,
                         const Progress& progress, StageClock& clock) {
    const StageClock::Scope scope(clock, "read");
    Solid::State solid;
    const Source source = read(path, options, progress, solid);
    describe(solid, path.string(), source);
    return solid;
}

Solid::State stateOf(wavelets::Pyramid pyramid, const std::string& name) {
    Solid::State solid;
    solid.order = pyramid.order;
    solid.pyramid = std::move(pyramid);
    describe(solid, name, solid.pyramid->source);
    return solid;
}

}  // namespace isowave::lod
