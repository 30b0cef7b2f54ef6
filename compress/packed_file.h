// The file of a packed solid, .iwz: the control points of level 0, to the bit or within a bound, from which everything else
// is computed again.
//
// Level 0 determines the pyramid, and analysis gives the same bits each time, so the details need not be stored. Quantising details
// instead was tried and loses: coarse details are as large as K, and their errors add up over the steps.
// The values are cut into chunks of planes that are coded by themselves, each by one thread; how they are cut depends on the
// number of points alone, so the bytes are the same for any number of threads.
// Sections (sections.h): head; nodes (mask_coder.h); signs: the known points whose sign is not that of F; values, one for each
// chunk (float_coder.h, index_coder.h). docs/interfaces.md has the head's fields.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave::compress {

struct PackOptions {
    // How far F may move at corners of nodes that the surface passes, voxels; nothing: not at all, to the bit.
    std::optional<double> bound = {};
    double voxelsPerK = 4;  // F of K is a distance of so many voxels; only of use with a bound
    std::map<std::string, std::string> source = {};  // as wavelets::Pyramid::source
};

struct PackFacts {
    std::int64_t points = 0;
    std::int64_t bytes = 0, headBytes = 0, nodeBytes = 0, signBytes = 0,
                 valueBytes = 0;  // of the whole file and its parts
    int chunks = 0;
    double delta = 0;             // the quantiser's step at the surface, voxels; 0: lossless
    double largest = 0, rms = 0;  // change of F near the surface, voxels, of what decoding gave
};

struct PackedField {
    BSplineField field;
    std::map<std::string, std::string> source;
    std::optional<double> bound;  // that it was packed with, voxels
};

struct PackedBytes {
    std::string bytes;
    PackFacts facts;
    PackedField decoded;  // what reading the bytes gives
};

// Encodes, decodes, and compares what came back with the promise. name: in messages. Throws InputError for a field that cannot be
// packed (field_points.h), OperationError where the bound cannot be kept; Cancelled.
PackedBytes pack(const BSplineField& field, const std::string& name, const PackOptions& options,
                 const Progress& progress = {});

// Throws InputError, one line that begins with `name`: no packed file, another version, truncated, damaged.
// mostPoints: more control points are refused before memory is taken for them.
PackedField unpack(std::string_view bytes, const std::string& name, double mostPoints,
                   const Progress& progress = {});

// Temporary name, then rename. Throws OperationError.
void writeFile(const std::filesystem::path& path, std::string_view bytes);
PackedField readPacked(const std::filesystem::path& path, double mostPoints, const Progress& progress = {});

// K over the median length of F's gradient per voxel at corners of nodes that the surface passes: voxelsPerK of a field that
// is no distance.
double measuredVoxelsPerK(const BSplineField& field, const std::string& name, const Progress& progress = {});

// By its name's extension, ".iwz".
bool isPackedPath(const std::filesystem::path& path);

}  // namespace isowave::compress
