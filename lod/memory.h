// How much memory a job may take, and what it will.
#pragma once

#include <optional>
#include <string>

namespace isowave::lod {

// What lod takes at its peak, beside the 60 MB that the program needs anyway; docs/volume.md has the runs.
// Distance fit, for each lattice point of the distances' band. Seen: 153 and 218 for TR12J and the bunny at 256 voxels.
inline constexpr double kBytesPerBandPoint = 220;
// The same of images. Seen: 105 and 110 for a smooth part in 512^3 and 256^3 voxels, 214 for a head CT, whose surface is rough.
inline constexpr double kBytesPerImageBandPoint = 220;
// Binary fit, for each node. Seen: 275 and 312 for bench/make_volume's 512^3 and 256^3.
inline constexpr double kBytesPerNode = 320;
// The share of these that a field and its pyramid take, without levels. Seen: 15 bytes for each point of the band of a gyroid in 512^3
// voxels, 30 and 33 for TR12J and the bunny at 512, 24 and 60 for two heads; 50 for a mask by the binary fit.
inline constexpr double kShareOfField = 0.3;
// Of a slab's fit (lod/slabs), for each lattice point of the leaves of the distances' band, for each node of a binary fit and of one of
// masks, beside the program. Seen in 4 and 8 slabs of a ball of a gyroid in 512^3 voxels: 6.1 to 6.6, 61 to 70 and 194.
inline constexpr double kBytesPerSlabPoint = 8, kBytesPerSlabNode = 90, kBytesPerSlabMaskNode = 220,
                        kBytesOfWorker = 0.13e9;
// Of an edit, balls of 57 to 287 voxels: for each point near the tool's surface of the lattice that it is sampled on (seen: 14 and 17),
// for each near it of the lattice of level 0 (seen: 163 to 170, with the pyramid that is made in the end), and for each inside a tool
// that is added (4.2: a leaf of 512 values until its neighbours are known).
inline constexpr double kBytesPerToolSample = 20, kBytesPerToolPoint = 175, kBytesPerPointInTool = 5;

// Of `most` bytes for levels, what the job takes.
inline double bytesFor(bool fieldOnly, double most) { return fieldOnly ? kShareOfField * most : most; }

// Bytes: `asked`, or 70 % of the computer's (or of the container's) memory.
double memoryLimit(const std::optional<double>& asked);

// Throws InputError when `bytes` are more than `limit`; remedy: "crop or downsample it".
void refuseTooLarge(const std::string& name, double bytes, double limit, const std::string& remedy);

}  // namespace isowave::lod
