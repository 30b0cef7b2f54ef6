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

    // finestStep: what only finer steps need is not read; field() takes step >= finestStep then, and steps() is not to be
    // called. Throws InputError for a file that is no pyramid or damaged.
    static Pyramid open(const std::filesystem::path& path, int finestStep = 0);
    // One .vdb. Written under a temporary name, then renamed. Throws OperationError.
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

}  // namespace isowave
