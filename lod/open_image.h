// Images: masks, labels, grey values.
#pragma once

#include <string>

#include "base/stage_clock.h"
#include "io/image/stream.h"
#include "lod/solid_state.h"
#include "volume/image_solid.h"
#include "volume/image_statistics.h"

namespace isowave::lod {

Solid::State openImage(const std::filesystem::path& path, const SolidOptions& options,
                       const Progress& progress, StageClock& clock);
Solid::State openImage(const Image& image, const SolidOptions& options, const Progress& progress,
                       StageClock& clock);
Solid::State openImage(const VoxelView& voxels, const SolidOptions& options, const Progress& progress,
                       StageClock& clock);

// What openImage() goes by, of an image that was looked at once.
struct ImagePlanned {
    ImageStream stream;
    ImageSolid shape;
    InputReport::Kind kind;
    FitMethod fit;  // unless the options have another
};
ImagePlanned planImage(const std::filesystem::path& path, const SolidOptions& options,
                       const Progress& progress);

// The labels of a label image but 0, ascending, as SolidOptions::label takes them. Throws InputError where it is none; what the options
// say is inside is not looked at.
std::vector<double> labelsIn(const std::filesystem::path& path, const SolidOptions& options,
                             const Progress& progress);

// What the readers of images are told. Throws UsageError for a headerless image whose size or type is missing.
ImageReadOptions imageReadOptions(const SolidOptions& options);

// "-1024 to 2986 (1 % below -1024, 5 % ..."
std::string rangeText(const ImageStatistics& statistics);

// Unit vectors along the three axes of the lattice, LPS.
std::array<std::array<double, 3>, 3> directionOf(const Image& image);

}  // namespace isowave::lod
