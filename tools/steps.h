// Steps of a solid, wherever they come from: taken off a pyramid that was read, or by analysing a field.
#pragma once

#include <array>

#include "tools/input.h"

namespace isowave::tools {

constexpr int kStepsPerLevel = 3;

// The field of a step. Throws InputError when the solid does not go so far.
BSplineField fieldAtStep(Solid solid, int step, const std::string& name, Console& console, StageClock& clock);

// The step that --step or --level asks for; 0 when neither was given. Throws UsageError when both were.
int wantedStep(const Settings& settings);

// What `info` says about a step of a pyramid.
struct StepFacts {
    int step = 0;
    openvdb::Vec3d spacing;          // world units
    openvdb::Coord domain;           // nodes along each axis of the box around I
    std::int64_t controlPoints = 0;  // |I|
    std::int64_t definedNodes = 0;
    std::int64_t details = 0;       // that lead from the next coarser step to this one
    std::int64_t coefficients = 0;  // all that is needed for this step: coarsest field and details
    double leafOccupancy = 0;
};

// Finest first, one for each step and one for the coarsest field.
std::vector<StepFacts> factsOf(const wavelets::Pyramid& pyramid);

// Share of the lattice points in leaves that are control points, 0 to 1.
double leafOccupancyOf(const Shape& shape);

// Bytes in memory.
std::int64_t bytesOf(const BSplineField& field);
std::int64_t bytesOf(const wavelets::Pyramid& pyramid);

// |I| of step 0.
std::int64_t finestControlPoints(const wavelets::Pyramid& pyramid);

}  // namespace isowave::tools
