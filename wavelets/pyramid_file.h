// The pyramid's file: one .vdb with a grid for each part, which vdb_print lists.
//
// Grids (docs/interfaces.md, "pyramid file"), s = step, three digits:
//   control_points   FloatGrid   the coarsest field: active = known, inactive ±K
//   shape            BoolGrid    its shape: active = known, value = inside
//   shape_s          BoolGrid    the shape of step s
//   details_s        FloatGrid   the details that turn step s+1 into step s: active = stored
//   exact_000        FloatGrid   of edited solids: control points of step 0 where synthesis misses them by rounding (exact.h)
// Metadata of the file:
//   isowave:format   "pyramid"        isowave:version  1 (int32)      isowave:K  (double)
//   isowave:axes     one of x, y, z for each step, finest first       isowave:source:KEY  free text
//   isowave:first_levels  "xy xy": the axes that each of the first levels halves, where these are not all three (step_order.h)
#pragma once

#include <filesystem>
#include <functional>

#include "wavelets/pyramid.h"

namespace isowave::wavelets {

inline constexpr int kPyramidFormatVersion = 1;

// Where steps lie that a pyramid has neither shape nor details of: each is asked for when its turn comes to be written.
struct StepSource {
    std::function<Shape::Ptr(int step)> shape;
    std::function<DetailGrid::Ptr(int step)> details;
};

// Temporary name, then rename. missing: needed where the pyramid lacks steps. Throws OperationError.
void writePyramid(const std::filesystem::path& path, const Pyramid& pyramid, const StepSource& missing = {});

// Throws InputError: missing, truncated, not a .vdb, not a pyramid, another format version, K not a positive
// number, first levels that contradict the axes, parts missing, a coarsest field and shape that differ. Whether the details of each step belong to
// its shape is found out, with an InputError too, when that step is synthesised.
// finestStep: what only finer steps need is not read, and not looked at even if it is damaged: the pyramid's
// steps 0 .. finestStep - 1 have neither shape nor details then, and field(step) takes step >= finestStep
// only.
// bytesRead: optional second result, how many bytes of the file were read.
Pyramid readPyramid(const std::filesystem::path& path, int finestStep = 0, std::int64_t* bytesRead = nullptr);

// The order of its steps alone, from the file's head. Throws InputError as readPyramid() does.
StepOrder readOrder(const std::filesystem::path& path);

// Whether the file is a .vdb that calls itself a pyramid, of whatever version. False for anything else,
// missing files included.
bool isPyramidFile(const std::filesystem::path& path);

}  // namespace isowave::wavelets
