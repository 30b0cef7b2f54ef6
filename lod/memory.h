// How much memory a job may take, and what it will.
#pragma once

#include <optional>
#include <string>

namespace isowave::lod {

// What lod takes at its peak, beside the 60 MB that the program needs anyway; docs/volume.md has the runs.
// Distance fit, for each lattice point of the distances' band. Seen: 44 to 74 a control point, of which there are fewer,
// for TR12J at 400, 256 and 128 voxels.
inline constexpr double kBytesPerBandPoint = 80;
// The same of images. Seen: 109 and 118 for balls of grey voxels, 400 and 120 across.
inline constexpr double kBytesPerImageBandPoint = 120;
// Binary fit, for each node. Seen: 275 and 312 for bench/make_volume's 512^3 and 256^3.
inline constexpr double kBytesPerNode = 320;

// Bytes: `asked`, or 70 % of the computer's (or of the container's) memory.
double memoryLimit(const std::optional<double>& asked);

// Throws InputError when `bytes` are more than `limit`; remedy: "crop or downsample it".
void refuseTooLarge(const std::string& name, double bytes, double limit, const std::string& remedy);

}  // namespace isowave::lod
