// Levels of detail by reversing subdivision: polygon meshes, polylines, grids of heights.
//
//   using namespace isowave::subdivision;
//   Hierarchy car = decompose(mesh, "catmull-clark");   // a coarse base, and details for every level above it
//   PolygonMesh middle = reconstruct(car, 2);           // the base with two levels of details
//   car.base.points[17].z += 3;                         // move the base: the details ride along
//   PolygonMesh edited = reconstruct(car);
//
// A subdivision P makes fine points from coarse ones. Its reverse makes coarse points and details, in such numbers that
// both together are as many as the fine points, and nothing is lost:
//     f fine, c coarse, d details:    c = A f,   d = B f,   f = P c + Q d.
// Bartels and Samavati (B), "Constructing biorthogonal multiresolutions from any subdivision with diagrams"; Olsen and
// Samavati (O), "A discrete approach to multiresolution curves and surfaces". isowave/filters.h shows A, B, P and Q.
//
// Schemes
//   meshes      catmull-clark (any faces, creases), loop, butterfly (triangles)        meshSchemeNames()
//   polylines   chaikin-W, cubic-W, dlg-trial, dlg-refined, dlg-optimal, or a mask     curveSchemeNames()
//   heights     butterfly-W, loop-W, loop-like:ALPHA,GAMMA                             surfaceSchemeNames()
// W is the width of A: taps for curves, rings of neighbours for surfaces; a wider A loses less.
//
// Functions throw InputError for bad data (isowave/error.h), Cancelled when progress asks to stop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave::subdivision {

using isowave::Polyline;
using isowave::Vec3;

// The points that a mesh, a curve or a relief of a level is written with.
//   control   those that subdivision works on. Only they can be rebuilt from.
//   limit     where subdivision without end, and without finer details, takes them: on the surface or curve that they
//             stand for. For pictures and for measuring; control points may stand far from what they control.
enum class Positions { control, limit };
inline std::string_view name(Positions positions) {
    return positions == Positions::limit ? "limit" : "control";
}

// ---- polygon meshes ----

using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

// An edge across which the surface has a kink, by its two vertices. Sharpness is any number above 0 and is only
// passed on: a crease is a crease at every level.
struct Crease {
    Index a = 0, b = 0;
    double sharpness = 1;
    friend bool operator==(const Crease&, const Crease&) = default;
};

// Faces of any size, counter-clockwise seen from outside. A *corner* is one place in one face; the corners of all
// faces are numbered in the order of the faces.
struct PolygonMesh {
    std::vector<Vec3> points;
    std::vector<Index> corners;          // vertex of each corner, face after face
    std::vector<Index> faceBegin = {0};  // face f owns the corners [faceBegin[f], faceBegin[f+1])
    std::vector<Crease> creases;
    std::vector<Index> pinned;  // vertices that subdivision leaves where they are, besides those it must

    std::size_t vertexCount() const { return points.size(); }
    std::size_t faceCount() const { return faceBegin.size() - 1; }
    std::size_t faceSize(std::size_t f) const { return faceBegin[f + 1] - faceBegin[f]; }
    std::span<const Index> face(std::size_t f) const { return {corners.data() + faceBegin[f], faceSize(f)}; }
    void addFace(std::span<const Index> vertices) {
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        faceBegin.push_back(static_cast<Index>(corners.size()));
    }
    void addFace(std::initializer_list<Index> vertices) {
        addFace(std::span<const Index>(vertices.begin(), vertices.size()));
    }
};

// Everything that keeps a mesh from being an oriented 2-manifold (with or without boundary), one line a kind of
// defect: how often, where first (vertices and faces counted from 0), what to do. In this order; of a kind that
// makes others meaningless only that one:
//   no faces; a vertex number beyond the points; a coordinate that is not finite; a face with fewer than three
//   corners or with one vertex twice; an edge with more than two faces; two faces that run along an edge the same
//   way (mixed orientation); a vertex whose faces form more than one fan; a vertex in no face; a crease or a
//   pinned vertex that is not in the mesh.
ISOWAVE_EXPORT std::vector<std::string> defects(const PolygonMesh& mesh);

// Throws InputError with the first of defects(), after `name`.
ISOWAVE_EXPORT void requireManifold(const PolygonMesh& mesh, const std::string& name);

// Length of the diagonal of the box around the points: the scale that tolerances refer to.
ISOWAVE_EXPORT double diagonal(std::span<const Vec3> points);

