// Pyramids that somebody made before.
#pragma once

#include <filesystem>
#include <string>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

Solid::State openPyramid(const std::filesystem::path& path, int finestStep, StageClock& clock);

// name: what messages and reports call it.
Solid::State stateOf(wavelets::Pyramid pyramid, const std::string& name);

}  // namespace isowave::lod
