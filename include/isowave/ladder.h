// A solid in, a ladder of meshes out: one closed mesh a level, each with a report of what it has kept and lost.
//
//   Ladder ladder = makeLadder(open("part.stl"), {.levels = StepRange{0, 3}});
//   for (const Level& level : ladder.levels)
//       std::cout << level.report.topology.triangles << " triangles, genus " << level.report.topology.genus << '\n';
//
// With a visitor no mesh is kept; each is handed on as it passes by, so that one field and one mesh are in memory at a
// time, level 0's triangles beside them:
//
//   makeLadder(open("part.stl"), {}, {.level = [](const LevelReport& report, const TriangleMesh& mesh) { ... }});
//
// Step s is the solid after s directions have been halved, of cubic voxels axes in turn x, y, z; level l is step 3 l then, in general
// Solid::order().stepOf(l).
//
//   each step:  field -> hold what is thin -> iso-value -> polygonize -> remove specks -> compact -> relax -> cut off at an open border
//               -> count -> measure against level 0
// With regions that keep a finer level (LevelOptions::fine, adaptive) the field is blended with that level's before it is polygonized.
//
// Distances to level 0, budgets and `compact` need the parts of isowave that CGAL's GPL packages are in (canMeasureDistances
// in isowave/measure.h). Without them distances are empty and the others a UsageError.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "isowave/field.h"
#include "isowave/measure.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/pyramid.h"
#include "isowave/solid.h"
#include "isowave/version.h"

namespace isowave {

// ---- what is asked for

// first..last, both included; without last: as far as the pyramid goes.
struct StepRange {
    int first = 0;
    std::optional<int> last = {};
};

// How thin walls and rods, thinner than a level's voxel, are kept together.
enum class Holding {
    local,  // each level's control points are changed beside what is thin, and nowhere else
    shift,  // each level at the least iso-value that keeps it
    none    // not at all: the plain wavelet level
};

// A part of space in which coarser levels keep the details of a finer one: inside, their surface is that level's own, and
// over one voxel of the coarser level outside the details fade out. One closed mesh, whose triangles follow the local level.
struct FineRegion {
    using Box = RegionBox;
    // A box, or a closed mesh: its file, or its triangles; world coordinates.
    std::variant<Box, std::filesystem::path, TriangleMesh> where = {};
    int level = 0;      // the one that is kept; no level up to it changes
    double within = 0;  // the region is widened by this, world units
};

// Names in messages are those of the command's options.
struct LevelOptions {
    std::optional<StepRange> levels = {}, steps = {};  // one of the two; neither: all levels
    // Samples of a node along each axis: 1, 2 or 4. Empty: chosen by each level, 2 where it holds what is thin, and the mesh is
    // brought back to about the triangles of 1.
    std::optional<int> refine = {};
    Holding hold = Holding::local;
    bool compact = false;  // collapse what refine > 1 gives down to the triangles of refine = 1
    bool refit = false;    // fit the field of a level once more to level 0's surface
    bool preserveVolume =
        false;  // choose the iso-value at which a level has the input's volume, else level 0's
    // At most so many handles (summed over components) and parts, by cuts and fills of the level's field.
    std::optional<std::int64_t> maxGenus = {}, maxParts = {};
    bool keepSpecks = false;  // components smaller than a node stay
    bool features = false;    // measure parts, holes and cavities of level 0 and tell what became of them
    int relax = 0;            // rounds of sliding vertices along the surface
    bool deviation = false;   // measure triangles against the zero set
    // Where levels keep the details of finer ones; where regions overlap the finest counts. Needs levels, not steps or budgets,
    // at iso-value 0.
    std::vector<FineRegion> fine = {};
    // Such regions, found by themselves: at each place a level follows the coarsest one, up to itself, up to which all are within this
    // of level 0, both ways. Above 0; voxels count by the shortest edge of level 0's. What `fine` needs; both may be given.
    std::optional<Length> adaptive = {};
};

// Meshes by budget instead of by level: the step whose topology suits the budget best, simplified by edge collapse.
struct BudgetOptions {
    std::vector<std::int64_t> triangles = {};  // one mesh each: at most so many triangles
    std::vector<double> ratios =
        {};  // one mesh each: at most this share of a mesh's own triangles, of level 0's for others
    // One mesh each: nowhere farther than this from level 0, world units.
    std::vector<double> tolerances = {};
    // Of all of them; where only these are given there is one mesh, that of the finest step that they allow.
    // Handles, summed over components; LevelOptions::maxGenus brings every step down to it.
    std::optional<std::int64_t> maxGenus = {};
    // World units^3: every component, a cavity too, has at least that.
    std::optional<double> minComponent = {};

