// Steps of a solid, wherever they come from: taken off a pyramid that was read, or by analysing a field.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/stage_clock.h"
#include "isowave/pyramid.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// The field of a pyramid's step. Throws UsageError when it was opened from a coarser step on, InputError when it does not go so far.
BSplineField fieldOf(const wavelets::Pyramid& pyramid, int step, const std::string& name,
                     const Progress& progress);

// wavelets::descend() of a solid that is no pyramid. onStep: is called at least for the steps that are asked for.
wavelets::Descent descendFrom(Solid solid, const wavelets::AnalyseOptions& options,
                              const std::function<bool(int step)>& isAskedFor,
                              const std::function<void(int step, const BSplineField&)>& onStep,
                              const Progress& progress);

// The field of a step. Throws InputError when the solid does not go so far.
BSplineField fieldAtStep(Solid solid, int step, const Progress& progress, StageClock& clock);

// The order of steps for voxels of this size, and a remark where that is not x, y, z in turn.
StepOrder orderFor(const std::array<double, 3>& spacing, const SolidOptions& options, const std::string& name,
                   const Progress& progress);

// "has steps 0 to 12 (levels 0 to 4), not step 15"
std::string tooFarText(int step, int count, const StepOrder& order);

// Finest first, one for each step and one for the coarsest field.
std::vector<StepFacts> factsOf(const wavelets::Pyramid& pyramid);

// Share of the lattice points in leaves that are control points, 0 to 1.
double leafOccupancyOf(const Shape& shape);

// Bytes in memory.
std::int64_t bytesOf(const BSplineField& field);
std::int64_t bytesOf(const wavelets::Pyramid& pyramid);

// |I| of step 0.
std::int64_t finestControlPoints(const wavelets::Pyramid& pyramid);

}  // namespace isowave::lod
