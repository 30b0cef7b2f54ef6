// What a job would take and come to, said in a fraction of its time: nothing is fitted.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "isowave/solid.h"

namespace isowave::lod {

struct DryRun {
    InputReport::Kind kind = InputReport::Kind::mesh;
    FitMethod fit = FitMethod::distance;
    std::array<std::int64_t, 3>
        voxels{};                     // of the solid's box (of the image, of the level set's active voxels)
    std::array<double, 3> spacing{};  // of a voxel, world units
    StepOrder order;                  // of its levels
    // About, at the peak of the fit: what lod/memory.h reckons with. A whole ladder was seen to take 1.1 to 2.0 times that
    // (a torus at 64 and 128 voxels, a gearwheel at 96).
    double memoryBytes = 0;
    bool fieldOnly = false;  // memoryBytes is what a pyramid takes, not levels
    double memoryLimit = 0;  // bytes; a fit that takes more is refused
    int lastLevel = 0;       // by the size of the lattice; the ladder ends before it where the solid vanishes

    // The thinnest 1, 5 and 50 % of the walls, by area. Empty for level sets, and where nothing lies opposite anything.
    struct Wall {
        double share = 0;
        double voxels = 0;  // of level 0
        std::optional<int>
            heldUpTo;  // the level up to which a level keeps it as it is; coarser ones thicken it
    };
    std::vector<Wall> walls;
    bool wallsAreBounds = false;  // they are at most so thick (wall_thickness.h: voxels)
};

// Reads the input, and repairs a mesh, as open() does, with its remarks. Throws what open() throws, but for memory that would not
// suffice, which is the answer; UsageError for a pyramid, whose levels are known.
DryRun dryRun(const std::filesystem::path& path, const SolidOptions& options, const Progress& progress);

}  // namespace isowave::lod
