// A fitted field -> its curves at every step, with the facts about each (isowave/curves.h).
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "curves2d/contour.h"
#include "curves2d/fit.h"
#include "curves2d/pyramid.h"
#include "curves2d/segment_tree.h"
#include "isowave/curves.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// options: of the distance fit.
RowField<float> fit(const Shape& shape, Fit method, const DistanceFitOptions& options = {},
                    FitReport* report = nullptr, const Progress& progress = {});

// Called with every step's curves, finest first. traced: the same curves, a point wherever they cross the field's lattice.
using FieldVisitor = std::function<void(const StepFacts& facts, const RowField<float>& field,
                                        const Curves& curves, const Curves& traced)>;

// Steps 0 .. lastStep (all that there are without it). Fills in the ladder's steps and counts; what it says about the
// fit stays as it is. hold: changes levels from 1 on as they are visited; steps between levels and the pyramid stay.
Ladder traceSteps(RowField<float> field, std::optional<int> lastStep, Hold hold, const FieldVisitor& visit,
                  const Progress& progress = {});

// One-sided distance from curves to segments, sampled at least every `spacing` along every piece, at most 64
// samples a piece.
struct Distance {
    double max = 0, rms = 0;
};
Distance distanceTo(const SegmentTree& target, const Curves& curves, double spacing);
std::vector<Segment> segmentsOf(const Curves& curves);

}  // namespace isowave::curves2d
