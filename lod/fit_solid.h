// From nodes or distances to the field of a solid: the part that all kinds of input have in common.
#pragma once

#include <functional>
#include <string>

#include "base/stage_clock.h"
#include "isowave/solid.h"
#include "lod/fitting.h"
#include "lod/memory.h"
#include "lod/solid_state.h"

namespace isowave::lod {

// fallback: the method where the options leave it open.
Fitting fittingOf(const SolidOptions& options, FitMethod fallback);

// Throws UsageError: --band is wider than --half-width.
void checkFitOptions(const SolidOptions& options);

// "binary", "distance", "mask"
const char* nameOf(FitMethod method);

// Makes what the method needs, nodes or distances, each called at most once.
struct Samples {
    std::function<NodeCollection()> nodes;
    std::function<openvdb::FloatGrid::Ptr()> distance;
    // Corrects a distance fit before its repair; lattice point i of the distances is i + shift of the field. None: as it is.
    std::function<WallSummary(BSplineField& field, const openvdb::FloatGrid& distance,
                              const openvdb::Coord& shift)>
        walls = {};
    double bytesPerBandPoint = kBytesPerBandPoint;
    bool fieldOnly = false;  // SolidOptions
};

// Fills solid.field and solid.fit. remedy: what makes the job smaller. Throws InputError where the rest of the job would
// take more memory than the limit.
void fit(Solid::State& solid, const Fitting& fitting, const Samples& samples, double memoryLimit,
         const std::string& remedy, const Progress& progress, StageClock& clock);

// What the fit's report says, for people; and a remark where it could not meet all signs.
FitSummary summaryOf(const Fitting& fitting, const FitReport& report);
void tellDisagreement(const FitReport& report, const Progress& progress);

// The signs of a grid of distances, for the fits that know nothing else.
NodeCollection nodesOfDistance(const openvdb::FloatGrid& distance);

// World units^3, of a voxel.
double volumeOfVoxel(const openvdb::math::Transform& transform);
// Of the lattice points inside, each as large as a voxel of the transform; world units^3.
double volumeInside(const Shape& shape);

// Whether there are lattice points inside and outside.
bool hasSurface(const BSplineField& field);

[[noreturn]] void refuseNoSurface(const std::string& name, const std::string& remedy);
// Throws InputError where the field has only one side. remedy: "the image holds nothing but inside".
void requireSurface(const BSplineField& field, const std::string& name, const std::string& remedy);

}  // namespace isowave::lod
