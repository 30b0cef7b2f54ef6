// An input file -> its curves at every step, with the facts about each: what `isowave curves` prints.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "curves2d/contour.h"
#include "curves2d/fit.h"
#include "curves2d/pyramid.h"
#include "curves2d/segment_tree.h"

namespace isowave::curves2d {

enum class Fit { binary, distance };

struct InputOptions {
    std::optional<double> iso = std::nullopt;  // images; without it the middle of the range of values
    bool invert = false;                       // images
    std::int32_t pixels = 1024;                // polygons: along the longer side
};

// An input, ready to be fitted.
struct Input {
    Shape shape;
    Box extent;        // the input's coordinates: of the image with half a pixel around, or of the polygons
    bool yUp = false;  // polygons; an image's y points down
    Fit fit = Fit::distance;           // what suits it: binary for masks, whose distances would be staircases
    std::string kind;                  // "image 400 x 328", "12 polygons of 14 rings, 2,113 points"
    std::vector<std::string> remarks;  // defaults taken, rings repaired
    double pixel = 1;                  // of level 0, in the input's unit
};

// Reads an image or polygons. Throws InputError: bitmap.h, polygon_input.h, raster.h.
Input readInput(const std::filesystem::path& path, const InputOptions& options,
                const Progress& progress = {});

struct StepFacts {
    int step = 0;
    std::array<std::int32_t, 2> domain{};  // control points of the box around I, x and y
    std::int64_t controlPoints = 0;        // |I|
    std::int64_t nodes = 0;                // whose 16 control points are known
    std::size_t rings = 0;                 // outer ones
    std::size_t holes = 0;
    std::size_t points = 0;
    double area = 0;         // the input's unit squared
    double maxToLevel0 = 0;  // from points on this step's curves to the curves of step 0; the input's unit
    double rmsToLevel0 = 0;  // weighted by length. Both one-sided: an island that has gone costs nothing
};

struct Ladder {
    std::vector<StepFacts> steps;
    std::int64_t coefficients = 0;   // of the wavelet transform
    std::int64_t controlPoints = 0;  // |I| of step 0
};

// Called with every step's curves, finest first.
using LadderVisitor =
    std::function<void(const StepFacts& facts, const RowField<float>& field, const Curves& curves)>;

// Steps 0 .. last (all that there are without it).
Ladder climb(RowField<float> field, std::optional<int> lastStep, const LadderVisitor& visit,
             const Progress& progress = {});

// options: of the distance fit.
RowField<float> fit(const Shape& shape, Fit method, const DistanceFitOptions& options = {},
                    FitReport* report = nullptr, const Progress& progress = {});

// One-sided distance from curves to segments, sampled at least every `spacing` along every piece, at most 64
// samples a piece.
struct Distance {
    double max = 0, rms = 0;
};
Distance distanceTo(const SegmentTree& target, const Curves& curves, double spacing);
std::vector<Segment> segmentsOf(const Curves& curves);

}  // namespace isowave::curves2d
