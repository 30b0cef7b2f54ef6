// Floating-point numbers of 16 bits (IEEE 754 binary16), which NumPy and MRC files hold.
#pragma once

#include <cstdint>

#include "io/image/source.h"

namespace isowave::imageio {

// The number of these bits; float32 holds every one of them.
float floatOfHalf(std::uint16_t bits);

// The same source, whose uint16 voxels are the bits of such numbers, with these as float32. REQUIRES: source->native.
SourcePtr halvesAsFloats(SourcePtr source);

}  // namespace isowave::imageio
