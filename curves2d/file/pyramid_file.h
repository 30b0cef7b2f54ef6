// The file of a planar pyramid, .iwc: level 0 of an input that was fitted, to the bit, with what of the input its curves need.
// Analysis gives every coarser step from it, to the same bits each time, so details are not stored.
//
// Sections (base/section_file.h, magic "ISOWAVEC"): 1 head, 2 rows, 3 values that are predicted or 4 plain ones, whichever is
// smaller; all but the head are zlib streams of what row_coding.h says. The head:
//   f64 K; 4 f64 origin x, y and spacing x, y of the lattice; u64 length of the rows, inflated; u64 control points
//   4 f64 extent of the input, low x, y and high x, y; u32 1 where y points up; text the input's kind; f64 pixel
//   u32 fit, 0 binary, 1 distance; f64 half-width, f64 band, in pixels, 0 < band <= half-width <= 2^22; u64 lattice points,
//   u64 disagreeing, u32 repair passes, u32 1 where the repair agreed, f64 its floor, u64 repaired
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "isowave/curves.h"

namespace isowave::curves2d {

inline constexpr std::uint32_t kPyramidFormatVersion = 1;

// By its name: .iwc.
bool isPyramidPath(const std::filesystem::path& path);

// The input of a file's bytes. Throws InputError: no such file, of another version, truncated, damaged.
Input readPyramid(std::string_view bytes, const std::string& name);

}  // namespace isowave::curves2d
