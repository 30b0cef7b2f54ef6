// NaN in images: "not measured" to those who write it, no value to those who look for a surface.
#pragma once

#include "io/image/source.h"

namespace isowave::imageio {

// The same source, with `value` where a voxel is NaN. Infinite voxels stay, and are refused later. A source of integers
// comes back as it is.
SourcePtr fillNan(SourcePtr source, float value);

}  // namespace isowave::imageio
