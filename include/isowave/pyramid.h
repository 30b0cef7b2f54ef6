// A solid taken apart step by step, without loss: any step can be had back.
//
//   Pyramid pyramid = analyse(open("part.stl"));
//   pyramid.save("part.pyramid.vdb");
//   for (const StepFacts& step : pyramid.steps()) std::cout << step.step << ' ' << step.controlPoints << '\n';
//
// Step s is the solid after s directions have been halved, of cubic voxels axes in turn x, y, z; level l is step 3 l then, in general
// StepOrder::stepOf(l).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "isowave/field.h"
#include "isowave/progress.h"
#include "isowave/solid.h"
#include "isowave/version.h"

namespace isowave {

inline constexpr int kStepsPerLevel = 3;  // of a level that halves all axes

struct StepFacts {
    int step = 0;
    std::optional<int> level;              // nothing between two levels
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
    const StepOrder& order() const;
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

struct PyramidCounts {
    int steps = 0;
    std::int64_t controlPoints = 0;       // of step 0
    std::int64_t coefficientsStored = 0;  // details of all steps and the coarsest field
};
// analyse(solid).save(path), to the byte. Of an image in slabs (SolidOptions::slabs) no more than one of the file's grids is in memory
// at a time. Throws as these two do.
ISOWAVE_EXPORT PyramidCounts analyseTo(const std::filesystem::path& path, Solid solid,
                                       const Progress& progress = {});

// The solid that was taken apart, as open() gives it of the pyramid's file: levels are read off the pyramid, nothing is
// analysed again. It shares the pyramid's memory.
ISOWAVE_EXPORT Solid solidOf(const Pyramid& pyramid);

// ---- edits: something is added to a solid, cut off it or moved, at a level
//
//   EditedPyramid edited = edit(pyramid, {EditAdd{Ball{{10, 0, 5}, 4}}, EditCut{"slot.stl"}}, {.level = 2});
//   edited.pyramid.save("new.pyramid.vdb");
//   edit(edited.pyramid, {EditWith{pyramid}});              // undone: the old pyramid
//
// Level 0 changes beside the tool alone, and is what it was elsewhere, to the bit; finer details stay where they still have
// ground under them. All steps are analysed anew from it.

// Two opposite corners, world coordinates.
struct RegionBox {
    Point low{}, high{};
};
struct Ball {
    Point centre{};
    double radius = 0;  // world units, above 0
};
// A ball, a box, or a closed mesh: its file, or its triangles; world coordinates.
using EditTool = std::variant<Ball, RegionBox, std::filesystem::path, TriangleMesh>;

struct EditAdd {
    EditTool tool;
};
struct EditCut {
    EditTool tool;
};
// What of the solid lies in the box is cut off, moved, with its details, and joined to the rest.
struct EditMove {
    RegionBox box;
    Point by{};  // world units
};
// The level's control points are those of another field where the two differ, and finer details stay where the surface does: all
// of them where the field does not change, none where it changes by K. Or, of a pyramid or a packed solid, its level 0 is taken
// whole, which undoes edits. Either has the lattice of the solid (InputError). A file, or what it would hold.
struct EditWith {
    std::variant<std::filesystem::path, Field, Pyramid> other;
};
using Edit = std::variant<EditAdd, EditCut, EditMove, EditWith>;

// Names in messages are those of the command's options.
struct EditingOptions {
    // Tools are sampled on this level's lattice, so that their edges and corners are as round as its surfaces are; EditWith's
    // field is this level's.
    int level = 0;
    // Where EditAdd's or EditCut's tool meets the solid's surface, the edge becomes a fillet of this radius, world units, above 0;
    // nothing: as sharp as level 0 can have it.
    std::optional<double> blend = {};
    // Bytes that a tool may take; default: 70 % of the computer's (or of the container's) memory.
    std::optional<double> maxMemory = {};
    // Makes the mesh of every step and counts those that are closed, oriented and 2-manifold. Takes as long as all steps' meshes.
    bool checkSteps = false;
};

// One edit. Volumes in world units^3.
struct EditStory {
    std::string text;                          // "--add ball:0,0,0,5"
    std::optional<double> toolVolume;          // of a ball, a box or a mesh
    double volumeBefore = 0, volumeAfter = 0;  // of level 0's mesh, sampled twice a voxel
    std::int64_t partsBefore = 0, partsAfter = 0;
    std::int64_t touched = 0;  // control points of level 0 that are other ones
    std::int64_t known = 0,
                 forgotten = 0;  // lattice points that have come to be known, and that no longer are
};

struct EditReport {
    int level = 0;
    std::vector<EditStory> edits;
    std::int64_t touchedOfLevel =
        0;  // control points of the level that differ by more than 1e-4 K, or are known in one alone
    std::int64_t controlPoints = 0;  // of level 0
    std::int64_t steps = 0;
    std::optional<std::int64_t> closedSteps;  // with checkSteps: steps with a surface
    std::optional<std::int64_t> checkedSteps;
    double seconds = 0;
};

struct EditedPyramid {
    Pyramid pyramid;
    EditReport report;
};

// Throws UsageError: no edits, a level that the pyramid does not have, numbers that make no sense; InputError: a tool that misses the
// solid, or would not fit into memory, an edit that changes nothing or removes everything, a mesh that is open or too large, a field of another lattice;
// Cancelled. REQUIRES: a pyramid that was opened from step 0 on.
ISOWAVE_EXPORT EditedPyramid edit(const Pyramid& pyramid, const std::vector<Edit>& edits,
                                  const EditingOptions& options = {}, const Progress& progress = {});

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
