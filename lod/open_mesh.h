// Triangle meshes: closed where they are not, sampled on a lattice.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/stage_clock.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// A mesh file as it is, in LPS when it says SPACE=RAS. format: as MeshFileInfo has it. step, droppedNote: as MeshFile has them
// (io/mesh/read.h). unit: of the coordinates where it is known, which is that of GLB alone; in the one that is asked for, or mm.
// maxMemory: as in SolidOptions, for what gzip has compressed.
struct LoadedMesh {
    TriangleMesh mesh;
    Space space = Space::unspecified;
    std::string format;
    std::optional<double> step = {};
    std::string droppedNote = {}, unit = {};
};
LoadedMesh loadMesh(const std::filesystem::path& path, const Progress& progress,
                    const std::optional<std::string>& unit = {}, const std::optional<double>& maxMemory = {});

// What openMesh() goes by, of a mesh that is repaired and not yet sampled.
struct MeshPlan {
    TriangleMesh mesh;
    InputReport input;      // without what the fit and the finer lattice tell
    double bandPoints = 0;  // lattice points within the half-width, about
};
MeshPlan planMesh(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress);

Solid::State openMesh(const std::filesystem::path& path, const SolidOptions& options,
                      const Progress& progress, StageClock& clock);
Solid::State openMesh(const TriangleMesh& mesh, Space space, const SolidOptions& options,
                      const Progress& progress, StageClock& clock);

}  // namespace isowave::lod