    bool any() const {
        return !triangles.empty() || !ratios.empty() || !tolerances.empty() || maxGenus || minComponent;
    }
};

// ---- what is told

// Parts, handles and cavities of the solid that a mesh bounds; or how many there are more than before.
struct SolidCounts {
    std::int64_t parts = 0, handles = 0, cavities = 0;
    friend bool operator==(const SolidCounts&, const SolidCounts&) = default;
};
ISOWAVE_EXPORT SolidCounts countsOf(const MeshTopology& topology);

// What became of level 0's features of one kind.
struct FeatureFate {
    std::int64_t survived = 0, vanished = 0;
    std::int64_t torn = 0;  // the ring or the wall has opened
    std::int64_t more = 0;  // of the level, that none of level 0's accounts for
    std::optional<double> smallestSurviving, largestVanished;  // radii, world units
};
struct FeatureReport {
    double spacing = 0;  // of the lattice that features were looked for on, world units
    double reach = 0;    // up to which radius, world units
    FeatureFate parts, handles, cavities;
};

// What a finer lattice finds in the field of a level that has more parts, handles or cavities than the one before: what is
// not there is an artefact of the mesh's sampling, the rest is the field's own.
struct SamplingReport {
    int refine = 2;
    SolidCounts counts;
    std::optional<double> thinKept;
};

// What a level did for what is thin.
struct HoldSummary {
    std::int64_t samples = 0;        // of level 0's thin places, one a cell of a quarter of the level's voxel
    std::int64_t insidePlain = 0;    // how many of them the plain level has inside
    std::int64_t inside = 0;         // and this one
    std::int64_t thickened = 0;      // where the wall is thinner than the mesh's sampling can hold
    std::int64_t gaps = 0;           // places in gaps narrower than the level's voxel that were filled
    std::int64_t controlPoints = 0;  // changed
    std::int64_t unmet = 0;          // conditions that could not be met
};

// How thick the walls of a solid are: the thinnest 1, 5 and 50 % of them, by area, in voxels of level 0 and in world units; and up
// to which level they keep that thickness, thinner ones being thickened (nothing: not even at level 0).
struct WallThickness {
    double share = 0;  // 0 to 1
    double voxels = 0, world = 0;
    std::optional<int> heldUpTo;
};

// LevelOptions::adaptive: what became of the tolerance. Distances are of samples of the level's mesh and of level 0's, each from the
// other one: vertices, and middles of triangles or of parts whose sides are at most a voxel of level 0 long.
struct AdaptiveSummary {
    double tolerance = 0;            // world units
    double farthest = 0;             // the largest distance, world units
    std::int64_t samplesBeyond = 0;  // that are farther than the tolerance
    int rounds = 0;  // how often the mesh was made: where it was too far, finer levels were kept
};

// What the regions of LevelOptions::fine and adaptive are to a level. `inside`: where all control points that the surface depends on are
// those of a region's level; `fading`: where some are a mixture of both; `outside`: where all are the level's own.
struct RegionSummary {
    // Control points that the mesh depends on: those of the regions' levels, up to where they have faded out, and the level's own;
    // none that a finer level replaces.
    std::int64_t finePoints = 0, coarsePoints = 0;
    std::int64_t trianglesInside = 0, trianglesFading = 0, trianglesOutside = 0;
    // Handles of the triangles inside, and of all others; those that run across the border between them are in neither. Of level 0:
    // of the whole.
    std::int64_t handlesInside = 0, handlesOutside = 0, handlesOfLevel0 = 0;
    // From this mesh to level 0, world units, as LevelReport::rmsToLevel0: of the triangles inside, and of all others.
    std::optional<double> rmsInside, maxInside, rmsOutside, maxOutside;
    std::optional<AdaptiveSummary> adaptive;
};

// A cut or a fill that made a level's topology simpler: a hole was filled or its ring cut, a part removed or joined to
// another, a cavity filled or opened.
enum class SolidFeature { part, handle, cavity };
struct LevelEdit {
    bool fill = false;
    SolidFeature what = SolidFeature::handle;  // of which there is one less
    Point at{};                                // world
    double volume = 0;                         // world units^3 that the solid gained
};

// How far level 0 is from the mesh that was read, world units: rms and largest distance both ways, from samples.
struct InputDistance {
    double rmsTo = 0, maxTo = 0, rmsFrom = 0, maxFrom = 0;
};

struct LevelReport {
    int step = 0;
    std::optional<int> level;         // nothing between two levels
    std::array<double, 3> spacing{};  // of the step's lattice, world units
    std::int64_t controlPoints = 0, nodes = 0;
    double leafOccupancy = 0;      // share of the stored lattice points that are control points, 0 to 1
    std::int64_t memoryBytes = 0;  // of the field

