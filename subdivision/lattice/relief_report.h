// The whole story of a relief (B section 11): `isowave relief`. Nothing here prints or writes. Part of
// `isowave::pictures`.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "subdivision/lattice/relief.h"

namespace isowave::subdivision {

struct ReliefReportOptions {
    std::string scheme = "butterfly-3";
    ReliefLayout layout = ReliefLayout::Rows;
    int levels = 2;
    bool compare = false;  // what the other schemes make of the relief without details
};

struct ReliefReport {
    struct Level {
        std::string patch;
        std::size_t nodes = 0;
        double detailRms = 0, detailLargest = 0;  // of the details that restore this level; 0 at the coarsest
        double suppressedRms = 0;                 // level 0 against P alone from here
    };
    std::string scheme;
    std::vector<Level> levels;
    double range[2] = {0, 0};                // of the values used
    double roundTrip = 0;                    // largest difference after reconstruction
    std::map<std::string, double> compared;  // suppressedRms of the coarsest level, by scheme
    // Name without folder -> bytes. level_K.npy, level_K.png (grey by height), shade_K.png (lit),
    // details_K.png (white: 0, black: the 99th percentile of |d| or more), suppressed.npy, suppressed.png,
    // suppressed_shade.png (P alone from the coarsest), reconstructed.npy. Pictures of point grids show the
    // last channel.
    std::map<std::string, std::string> files;
};

ReliefReport reportRelief(const Grid& grid, const ReliefReportOptions& options);

std::string text(const ReliefReport& report);
std::string json(const ReliefReport& report);

}  // namespace isowave::subdivision
