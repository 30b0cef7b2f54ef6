// Level sets of OpenVDB.
#pragma once

#include <filesystem>
#include <string>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

Solid::State openLevelSet(const std::filesystem::path& path, const SolidOptions& options,
                          const Progress& progress, StageClock& clock);
// Changes the grid, which is let go as early as its last owner allows.
Solid::State openLevelSet(openvdb::FloatGrid::Ptr levelSet, const std::string& name,
                          const SolidOptions& options, const Progress& progress, StageClock& clock);

}  // namespace isowave::lod
