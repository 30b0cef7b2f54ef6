// A solid taken apart step by step, without loss: any step can be had back.
//
//   Pyramid pyramid = analyse(open("part.stl"));
//   pyramid.save("part.pyramid.vdb");
//   for (const StepFacts& step : pyramid.steps()) std::cout << step.step << ' ' << step.controlPoints << '\n';
//
// Step s is the solid after s directions have been halved (axes in turn x, y, z); level l is step 3 l.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/field.h"
#include "isowave/progress.h"
#include "isowave/solid.h"
#include "isowave/version.h"

namespace isowave {

inline constexpr int kStepsPerLevel = 3;

struct StepFacts {
    int step = 0;
    std::optional<int> halvedAxis;         // 0, 1, 2: what made it of the step before; nothing for step 0
    std::array<double, 3> spacing{};       // world units
    std::array<std::int64_t, 3> domain{};  // nodes along each axis of the box around the control points
    std::int64_t controlPoints = 0;
    std::int64_t nodes = 0;
    std::int64_t details = 0;       // that lead from the next coarser step to this one
    std::int64_t coefficients = 0;  // all that is needed for this step: coarsest field and details
    double leafOccupancy = 0;       // share of the stored lattice points that are control points, 0 to 1
};

// Cheap to copy: copies share it.
class ISOWAVE_EXPORT Pyramid {
  public:
    struct State;  // lod/pyramid_state.h

    // A packed solid (.iwz) is analysed again: the steps are those of the solid that was packed, to the bit.
    // finestStep: of a pyramid's file, what only finer steps need is not read; field() takes step >= finestStep then, and steps() is not to be
    // called. Throws InputError for a file that is no pyramid or damaged.
    // Says, of a solid that was packed within a bound, that it was; Cancelled.
    static Pyramid open(const std::filesystem::path& path, int finestStep = 0, const Progress& progress = {});
    // One .vdb; or, where the name ends in .iwz, level 0 alone, packed to the bit. Analysis of level 0 as synthesis gives
    // it back differs from this pyramid by rounding; pack the solid itself to keep its steps to the bit. Written under a temporary name, then renamed. Throws OperationError.
    void save(const std::filesystem::path& path) const;

    double K() const;
    int stepCount() const;
    // REQUIRES: 0 <= step <= stepCount().
    Field field(int step, const Progress& progress = {}) const;

    // Finest first, one for each step and one for the coarsest field.
    std::vector<StepFacts> steps() const;
    std::int64_t coefficientsStored() const;
    std::int64_t controlPoints() const;  // of step 0
    std::int64_t memoryBytes() const;
    // Where the solid came from: "input.path" -> "\"part.stl\"", "fit.method" -> ...; values are JSON.
    const std::map<std::string, std::string>& source() const;

  private:
    explicit Pyramid(std::shared_ptr<const State> state) : state_(std::move(state)) {}
    friend struct PyramidAccess;
    std::shared_ptr<const State> state_;
};

// Throws UsageError for a solid that is a pyramid already; Cancelled.
ISOWAVE_EXPORT Pyramid analyse(Solid solid, const Progress& progress = {});

// The solid that was taken apart, as open() gives it of the pyramid's file: levels are read off the pyramid, nothing is
// analysed again. It shares the pyramid's memory.
ISOWAVE_EXPORT Solid solidOf(const Pyramid& pyramid);

// ---- packed solids: level 0 in as few bytes as possible, from which all else is computed again
//
//   pack(open("part.stl"), "part.iwz");                                                 // to the bit
//   pack(open("part.stl"), "small.iwz", {.bound = Length{0.1, Length::Unit::voxels}});  // F within a tenth of a voxel
//   Solid part = open("small.iwz");                                                     // everything takes it
//
// With a bound every lattice sign stays as it is, and so do the triangles of level 0's mesh, its parts and its handles.

struct Length {
    enum class Unit { voxels, world };  // world: millimetres for images
    double value = 0;
    Unit unit = Unit::voxels;
};

struct PackOptions {
    // How far F may move at corners of nodes that the surface passes, as a distance; nothing: not at all. F of a fit that is no
    // distance is scaled by its slope at the surface. World units count by the lattice's largest spacing.
    std::optional<Length> bound = {};
    // How far vertices of level 0's mesh may move. The bound is made smaller until it holds; without a bound it begins there.
    // Voxels count by the lattice's smallest spacing.
    std::optional<Length> maxDistance = {};
};

struct PackReport {
    std::optional<double> boundVoxels;  // that was kept: what was asked for, or less; nothing: lossless
    std::int64_t controlPoints = 0;
    std::int64_t bytes = 0;  // of the file
    std::int64_t headBytes = 0, nodeBytes = 0, signBytes = 0, valueBytes = 0;
    int chunks = 0;  // that are decoded each by a thread
    // With a bound:
    double voxelsPerK = 0;                        // F of K is a distance of so many voxels
    double stepVoxels = 0;                        // of the quantiser, at the surface
    double largestVoxels = 0, rmsVoxels = 0;      // change of F at corners of nodes that the surface passes
    double largestDistance = 0, rmsDistance = 0;  // that vertices of level 0's mesh moved, world units
    std::int64_t triangles = 0;                   // of that mesh, the same before and after
    double seconds = 0;
};

// Checked by decoding before the file is renamed into place: lossless to the bit; with a bound the bound, all signs, the triangles
// and maxDistance. Throws UsageError for a bound or distance that is not above 0; InputError for a solid that cannot be
// packed; OperationError where the promise cannot be kept or the file not be written; Cancelled.
ISOWAVE_EXPORT PackReport pack(Solid solid, const std::filesystem::path& path,
                               const PackOptions& options = {}, const Progress& progress = {});

}  // namespace isowave
