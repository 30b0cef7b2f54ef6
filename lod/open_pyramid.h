// Pyramids that somebody made before.
#pragma once

#include <filesystem>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

Solid::State openPyramid(const std::filesystem::path& path, int finestStep, StageClock& clock);

}  // namespace isowave::lod
