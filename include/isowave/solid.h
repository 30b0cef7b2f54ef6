// A solid, from whatever holds one: an image, a mesh, a level set or a pyramid that was made before.
//
//   Solid head = open("cranium.nhdr", {.iso = 300});        // bone in a CT scan, in Hounsfield units
//   Solid part = open("part.stl", {.voxels = 400});         // a closed mesh, 400 voxels along its longest axis
//   Solid mine = open(mesh, {.voxel = 0.5});                // a mesh in memory, voxels of half a unit
//
//   image      -> what kind of image? (mask, labels, grey) -> iso and fit -> nodes or distances -> field
//   mesh       -> closed (repaired) -> voxel size -> distances -> field
//   level set  -> distances in voxels -> field
//   pyramid    -> read
// Every default that is taken goes to Progress::remark. What follows, levels and meshes, is in isowave/ladder.h.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/image.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave {

// From samples to a field. mask: from inside and outside alone, smooth and with the volume of the voxels, for masks and
// labels. distance: from signed distances, for everything else. binary: from inside and outside alone, by filtered weights,
// as Esteve, Brunet and Vinacua have it.
enum class FitMethod { binary, distance, mask };

// Which axis each step of a solid's pyramid halves, and which steps are levels. A step halves one axis of the lattice. Each of the first
// levels halves the axes that `first` names, an axis a step; every later level halves x, y and z. So of voxels that are cubes
// level l is step 3 l, and with first = {"xy", "xy"} levels are the steps 0, 2, 4, 7, 10, ...
struct ISOWAVE_EXPORT StepOrder {
    std::vector<std::string> first = {};  // not empty, of the letters x, y, z

    // For voxels of which an edge is `factor` times as long as another, or more, >= 1: levels halve the short axes alone, the shortest
    // first, as long as that is so and a halving brings voxels nearer to a cube. By 2, (0.5, 0.5, 2.5) -> "xy", "xy"; (1, 1, 1.9) ->
    // none.
    static StepOrder forVoxels(const std::array<double, 3>& spacing, double factor = 2);

    // 0, 1, 2: the axis whose halving leads from this step to the next one.
    int axisAfter(int step) const;
    int stepOf(int level) const;  // level >= 0; at most 2^30, which no solid has
    // Nothing for a step between two levels.
    std::optional<int> levelOf(int step) const;
    // The coarsest level that is not coarser than the step.
    int levelUpTo(int step) const;
    // How often each axis has been halved: a voxel of the step is 2^n times as long.
    std::array<int, 3> halvings(int step) const;
    // The coarsest level whose voxel is on no axis longer than so many voxels of level 0, >= 1. Infinity counts as the largest number.
    int levelOfVoxel(double longest) const;

    friend bool operator==(const StepOrder&, const StepOrder&) = default;
};

// What --axes says: levels that make voxels cubes first where edges differ by a factor of 2 (StepOrder::forVoxels); wherever that brings
// them nearer to a cube (by a factor of 1); or x, y, z from the start.
enum class StepAxes { automatic, cubes, xyz };

// Names in messages are those of the command's options.
struct SolidOptions {
    // ---- what is inside
    // Images: inside where the value is above it (HU for CT); level sets: below, world units.
    std::optional<double> iso = {};
    std::optional<double> label = {};  // images: inside where the value is this one
    std::vector<double> labels = {};   // images: inside where the value is one of these; instead of label
    bool invert = false;               // images, level sets: the other side
    bool openBorder = false;           // images: meshes end open at the image's border instead of with a cap

    // ---- how a mesh is sampled: one of the two; neither: 256 voxels
    std::optional<std::int64_t> voxels = {};  // along the longest axis of the bounding box
    std::optional<double> voxel = {};         // edge, world units

    // ---- what is done with an open mesh: one of the two; neither: small holes are filled, large ones refused
    std::optional<double> closeHoles = {};  // holes up to this width are filled, world units
    // The solid of all points nearer to the mesh than half of this, world units: a sheet becomes a plate. At least 2 voxels.
    std::optional<double> thicken = {};
    // What a unit of a mesh's coordinates is: mm, cm, m, in, ft. Coordinates stay as they are: formats that have a unit (GLB)
    // and the report say it.
    std::optional<std::string> unit = {};

