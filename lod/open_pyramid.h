// Pyramids and packed solids that somebody made before.
#pragma once

#include <filesystem>
#include <string>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// A packed solid (.iwz) becomes a field, whose steps are made of it as they are of any solid's; anything else is read as a
// pyramid's file, from options.finestStep on.
Solid::State openPyramid(const std::filesystem::path& path, const SolidOptions& options,
                         const Progress& progress, StageClock& clock);

// name: what messages and reports call it.
Solid::State stateOf(wavelets::Pyramid pyramid, const std::string& name);

}  // namespace isowave::lod
