#include "lod/open_pyramid.h"

#include "lod/source.h"
#include "wavelets/pyramid_file.h"

namespace isowave::lod {

Solid::State openPyramid(const std::filesystem::path& path, int finestStep, StageClock& clock) {
    const StageClock::Scope scope(clock, "read");
    return stateOf(wavelets::readPyramid(path, finestStep), path.string());
}

Solid::State stateOf(wavelets::Pyramid pyramid, const std::string& name) {
    Solid::State solid;
    solid.pyramid = std::move(pyramid);
    const auto& source = solid.pyramid->source;
    InputReport& input = solid.input;
    input.path = name;
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