    // ---- how a file is read
    ImageReadOptions image = {};           // its memoryLimit is set from maxMemory
    std::optional<std::string> grid = {};  // of a .vdb with several level sets
    int finestStep = 0;  // of a pyramid's file only what this step and coarser ones need is read
    std::optional<int> finestLevel = {};  // the same, by level; instead of finestStep

    // ---- its levels; a pyramid has its own
    std::optional<StepAxes> axes = {};  // default: automatic

    // ---- the fit
    std::optional<FitMethod> fit = {};     // default: mask for masks and labels, distance else
    std::optional<double> halfWidth = {};  // voxels each side in which distances are known; default 4
    // Voxels each side that the field is kept for, at most halfWidth; default 2.
    std::optional<double> band = {};
    // Meshes, distance fit: thin walls and gaps are put where they are, and walls too thin for the lattice are kept whole.
    bool walls = true;

    // Bytes that the job may take; default: 70 % of the computer's (or of the container's) memory.
    std::optional<double> maxMemory = {};
    // No levels will be made of it, only its field and pyramid: these take less than a third of the memory that levels do, and
    // maxMemory refuses less.
    bool fieldOnly = false;

    // ---- in slabs: images
    // So many slabs of slices, at least, are read, fitted and halved by themselves and lie in a folder in between; memory is that of a
    // slab. The result is the same to the bit.
    std::optional<int> slabs = {};
    // Bytes that a process may take for a slab, with the 130 MB of the program; where a slab would take more, all are made thinner.
    // Default: maxMemory.
    std::optional<double> slabMemory = {};
    std::filesystem::path slabFolder =
        {};  // a hidden folder is made in it, and removed; default: the system's for temporary files
    // Runs tasks elsewhere: for each text what runSlabTask() gives, in order, whatever order they are run in. Then slabFolder itself
    // is where slabs lie: all workers see it, nobody removes it, and a job that begins again there goes on. progress: of the job.
    std::function<std::vector<std::string>(const std::vector<std::string>& tasks, const Progress& progress)>
        slabMap = {};
};

// What was read, and what was decided about it. What a kind of input does not have is empty.
struct InputReport {
    enum class Kind { mask, labels, greyImage, mesh, levelSet, pyramid };

    std::string path;  // of what came from memory: "image", "mesh", "level set"
    Kind kind = Kind::mesh;
    std::string format;         // "NRRD", "binary STL", ...; empty for level sets and pyramids
    std::string componentType;  // of an image's voxels as stored: "int16"
    std::string grid;           // the level set's name in its .vdb
    std::optional<std::array<std::int64_t, 3>> dimensions;  // voxels
    std::optional<std::array<double, 3>> spacing;           // of voxels, world units (mm for images)
    std::optional<std::array<double, 2>> range;             // least and greatest value of an image
    std::optional<double> iso, label;
    std::vector<double> labels;  // where several were asked for
    std::optional<bool> inverted, openBorder;
    std::optional<std::array<double, 3>> origin;  // world position of voxel (0,0,0), LPS
    std::optional<std::array<std::array<double, 3>, 3>>
        direction;                          // unit vectors along the lattice's axes, LPS
    std::optional<std::int64_t> triangles;  // of a mesh, as read
    std::vector<std::string> repairNotes;   // what was mended in it, and what of it is not kept, a line each
    std::string unit;                       // of its coordinates, where it was given
    // World units^3. Masks and labels: voxels inside times the volume of one, unless the border is open. Meshes: their
    // own, unless parts of them overlap or the orientation cannot be trusted. Others do not say.
    std::optional<double> volume;
    std::optional<std::int64_t> parts, handles, cavities;  // of a mesh whose volume is known
    std::optional<Space> space;                            // axes that meshes of the solid have

