// Placed frames -> a VoxelSource that reads them slice by slice.
#pragma once

#include "io/image/dicom/place.h"
#include "io/image/source.h"

namespace isowave::imageio {

// What the frames of a stack share: size, types, scale, axes, spacing and origin.
Header headerOf(const PlacedStack& placed, const ImageReadOptions& options);

// One slice a frame, or, where placed.even is false, slices in even steps between them. `header`: headerOf(placed).
SourcePtr framesSource(PlacedStack placed, Header header);

// A segmentation: frames of several segments, of one bit or of a share of 255, each where its segment is not empty, or a map of
// labels, each where one is. A voxel's value is the number of its segment, or 0; of one segment with shares, the share, 0 to 1. Slices
// without a frame are 0. options.stack chooses one segment by its place in the list. Throws InputError for frames that
// do not lie on one lattice; reading it throws InputError where segments overlap.
// REQUIRES: frames of one stack, each with a segment or of a label map.
SourcePtr segmentsSource(const std::string& folder, DicomStack stack, const ImageReadOptions& options);

}  // namespace isowave::imageio
