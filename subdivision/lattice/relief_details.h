// The file of heights that were taken apart (relief --details), and heights put together again: ReliefDetails of
// isowave/subdivision.h.
//
// Sections (base/section_file.h, magic "ISOWGRID"), coarse before fine:
//   1 head     text scheme, u32 levels, u32 channels, u64 rows and columns of the relief at level 0; of quincunx u32 1 behind it
//   2 coarse   the values of the coarsest patch, node after node, as deflatedDoubles()
//   3 details  one section a level, the coarsest first
// The patch is the parallelogram or the hexagon that the layout lays over the relief; its sides follow from rows, columns and
// levels.
#pragma once

#include <string>
#include <string_view>

#include "isowave/subdivision.h"
#include "subdivision/lattice/surface.h"

namespace isowave::subdivision {

inline constexpr std::string_view kReliefDetailsMagic = "ISOWGRID";

struct ReliefParts {
    std::size_t rows = 0, columns = 0;  // of the relief at level 0
    SurfaceLevels levels;
    ReliefLayout layout = ReliefLayout::Rows;
};

std::string reliefDetailsBytes(const ReliefParts& parts);
// name: stands in messages. Throws InputError.
ReliefParts readReliefDetails(std::string_view bytes, const std::string& name);

// The heights of one sample of `parts` and of a grid that lie apart, farther than 1e-6 of the range of the coarse heights. NaN, where
// quincunx has no sample, is as far from NaN as 0, and from a number as infinity.
struct MovedSample {
    std::size_t row, column;
    double distance;
};
// Throws InputError where the grid has another size than the coarse heights.
std::optional<MovedSample> firstMovedSample(const Grid& coarse, const Grid& grid);

}  // namespace isowave::subdivision