    MeshTopology topology;  // no triangles: the whole solid has vanished, and the ladder ends here
    bool vanished() const { return topology.triangles == 0; }
    int refine = 1;
    std::int64_t specksRemoved = 0, bubblesRemoved = 0;  // components smaller than a node
    double speckVolume = 0, bubbleVolume = 0;            // world units^3, both >= 0

    double isoShift = 0;  // the iso-value, of K; above 0 the solid is thicker
    std::optional<double>
        isoDistance;  // by which that moved the surface, world units; empty at an open border
    std::optional<double> volumeAtIso0;
    std::optional<double>
        volumeError;  // volume / input.volume - 1, or / level 0's - 1 where the input has none
    std::optional<double> thinKept, thinKeptAtIso0;  // share of what is thin that is inside, 0 to 1
    std::vector<WallThickness> walls;                // of level 0 alone, Holding::local
    std::optional<HoldSummary> hold;       // Holding::local: what it took; nothing where nothing is thin
    std::optional<RegionSummary> regions;  // of levels coarser than a region that meets the surface
    std::optional<FeatureReport> features;

    std::vector<LevelEdit> edits;             // that limits on the topology asked for
    std::optional<std::string> limitsMissed;  // by how much, where they could not be met
    SolidCounts change;                       // from the level before in the report, or from level 0
    std::optional<SamplingReport> sampling;
    // World units; from samples on the level, and on some of level 0's triangles. 0 for level 0 itself.
    std::optional<double> rmsToLevel0, maxToLevel0, rmsFromLevel0, maxFromLevel0;
    // Of the two rms, with 95 % confidence: they are measured on samples of large meshes.
    std::optional<double> rmsToLevel0Error, rmsFromLevel0Error;
    std::optional<InputDistance> toInput;  // at level 0, of a closed mesh that does not overlap itself
    std::optional<double> maxDeviation, rmsDeviation;  // of triangles from the zero set, world units
    double seconds = 0;
};

struct BudgetReport {
    std::optional<std::int64_t> trianglesAsked;  // also of a ratio
    std::optional<double> ratioAsked, toleranceAsked;
    std::optional<std::int64_t> maxGenus;
    std::optional<double> minComponent;
    int step = 0;              // that the mesh was made of
    std::optional<int> level;  // which that is; nothing between two levels
    std::string why;           // "smallest distance to level 0 of the steps tried: 0 (1.2), 6 (0.8)"
    MeshTopology topology;
    std::int64_t selfIntersections = 0;  // pairs of triangles
    OneSidedDistance toLevel0, fromLevel0;
    // No point of either surface is farther from the other, the mesh that was read; nothing where there is none, or it overlaps
    // itself.
    std::optional<double> maxToInput;
    double seconds = 0;
};

struct Level {
    LevelReport report;
    TriangleMesh mesh;  // empty where a visitor was given
};
struct BudgetLevel {
    BudgetReport report;
    TriangleMesh mesh;  // empty where a visitor was given
};

struct Ladder {
    InputReport input;
    std::optional<FitSummary> fit;
    double K = 1;
    StepOrder order;
    std::vector<Level> levels;  // finest first
    std::vector<BudgetLevel>
        budgets;    // triangles, ratios, tolerances, each in the order in which they were asked for
    int steps = 0;  // that were reached
    std::int64_t coefficientsStored = 0, controlPoints = 0;  // of the pyramid, kept or not; of step 0
    // By stage, opening the solid included; what a visitor takes is the stage "write".
    std::vector<StageSeconds> seconds;
    double totalSeconds = 0;
    std::int64_t peakMemoryBytes = 0;  // of the process so far
    std::int64_t threads = 0;          // that TBB may use
};

// ---- making it

// Called on the thread that makes the ladder, with a report that is complete but for the visitor's own seconds.
struct LadderVisitor {
    // Not for a level that has vanished.
    std::function<void(const LevelReport&, const TriangleMesh&)> level = {};
    std::function<void(const BudgetReport&, const TriangleMesh&)> budget = {};
    // Once, between many small allocations and few large ones: a program whose allocator keeps what was freed may give it
    // back here.
    std::function<void()> beforeMeasuring = {};
};

// Throws UsageError for options that exclude each other or have no such value, InputError where the solid has no surface or does not reach
// the first level asked for, or a region (LevelOptions::fine) is outside the solid or no closed mesh, Cancelled.
ISOWAVE_EXPORT Ladder makeLadder(Solid solid, const LevelOptions& options = {},
                                 const LadderVisitor& visitor = {}, const Progress& progress = {});

// The meshes of all steps are kept until the end, to choose from. Levels are made, too, where levels.levels or
// levels.steps asks for them. Throws as makeLadder() does, InputError where a budget cannot be met, UsageError for a
// solid with an open border.
ISOWAVE_EXPORT Ladder makeBudget(Solid solid, const BudgetOptions& budgets, const LevelOptions& levels = {},
                                 const LadderVisitor& visitor = {}, const Progress& progress = {});

// The mesh of one step, as the ladder has it; levels and steps of the options have no say. report tells of the mesh
// itself: nothing is compared with other levels. Throws InputError where the solid does not go so far.
ISOWAVE_EXPORT Level makeLevel(Solid solid, int step, const LevelOptions& options = {},
                               const Progress& progress = {});

// The field whose zero set that mesh is: with what holds thin walls, cuts and fills, and regions put in. fieldOf(solid, step) is the wavelet
// field without these. Throws as makeLevel() does, UsageError for options whose mesh is no zero set (Holding::shift, preserveVolume).
ISOWAVE_EXPORT Field makeLevelField(Solid solid, int step, const LevelOptions& options = {},
                                    const Progress& progress = {});

// The levels of a pyramid without meshes, until nothing is left: what `isowave info` tells.
ISOWAVE_EXPORT std::vector<LevelReport> describeLevels(const Pyramid& pyramid,
                                                       const LevelOptions& options = {},
                                                       const Progress& progress = {});

// Whether a level can only be made beside level 0: a pyramid's file must be read as a whole then.
ISOWAVE_EXPORT bool needsLevel0(const LevelOptions& options);

// Throws UsageError for options that exclude each other, ranges that end before they begin and regions that are none, before
// anything is read.
ISOWAVE_EXPORT void checkRanges(const LevelOptions& options);

// ---- a ladder in tiles

// A ladder of meshes as a viewer loads it over a network: cubes of the grid one by one, coarse from afar and fine near by.
enum class TileFormat {
    neuroglancer,  // neuroglancer_multilod_draco: info, 1.index, 1
    tiles3d        // 3D Tiles 1.1: tileset.json, L0/0_0_0.glb, ...
};

struct TileLevel {
    TriangleMesh mesh = {};
    double voxel = 1;  // of the level, world units: what detail there is
    double error = 0;  // from level 0, world units: 3D Tiles' geometricError
};

struct TileOptions {
    Space space = Space::unspecified;  // as in MeshWriteOptions
    double metresPerUnit = 0.001;
    std::uint64_t segment = 1;  // neuroglancer's number of the solid
};

// levels: finest first, each voxel about twice the one before. A tile of level l is a cube of 2^l chunks, and a chunk is the
// largest power of two (of a unit; of a metre in 3D Tiles) that is at most 64 voxels of the first level. Triangles are cut where they cross
// the grid, in neuroglancer's levels from 1 on the middles of tiles too. Vertices are rounded to 1/65535 (neuroglancer) or 2^-22 of a
// tile's side, and those on a border are the same point for both sides: the tiles of a level, put together, are closed
// and 2-manifold where the mesh is.
//
// neuroglancer: positions are world units, which the info's transform takes to nanometres; no normals. 3D Tiles: metres, z up in
// the tileset and Y up in the GLBs, as glTF has it; normals where meshes have them.
//
// The folder appears whole or not at all; tiles that are there are replaced. Throws OperationError where writing fails or the folder holds
// something else, InputError where no level has a triangle, Cancelled.
ISOWAVE_EXPORT void writeTiles(const std::filesystem::path& folder, std::span<const TileLevel> levels,
                               TileFormat format, const TileOptions& options = {},
                               const Progress& progress = {});

}  // namespace isowave
