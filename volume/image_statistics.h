// What values an image holds: range, percentiles, distinct ones.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "io/image/stream.h"
#include "isowave/progress.h"

namespace isowave {

// What an image holds.
struct ImageStatistics {
    float low = 0, high = 0;
    // Values below which 1, 5, 25, 50, 75, 95, 99 % of the voxels lie (of every n-th voxel of large images).
    std::vector<std::pair<int, float>> percentiles;
    std::vector<float> distinct;  // ascending; empty when there are more than kMostDistinct
    bool found = false;           // whether `wanted` is among the voxels
    static constexpr std::size_t kMostDistinct = 64;
};
// One pass over the stream. wanted: the value that `found` is about.
ImageStatistics statisticsOf(ImageStream& stream, std::optional<float> wanted = {},
                             const Progress& progress = {});

}  // namespace isowave