    // Of a pyramid: what its file says about the solid that it was made of, "input.path" -> "\"part.stl\"", values as
    // JSON; and the same with types, as far as it is understood.
    std::map<std::string, std::string> source;
    std::shared_ptr<const InputReport> madeFrom;
};

// Thin walls and gaps of a mesh, and what was done for them. Lengths in voxels.
struct WallSummary {
    std::int64_t rows = 0;     // conditions on the field: on faces, at lattice points, in the middle of walls
    int sweeps = 0;            // over them
    std::int64_t unmet = 0;    // signs that could not be met
    std::int64_t between = 0;  // signs that were put right between lattice points
    std::int64_t changed = 0;  // control points
    std::int64_t thickened = 0;  // lattice points outside that a thickened wall or a closed gap took in
    double thinnest = 0;         // 1 % of the walls of at most 4 voxels are thinner; 0: there are none
    int leastRefine = 1;  // samples of a voxel along an axis, 1, 2 or 4, that a mesh with whole walls needs
};

// How the field was fitted, and how far it agrees with the input.
struct FitSummary {
    FitMethod method = FitMethod::distance;
    double halfWidth = 0, band = 0;  // voxels each side; distance fit
    int filterPasses = 0;            // of the Laplacian; binary fit
    int gradientPasses = 0;          // mask fit
    std::int64_t latticePoints = 0;  // whose sign was compared with the input's
    std::int64_t disagreeing = 0;    // of these, in the end
    int repairPasses = 0;            // that changed something
    std::int64_t repaired = 0;       // control points changed, counted once a pass
    double repairFloor = 0;          // of K: what F times the sign has to reach for the repair to be content
    bool repairAgreed = true;        // it ended there, not at its limit of passes
    std::optional<WallSummary> walls = {};  // of a mesh, distance fit
};

// A solid as a B-spline field, or as the pyramid of one. Cheap to copy: copies share it. Give it away with std::move()
// where memory matters; the last owner's field is let go as soon as the first step is made of it.
class ISOWAVE_EXPORT Solid {
  public:
    struct State;  // lod/solid_state.h

    // The field's greatest value: it is K far outside, -K far inside.
    double K() const;
    Space space() const;
    const InputReport& input() const;
    // Nothing for a pyramid that does not say.
    const std::optional<FitSummary>& fit() const;
    bool isPyramid() const;
    // What its steps halve, and which of them are levels.
    const StepOrder& order() const;
    // How long opening took, by stage.
    const std::vector<StageSeconds>& seconds() const;

  private:
    explicit Solid(std::shared_ptr<State> state) : state_(std::move(state)) {}
    friend struct SolidAccess;
    std::shared_ptr<State> state_;
};

// The kind of input follows from the name's extension, from image.raw (a headerless image) and, for a .vdb, from what the
// file says that it is.
// Throws UsageError for an option that this kind of input does not have, for options that exclude each other and where
// an iso-value is missing; InputError for bad data, for what has no surface and for what would not fit into memory;
// Cancelled.
ISOWAVE_EXPORT Solid open(const std::filesystem::path& path, const SolidOptions& options = {},
                          const Progress& progress = {});
// space: axes of the mesh's coordinates, which are LPS where they have a meaning.
ISOWAVE_EXPORT Solid open(const TriangleMesh& mesh, const SolidOptions& options = {},
                          const Progress& progress = {}, Space space = Space::unspecified);
ISOWAVE_EXPORT Solid open(const Image& image, const SolidOptions& options = {},
                          const Progress& progress = {});
// The same solid as of an image with these voxels, which are not copied. Of options.image only `nan` has a meaning.
ISOWAVE_EXPORT Solid open(const VoxelView& voxels, const SolidOptions& options = {},
                          const Progress& progress = {});

// One task of a job in slabs, which options.slabMap was given; image, options: as open() has them. Throws as open() does.
ISOWAVE_EXPORT std::string runSlabTask(const std::filesystem::path& image, const SolidOptions& options,
                                       const std::string& task, const Progress& progress = {});

}  // namespace isowave
