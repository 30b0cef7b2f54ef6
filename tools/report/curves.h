// What `isowave curves` says: a table, a line, and JSON (docs/interfaces.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isowave/curves.h"
#include "tools/report/json.h"

namespace isowave::tools {

struct CurvesReport {
    std::string path, kind;  // of the input
    double pixel = 1;        // of level 0, in the input's unit
    curves2d::Hold hold = curves2d::Hold::local;
    curves2d::Ladder ladder;
    // The steps that were asked for, and the file that each went to; none for half levels and where no ring is left.
    struct Step {
        curves2d::StepFacts facts;
        std::optional<std::string> file;
    };
    std::vector<Step> steps;
    std::size_t files = 0;
    bool smooth = false;             // asked for
    double deviation = 0;            // of smooth curves from the zero set, the largest, in pixels
    std::size_t straightPieces = 0;  // in squares that hold a sharp bend
    std::int64_t peakMemoryBytes = 0;
};

std::string jsonOf(const CurvesReport& report);
// One row a step.
std::string table(const CurvesReport& report);
// "out/africa: 12 polygons .., 5,120 control points, .."; folder: where the files went.
std::string summary(const CurvesReport& report, const std::string& folder);
// What a reader should know beside that: lattice points whose sign is not the input's; how exact smooth curves are.
std::vector<std::string> fitRemarks(const curves2d::FitReport& report);
std::string smoothRemark(const CurvesReport& report);

// What `isowave info` tells of the file of a pyramid of curves.
struct CurvePyramidInfo {
    std::string path, kind;  // kind: of the input, "image 400 x 328"
    std::uint32_t formatVersion = 1;
    double K = 1, pixel = 1;
    curves2d::Box extent;  // of the input, and in its unit
    bool yUp = false;
    std::int64_t fileBytes = 0;
    curves2d::Ladder ladder;
    std::vector<curves2d::StepFacts> steps;  // all, those between levels, too; with what is held by levels
};
std::string jsonOf(const CurvePyramidInfo& info);
std::string textOf(const CurvePyramidInfo& info);

}  // namespace isowave::tools
