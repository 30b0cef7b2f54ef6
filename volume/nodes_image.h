// Node-Collections, the input of fitBinary(), from images.
#pragma once

#include "io/image/stream.h"
#include "isowave/image.h"
#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/image_solid.h"

namespace isowave {

// Lattice point i is inside where image value > iso (or < with invert), or, with a label, where value ==
// label. The voxels of the image are the lattice points; beyond the border everything is outside, unless
// openBorder. A stream is read once, and gives the same as the whole image, to the bit, whatever its slabs.
NodeCollection nodesFromImage(ImageStream& stream, const ImageSolid& solid, const Progress& progress = {});
NodeCollection nodesFromImage(const Image& image, const ImageSolid& solid, const Progress& progress = {});
NodeCollection nodesFromLabel(const Image& image, double label, bool openBorder = false,
                              const Progress& progress = {});

}  // namespace isowave