ISOWAVE_EXPORT std::vector<std::string> meshSchemeNames();
// Of A; the first is taken where none is named. Throws InputError that lists the schemes.
ISOWAVE_EXPORT std::vector<std::string> meshVariantNames(std::string_view scheme);

// `mesh` subdivided `levels` times, without details. Throws InputError for an unknown scheme, a defect of the mesh, and
// faces that the scheme does not take.
ISOWAVE_EXPORT PolygonMesh subdivided(const PolygonMesh& mesh, std::string_view scheme, int levels,
                                      const Progress& progress = {});

// Where the vertices of `mesh` end up when it is subdivided without end and without details: on the surface that it
// controls. In the order of the mesh; exact at every valence, boundaries, creases, darts and pinned vertices included.
// Butterfly goes through its points, so there they are the mesh's own. For looking at: a mesh with these points is no
// base for details. Throws as subdivided() does.
ISOWAVE_EXPORT std::vector<Vec3> limitPoints(const PolygonMesh& mesh, std::string_view scheme);

inline constexpr int kAllLevels = -1;
inline constexpr double kMeshRoundTrip = 1e-12;

// Where the vertices and faces of the finest mesh stood in the mesh that was decomposed. Empty: in canonical order
// (subdivision/meshes/mesh_scheme.h).
struct FinestOrder {
    std::vector<Index> vertex;       // of each canonical vertex
    std::vector<Index> firstCorner;  // of each canonical face: the corner there that its first corner was
    bool empty() const { return vertex.empty(); }
    friend bool operator==(const FinestOrder&, const FinestOrder&) = default;
};

// A mesh taken apart. Steps count from the base: after K steps, 0 <= K <= steps(), the mesh has been subdivided K times
// and has got the first K of the details.
//   (1) reconstruct(decompose(mesh)) is `mesh`: its vertices, faces and their order; points to kMeshRoundTrip times
//       the diagonal. Creases come in the order of the base's.
//   (2) Stored numbers: base points + details = fine points, three numbers each. (Plus two whole numbers a fine
//       point for the order of the file that the mesh came from, when it is not the canonical one.)
struct Hierarchy {
    std::string scheme, variant;
    PolygonMesh base;  // with creases and pinned vertices, which hold for every level
    // details[k] turns the mesh after k steps into that after k + 1; in the order that the scheme's step stores them.
    std::vector<std::vector<Vec3>> details;
    // There were more steps: the file was read up to details.size() of them, and `order` is left out.
    bool truncated = false;
    FinestOrder order;

    int steps() const { return static_cast<int>(details.size()); }
};

struct DecomposeOptions {
    std::string_view variant = {};  // of the scheme; empty: its first
    int levels = kAllLevels;        // or a number from 0
    // Edges of the base become creases when more than half of the fine edges along them fold by more than this many
    // degrees (0: flat). For catmull-clark, which keeps creases; besides those that the mesh has marked.
    std::optional<double> creaseAngle = {};
};

// Finds the coarse meshes inside `mesh` and takes it apart.
// Throws InputError, without a file name: an unknown scheme or variant; a defect of the mesh; no subdivision
// connectivity; fewer levels than asked for (how many are possible, and what is in the way).
ISOWAVE_EXPORT Hierarchy decompose(const PolygonMesh& mesh, std::string_view scheme,
                                   const DecomposeOptions& options = {}, const Progress& progress = {});

// The mesh after `steps` steps (kAllLevels: all). The finest has the order of the mesh that was decomposed, the
// others the canonical one. Throws InputError when the parts do not belong together.
ISOWAVE_EXPORT PolygonMesh reconstruct(const Hierarchy& hierarchy, int steps = kAllLevels,
                                       const Progress& progress = {});

// How details follow when the base is moved.
//   global   they keep their direction in space
//   local    they turn with the surface: each is taken from the frame of its point on the subdivided surface (normal,
//            and the direction of an edge there) before the edit to that after it. A rigid motion of the base is then
//            a rigid motion of every level; global frames carry a translation only.
enum class Frames { global, local };

// The mesh after `steps` steps from the moved base. REQUIRES: moved.size() == base.points.size(). Throws as
// reconstruct() does. With the base's own points it is what reconstruct() returns (local: up to rounding).
ISOWAVE_EXPORT PolygonMesh reconstructEdited(const Hierarchy& hierarchy, const std::vector<Vec3>& moved,
                                             int steps, Frames frames, const Progress& progress = {});

