// Triangle meshes: closed where they are not, sampled on a lattice.
#pragma once

#include <filesystem>
#include <string>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// A mesh file as it is, in LPS when it says SPACE=RAS. format: as MeshFileInfo has it.
struct LoadedMesh {
    TriangleMesh mesh;
    Space space = Space::unspecified;
    std::string format;
};
LoadedMesh loadMesh(const std::filesystem::path& path, const Progress& progress);

Solid::State openMesh(const std::filesystem::path& path, const SolidOptions& options,
                      const Progress& progress, StageClock& clock);
Solid::State openMesh(const TriangleMesh& mesh, Space space, const SolidOptions& options,
                      const Progress& progress, StageClock& clock);

}  // namespace isowave::lod