// The details of all steps, and how many are not 0.
ISOWAVE_EXPORT std::size_t detailCount(const Hierarchy& hierarchy);
ISOWAVE_EXPORT std::size_t nonzeroDetailCount(const Hierarchy& hierarchy);
// Sets every detail shorter than `length` (in the units of the mesh) to 0.
ISOWAVE_EXPORT void threshold(Hierarchy& hierarchy, double length);
// Keeps the `count` longest; of equal ones the coarser, then the earlier. Base + longest first is the order in which
// details are best sent.
ISOWAVE_EXPORT void keepLongest(Hierarchy& hierarchy, std::size_t count);

// Distances between the same vertices of two meshes. REQUIRES: as many points.
struct PointError {
    double rms = 0, largest = 0;
};
ISOWAVE_EXPORT PointError pointError(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

// Throws InputError when `moved` does not have the very faces and number of points of the base ("another
// connectivity", and where they part). Its creases do not count.
ISOWAVE_EXPORT void requireSameConnectivity(const PolygonMesh& base, const PolygonMesh& moved);

// One file (docs/interfaces.md, "Details of meshes"). Throws OperationError; the file appears whole or not at all.
ISOWAVE_EXPORT void saveHierarchy(const std::filesystem::path& path, const Hierarchy& hierarchy);
// The same bytes into a stream that throws std::ios_base::failure.
ISOWAVE_EXPORT void writeHierarchy(std::ostream& stream, const Hierarchy& hierarchy);
// Reads the base and the details of the first `steps` steps (kAllLevels: all, and the order of the finest) and
// nothing behind them. Throws InputError: not such a file, of a later version, truncated, damaged (a checksum of what
// is read does not agree), fewer steps than asked for.
ISOWAVE_EXPORT Hierarchy loadHierarchy(const std::filesystem::path& path, int steps = kAllLevels);

// What a decomposition holds, and what each level is worth.
struct DecompositionReport {
    struct Level {
        std::size_t vertices = 0, faces = 0;
        // Of the details that lead from this level to the next finer one; 0 at the finest.
        double detailRms = 0, detailLargest = 0;
        // Subdivided from here to the finest level without any details, against the mesh itself.
        PointError withoutDetails;
    };
    std::string scheme, variant;
    std::size_t creases = 0, pinned = 0;  // of the base
    double diagonal = 0;                  // of the mesh
    double roundTrip = 0;                 // largest distance after reconstruction
    Positions positions =
        Positions::control;             // of the base as it is written; all errors are of control positions
    std::vector<Level> levels;          // the base first
    std::size_t details = 0, kept = 0;  // kept: not 0, after dropDetails()
    PointError dropped;                 // what the others have cost
};
// `mesh` is what `hierarchy` was made from.
ISOWAVE_EXPORT DecompositionReport reportDecomposition(const Hierarchy& hierarchy, const PolygonMesh& mesh,
                                                       const Progress& progress = {});

// Leaves details shorter than `shortest` out of `hierarchy`, or all but the `count` longest, and measures what that costs
// against `mesh`, which it was made from. saveHierarchy() then writes a smaller file.
ISOWAVE_EXPORT void dropDetails(Hierarchy& hierarchy, const PolygonMesh& mesh, std::optional<double> shortest,
                                std::optional<std::size_t> count, DecompositionReport& report,
                                const Progress& progress = {});

struct RebuildOptions {
    std::vector<Vec3> moved = {};  // the base's points after an edit; empty: where they were
    Frames frames = Frames::global;
    std::optional<double> threshold = {};      // details shorter than this are left out
    std::optional<std::size_t> keep = {};      // or: only this many of the longest stay
    Positions positions = Positions::control;  // of the mesh
    bool shares = false;  // the errors of the longest 0, 1, 2, 5, 10, 20, 50 % of the details
};
struct RebuildReport {
    int levels = 0;
    std::size_t vertices = 0, faces = 0;
    std::size_t details = 0, kept = 0;  // of those levels; not 0
    double diagonal = 0;
    Positions positions = Positions::control;  // of the mesh
    PointError error;                          // what leaving details out has cost, at control positions
    struct Share {
        double share;  // of the details, the longest
        std::size_t kept;
        PointError error;
    };
    std::vector<Share> shares;
};
struct Rebuilt {
    PolygonMesh mesh;
    RebuildReport report;
};
// The finest mesh of a hierarchy, edited and simplified. REQUIRES: `moved` is empty or has the base's size.
// Throws as reconstruct() does, and InputError when `moved` has the base's limit positions: details do not belong there.
ISOWAVE_EXPORT Rebuilt rebuild(Hierarchy hierarchy, const RebuildOptions& options = {},
                               const Progress& progress = {});

// ---- polylines ----

inline constexpr double kCurveRoundTrip = 1e-12;

struct CurveDetails {
    std::size_t points = 0;           // of the level that they restore
    std::vector<double> coordinates;  // points - coarser points, each of the curve's dimension
};

// A curve taken apart. Level 0 is the curve that was given, level k the one after k decompositions.
struct CurveLevels {
    std::string scheme;
    Polyline coarse;                    // of the level details.size()
    std::vector<CurveDetails> details;  // details[k] turns level k+1 into level k

    int levels() const { return static_cast<int>(details.size()); }
};

// The schemes that tables and tests walk: chaikin-4, chaikin-8, cubic-3, cubic-7, cubic-11, dlg-*.
ISOWAVE_EXPORT const std::vector<std::string>& curveSchemeNames();

class CurveFilters;

// A scheme's filters, derived once (10 to 300 ms) and used for any number of curves. Immutable; share it between
// threads.
class CurveTransform {
  public:
    // For open or for closed curves. Throws InputError that lists the schemes.
    ISOWAVE_EXPORT CurveTransform(std::string_view scheme, bool closed);
    // A mask of one's own ("1/8 1/2 3/4 1/2 1/8"), for closed curves. width: taps of A; 0: the smallest there is.
    // Throws InputError when the mask has no such A.
    ISOWAVE_EXPORT static CurveTransform ofMask(std::string_view mask, int width = 0);

    // How often a curve of so many points can be halved.
    ISOWAVE_EXPORT int mostLevels(std::size_t points) const;
    // Throws InputError when the curve has too few points (and says how many are needed), a coordinate is not finite
    // (and names the point), or the curve is open and the filters are for closed ones, or the other way round.
    ISOWAVE_EXPORT CurveLevels decompose(const Polyline& curve, int levels) const;
    // The curve at `level` (0: as it was). Throws InputError when scheme, sizes or levels do not belong together.
    ISOWAVE_EXPORT Polyline reconstruct(const CurveLevels& curve, int level = 0) const;
    // What P alone makes of level `from`: all finer details are taken for 0.
    ISOWAVE_EXPORT Polyline subdivided(const CurveLevels& curve, int from) const;
    // The points of a level at their limit positions: on the curve that they control, open B-splines at the Greville
    // abscissae, others as docs/subdivision.md says; of dlg the points themselves. Throws InputError when the scheme is a
    // mask whose subdivisions do not converge, or the curve is open and has fewer points than the scheme needs.
    ISOWAVE_EXPORT Polyline limit(const Polyline& curve) const;

  private:
    explicit CurveTransform(std::shared_ptr<const CurveFilters> filters) : filters_(std::move(filters)) {}
    std::shared_ptr<const CurveFilters> filters_;
};

// Sets every detail shorter than `length` (in the units of the curve) to 0; returns how many are left.
ISOWAVE_EXPORT std::size_t threshold(CurveLevels& curve, double length);
// Keeps the `count` longest details (all levels in one order; of equal ones the coarser, then the earlier).
ISOWAVE_EXPORT void keepLongest(CurveLevels& curve, std::size_t count);
ISOWAVE_EXPORT std::size_t detailCount(const CurveLevels& curve);
// Those that are not 0.
ISOWAVE_EXPORT std::size_t nonzeroDetailCount(const CurveLevels& curve);

struct CurveReportOptions {
    std::string scheme = "dlg-refined";
    std::string mask = {};  // "1/8 1/2 3/4 1/2 1/8": one of your own instead, for closed curves
    int width = 0;          // of A for such a mask; 0: the smallest there is
    int levels = 6;
    std::optional<std::size_t> resample = {};  // this many points at equal steps first
    std::optional<double> threshold = {};      // details shorter than this become 0
    std::optional<std::size_t> keep = {};      // or: only this many of the longest stay
    Positions positions = Positions::control;  // of the curves that are returned
    bool compare = false;                      // the L2 errors of dlg-trial, dlg-refined, dlg-optimal too
    bool details = false;                      // the bytes of a file of details too
};

struct CurveReport {
    struct Curve {
        int dimension = 2;
        bool closed = false;
        std::vector<std::size_t> points;  // of level 0, 1, ..; a short curve has fewer levels than asked for
        std::vector<double> error;        // ||level 0 - what P alone makes of level k||_2
        double roundTrip = 0;             // largest difference of a coordinate after reconstruction
        std::size_t details = 0, detailsLeft = 0;
        double thresholdError = 0;               // ||level 0 - the curve with the details that are left||_2
        std::map<std::string, double> compared;  // error of the coarsest level by scheme, when asked for
    };
    std::string scheme;
    int levels = 0;
    std::vector<Curve> curves;
    Positions positions = Positions::control;  // of the curves below; all errors are of control positions
    std::size_t tooShort = 0;                  // curves that do not have so many levels
    std::size_t withoutLimit = 0;              // open ones with too few points for limit positions: they stay
    std::vector<std::vector<Polyline>>
        atLevel;                        // atLevel[k]: every curve at level k, or at the coarsest it has
    std::vector<Polyline> smooth;       // P alone on the coarsest level of each
    std::vector<Polyline> thresholded;  // when details were dropped
    std::string details;                // curveDetailsBytes(), without the details that were dropped
};

// Takes curves apart as far as they go. Throws InputError when none of them has `levels` levels (and says how many
// points are needed), and for limit positions of a mask that has none.
ISOWAVE_EXPORT CurveReport reportCurves(std::vector<Polyline> curves, const CurveReportOptions& options);

// Curves that were taken apart by one scheme, as far as each goes: what `curve-levels --details` writes.
struct CurveSet {
    std::string scheme;  // by name; of a mask of one's own empty
    std::string mask = {};
    int width = 0;   // of A for such a mask
    int levels = 0;  // the most that a curve has
    std::vector<CurveLevels> curves;
};

// One file (docs/interfaces.md, "Details of curves and heights"): coarse curves and details to the bit, compressed; dropped
// details take next to nothing. loadCurveDetails() throws InputError: no such file, of another version, truncated, damaged.
ISOWAVE_EXPORT std::string curveDetailsBytes(const CurveSet& set);
ISOWAVE_EXPORT CurveSet loadCurveDetails(const std::filesystem::path& path);

// What putting curves or heights together again comes to.
struct LevelsRebuildReport {
    int levels = 0;          // subdivisions
    std::size_t pieces = 0;  // curves; 1 for heights
    std::size_t points = 0;
    std::size_t details = 0, kept = 0;  // of these levels; not 0
    double extent = 0;                  // the diagonal of the box around all points; of heights their range
    Positions positions = Positions::control;
    PointError error;  // what leaving details out has cost, at control positions
};

struct CurveRebuildOptions {
    std::vector<Polyline> moved = {};  // the coarse curves after an edit; empty: where they were
    // local: at each point the details turn as the tangent there does, from the subdivided curve before the edit to that after
    // it, before their details are added (Finkelstein and Salesin, "Multiresolution curves", 1994, section 4: details in the
    // frame of the coarse curve); in space as the points around do, and where these lie on a line, all points. A rigid motion of the
    // coarse curve then is one of every level; in space not where all of it is straight.
    Frames frames = Frames::global;
    int depth = kAllLevels;                // subdivisions; 0: the coarse curves
    std::optional<double> threshold = {};  // details shorter than this are left out
    std::optional<std::size_t> keep = {};  // or: only this many of the longest of each curve stay
    Positions positions = Positions::control;
};
struct RebuiltCurves {
    std::vector<Polyline> curves;
    LevelsRebuildReport report;
};
// Throws InputError: parts that do not belong together, an edited curve of another size, dimension or closing (which, and what
// was expected).
ISOWAVE_EXPORT RebuiltCurves rebuild(CurveSet set, const CurveRebuildOptions& options = {});

// ---- grids of heights ----

struct Grid {
    std::size_t rows = 0, columns = 0, channels = 1;
    std::vector<double> values;  // row by row, the channels of a sample together

    double at(std::size_t row, std::size_t column, std::size_t channel = 0) const {
        return values[(row * columns + column) * channels + channel];
    }
};

// The ones that tables and tests walk.
ISOWAVE_EXPORT const std::vector<std::string>& surfaceSchemeNames();

// How samples become nodes of the triangular lattice.
//   Rows       sample (row, column) is the node (column, row): every sample is used, and one diagonal of each square is
//              an edge. A parallelogram patch.
//   Quincunx   every second sample, alternating from row to row, as B section 11 does: (row, column) with row + column
//              even is the node i = (column - row)/2, j = row, so that neighbours stand at equal angles when columns
//              are half as far apart as rows times 2/sqrt 3. A hexagonal patch from the middle.
enum class ReliefLayout { Rows, Quincunx };

struct ReliefReportOptions {
    std::string scheme = "butterfly-3";
    ReliefLayout layout = ReliefLayout::Rows;
    int levels = 2;
    Positions positions = Positions::control;  // of the heights that are returned
    bool compare = false;                      // what the other schemes make of the relief without details
    bool details = false;                      // the bytes of a file of details too
};

// The relief at every level. Grids have the samples where they were: sample (r, c) of level k lies where (r 2^k, c 2^k) of
// level 0 does, and a grid of n rows has floor((n - 1) / 2^k) + 1 there. Rows takes a grid of any size: where its sides cannot
// be halved so often it is continued by its mirror image, which is cut off again; only details and nodes count that too.
// Quincunx takes the largest hexagon in the middle and leaves NaN outside.
struct ReliefReport {
    struct Level {
        std::string patch;  // "parallelogram 8 x 4"
        std::size_t nodes = 0;
        double detailRms = 0, detailLargest = 0;  // of the details that restore this level; 0 at the coarsest
        double suppressedRms = 0;                 // level 0 against P alone from here
        Grid heights;
        Grid detailLengths;  // |detail| at the edge nodes, 0 at vertex nodes; empty at the coarsest
        double detailPercentile99 = 0;  // of those lengths, over all nodes
    };
    std::string scheme;
    std::vector<Level> levels;
    double range[2] = {0, 0};  // of the values used
    double rmsStep = 1;        // between neighbours in a row of level 0; 1 where all are equal
    double roundTrip = 0;      // largest difference after reconstruction
    // Of the heights of levels and of `suppressed`; errors, range and `reconstructed` are of control positions.
    Positions positions = Positions::control;
    Grid reconstructed;                      // level 0, from the coarsest level and all details
    Grid suppressed;                         // P alone from the coarsest level
    std::map<std::string, double> compared;  // suppressedRms of the coarsest level, by scheme
    std::string details;                     // the file of details
};

// Throws InputError for an unknown scheme, when the grid is too small for so many levels, and for limit positions of a
// loop-like scheme that does not converge.
ISOWAVE_EXPORT ReliefReport reportRelief(const Grid& grid, const ReliefReportOptions& options);

// Heights from a file of details (`relief --details`), at any level, edited or simplified.
struct ReliefRebuildOptions {
    // The coarse heights after an edit, as large as coarseHeights(). What lies beyond the relief's own samples (Rows continues
    // it) moves as the nearest of them does. Of Quincunx the samples of the hexagon count, which must be finite; those between them
    // are not looked at.
    std::optional<Grid> edited = {};
    int depth = kAllLevels;                // subdivisions; 0: the coarse heights
    std::optional<double> threshold = {};  // details smaller than this are left out
    std::optional<std::size_t> keep = {};  // or: only this many of the largest stay
    Positions positions = Positions::control;
};
struct RebuiltRelief {
    Grid heights;
    LevelsRebuildReport report;
};
struct ReliefParts;  // subdivision/lattice/relief_details.h
class ReliefDetails {
  public:
    // Throws InputError: no such file, of another version, truncated, damaged.
    ISOWAVE_EXPORT static ReliefDetails load(const std::filesystem::path& path);
    // Of ReliefReport::details. name: stands in messages.
    ISOWAVE_EXPORT static ReliefDetails read(std::string_view bytes, const std::string& name);
    ISOWAVE_EXPORT const std::string& scheme() const;
    ISOWAVE_EXPORT int levels() const;
    // level_K of `relief`, as it is written without --limit.
    ISOWAVE_EXPORT Grid coarseHeights() const;
    // Throws InputError for edited heights of another size, and what reconstruct() throws.
    ISOWAVE_EXPORT RebuiltRelief rebuild(const ReliefRebuildOptions& options = {}) const;

  private:
    explicit ReliefDetails(std::shared_ptr<const ReliefParts> parts) : parts_(std::move(parts)) {}
    std::shared_ptr<const ReliefParts> parts_;
};

// The pictures of a report, one after the other: level_K (grey by height), shade_K (lit from the upper left), details_K
// (white: 0, black: the 99th percentile of |d| or more), suppressed, suppressed_shade. Values from `black` to `white`,
// either of which may be the larger; NaN is white. Of point grids the last channel is shown.
using PictureVisitor =
    std::function<void(const std::string& name, const Grid& values, double black, double white)>;
ISOWAVE_EXPORT void forEachPicture(const ReliefReport& report, const PictureVisitor& visit);

}  // namespace isowave::subdivision
