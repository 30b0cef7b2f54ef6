// Closed curves in the plane at every level of detail: the outline of what is inside a picture or inside polygons.
//
//   using namespace isowave::curves2d;
//   Input africa = readInput("africa.geojson", {.pixels = 363});
//   const View view = viewOf(africa);
//   makeLadder(std::move(africa), {}, [&](const LadderStep& step) {
//       if (step.level()) write("africa" + step.name() + ".svg", svg(step.drawn({.tolerance = 0.1}), view));
//   });
//
// The input becomes a lattice of pixels, the lattice a uniform bicubic B-spline, and the curves are where the spline is
// zero. Each *step* of the wavelet transform halves the resolution along one axis, x first; a *level* is two steps, so
// level l has pixels of 2^l times the size. A coarser level has less detail and, because it is the function that is
// made coarser, other topology too: islands vanish, holes close, narrow straits fill. What is thin
// stays whole, unless LadderOptions say otherwise.
//
// Coordinates are the input's: x and y of the polygons, or pixels of the image with (0, 0) in the middle of the first
// one and y pointing down. Lengths are in the input's unit too, but for tolerances, which are in pixels of level 0.
// Functions throw InputError for bad data (isowave/error.h) and Cancelled when progress asks to stop.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave::curves2d {

// ---- points and rings ----

struct Point {
    double x = 0, y = 0;

    double operator[](int axis) const { return axis == 0 ? x : y; }
    friend Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
    friend Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
    friend Point operator*(double s, Point p) { return {s * p.x, s * p.y}; }
    friend bool operator==(const Point&, const Point&) = default;
};

// A closed polyline; the last point is joined to the first one, which is not repeated.
using Ring = std::vector<Point>;

// The points that lie inside an odd number of its rings. Which ring is the outer one follows from that; their
// directions mean nothing.
struct Polygon {
    std::vector<Ring> rings;
};

// A straight piece of a boundary.
struct Segment {
    Point a, b;
};

struct Box {
    Point low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};

    void take(Point p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    void take(const Box& box) {
        take(box.low);
        take(box.high);
    }
    bool empty() const { return !(low.x <= high.x); }
    bool meets(const Box& other) const {
        return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
               other.low.y <= high.y;
    }
};

// Where lattice point (i, j) lies: origin + spacing * (i, j). One step down the ladder doubles one spacing
// and leaves the origin.
struct Frame {
    Point origin{0, 0};
    Point spacing{1, 1};

    Point toWorld(Point lattice) const {
        return {origin.x + spacing.x * lattice.x, origin.y + spacing.y * lattice.y};
    }
    Point toLattice(Point world) const {
        return {(world.x - origin.x) / spacing.x, (world.y - origin.y) / spacing.y};
    }
    friend bool operator==(const Frame&, const Frame&) = default;
};

// ---- curves ----

struct CurveRing {
    Ring points;  // lattice coordinates
    // The ring directly around it: of a hole its outer ring, of an island in a hole the hole; -1 for none.
    int parent = -1;
    bool hole = false;
};

// Rings are simple and pairwise disjoint. Inside lies to the left: with y pointing up outer rings run
// counter-clockwise and holes clockwise.
struct Curves {
    Frame frame;  // of the lattice
    std::vector<CurveRing> rings;

    // The points of a ring in the input's coordinates. REQUIRES: ring < rings.size().
    ISOWAVE_EXPORT Ring world(std::size_t ring) const;
    ISOWAVE_EXPORT std::size_t outerCount() const;
    ISOWAVE_EXPORT std::size_t holeCount() const;
    ISOWAVE_EXPORT std::size_t pointCount() const;
    // Outer rings less holes, in the input's unit squared.
    ISOWAVE_EXPORT double area() const;
};

struct Bezier {
    Point start, startHandle, endHandle, end;  // the input's coordinates
    ISOWAVE_EXPORT Point at(double t) const;
};

struct SmoothCurves {
    std::vector<std::vector<Bezier>> rings;  // in the order of Curves::rings
    double deviation = 0;                    // the largest distance from the zero set that was seen
    std::size_t straightPieces = 0;          // pieces left straight because no halving would do
};

// How the input's coordinates become a picture.
struct View {
    Box extent;        // what the picture shows
    bool yUp = false;  // turn the picture round, so that north is up
};

// One of several curves in a sheet.
struct Panel {
    std::string label;
    Curves curves;
};

// ---- input ----

enum class Fit { binary, distance };

// What happens to parts of a shape that are thinner than a level's pixels. local: they stay whole, by a change of the level
// beside them, and no level has more parts or holes than the one before. none: they tear and vanish; the levels are the
// wavelet transform's own, as the paper has them.
enum class Hold { none, local };

struct InputOptions {
    std::optional<double> iso = std::nullopt;  // pictures; without it the middle of the range of values
    // Pictures. Inside is where the value exceeds iso; where that is the whole border of the picture, and not all of it, it is
    // the ground, and inside is the drawing, where the value does not. invert: the other way round.
    bool invert = false;
    std::int32_t pixels = 1024;  // polygons: along the longer side
};

struct Shape;   // curves2d/fit.h: the lattice points inside, and the boundary between them
struct Fitted;  // curves2d/fit.h: level 0

// An input, ready to be fitted, or fitted.
struct Input {
    std::shared_ptr<const Shape> shape;    // empty when it is fitted
    std::shared_ptr<const Fitted> fitted;  // after fit(), or read from the file of a pyramid
    Box extent;        // the input's coordinates: of the image with half a pixel around, or of the polygons
    bool yUp = false;  // polygons; an image's y points down
    Fit fit = Fit::distance;           // what suits it: binary for masks, whose distances would be staircases
    std::string kind;                  // "image 400 x 328", "12 polygons of 14 rings, 2113 points"
    std::vector<std::string> remarks;  // defaults taken, rings repaired
    double pixel = 1;                  // of level 0, in the input's unit
};

// Reads an image (PNG, TIFF, BMP, PGM, PBM), polygons (GeoJSON, TopoJSON, text) or a pyramid (.iwc, which needs no
// options), told apart by the file's name. Throws InputError: no such file, truncated, damaged, every pixel on one side, no
// ring of three points, a coordinate that is no finite number, no pixel's middle inside.
ISOWAVE_EXPORT Input readInput(const std::filesystem::path& path, const InputOptions& options = {},
                               const Progress& progress = {});

// The same for values that are already in memory: one a pixel, row by row, width * height of them.
// name: stands in messages.
ISOWAVE_EXPORT Input pictureInput(std::int32_t width, std::int32_t height, std::vector<float> values,
                                  const InputOptions& options = {}, const std::string& name = "picture");
ISOWAVE_EXPORT Input polygonInput(const std::vector<Polygon>& polygons, const InputOptions& options = {},
                                  const Progress& progress = {}, const std::string& name = "polygons");

// ---- the ladder ----

// How well the spline's signs agree with the input's.
struct FitReport {
    std::int64_t latticePoints = 0;  // where control points are known
    std::int64_t disagreeing = 0;    // of these, whose sign is not the input's (0 unless the repair gave up)
    int repairPasses = 0;            // passes that changed something
    // The repair stopped because every lattice point had its sign by the floor, not at the limit of passes.
    bool repairAgreed = true;
    double repairFloor = 0;     // the least |F| that counts as agreed, as a part of K
    std::int64_t repaired = 0;  // control points changed by the repair, counted once a pass
};

struct LadderOptions {
    std::optional<Fit> fit = {};  // without it what suits the input
    // Of the distance fit, in pixels: distances are clamped to ±halfWidth, and nodes nearer than `band` are kept.
    double halfWidth = 4;
    std::optional<double> band = {};  // without it 2, or halfWidth where that is less
    Hold hold = Hold::local;
    int firstStep = 0;  // finer ones are computed but not visited
    // Without it as far as the transform goes: to one node, 4 x 4 control points.
    std::optional<int> lastStep = {};
};

// What was done to a level so that thin parts stay whole and topology only falls. Areas in the input's unit squared.
struct HoldFacts {
    // Where level 0 is at most 1.5 pixels of the level thick (places on its lattice lines, in parts larger than a pixel of
    // the level), and the share of these places inside the level's curves.
    std::int64_t samples = 0;
    double kept = 1;
    // Steps of the lattice in a pixel of the level (1, 2, 4): the curves are sampled on it where they are held.
    int sampling = 1;
    std::int64_t changed = 0;  // control points of that lattice that differ from the plain level's
    std::size_t islands = 0;   // parts left out that are smaller than a pixel of the level and not held
    // Where the level would have more parts or holes than the level before: parts joined, holes opened; parts dropped, holes
    // filled, as wholes. And the area that these four change.
    std::size_t joined = 0, opened = 0, dropped = 0, filled = 0;
    double area = 0;
};

struct StepFacts {
    int step = 0;
    std::array<std::int32_t, 2> domain{};  // control points of the box around the known ones, x and y
    std::int64_t controlPoints = 0;        // known ones
    std::int64_t nodes = 0;                // unit squares whose 16 control points are known
    std::size_t rings = 0;                 // outer ones
    std::size_t holes = 0;
    std::size_t points = 0;
    double area = 0;         // the input's unit squared
    double maxToLevel0 = 0;  // from points on this step's curves to the curves of step 0; the input's unit
    double rmsToLevel0 = 0;  // weighted by length. Both one-sided: an island that has gone costs nothing
    std::optional<HoldFacts> hold;  // of levels from 1 on, unless Hold::none
};

// "L0", "L0a", "L1", ...: step s is level s/2 when s is even; the step between level l and the next one is "la". (Esteve,
// Brunet, Vinacua, "Multiresolution for algebraic curves and surfaces using wavelets", Table 1, has the same steps, with
// levels counted from 1: 1, 1a, 2, ...)
ISOWAVE_EXPORT std::string stepName(int step);

struct DrawOptions {
    // In pixels of level 0. Polylines get more points, all on the zero set, until they are within it; without a
    // tolerance they join the places where the zero set crosses the lattice. Smooth curves without one take 0.1.
    std::optional<double> tolerance = {};
    bool smooth = false;  // cubic Bezier curves as well
};

struct DrawnCurves {
    Curves curves;
    std::optional<SmoothCurves> smooth;
};

template <class Real>
struct RowField;

// A step as it passes by. REQUIRES: used within the visit only.
class LadderStep {
  public:
    // traced: the same curves as `curves`, with a point wherever they cross the field's lattice.
    LadderStep(const StepFacts& facts, const Curves& curves, const Curves& traced,
               const RowField<float>& field, double pixel)
        : facts_(facts), curves_(curves), traced_(traced), field_(field), pixel_(pixel) {}

    const StepFacts& facts() const { return facts_; }
    std::string name() const { return stepName(facts_.step); }
    // Nothing for the steps between two levels.
    std::optional<int> level() const {
        return facts_.step % 2 == 0 ? std::optional<int>(facts_.step / 2) : std::nullopt;
    }
    // A point wherever a curve crosses the level's lattice; where thin parts are held, a finer one.
    const Curves& curves() const { return curves_; }
    ISOWAVE_EXPORT DrawnCurves drawn(const DrawOptions& options = {}) const;
    // For a sheet (below): as exact as its small pictures show, labelled with the step's name.
    ISOWAVE_EXPORT Panel panel(const View& view) const;

  private:
    const StepFacts& facts_;
    const Curves &curves_, &traced_;
    const RowField<float>& field_;
    double pixel_;
};

struct Ladder {
    std::vector<StepFacts>
        steps;  // from step 0 on, visited or not, to the last or to the first without a ring
    std::int64_t coefficients = 0;   // what the wavelet transform stores
    std::int64_t controlPoints = 0;  // of step 0
    Fit fit = Fit::distance;
    double halfWidth = 0, band = 0;  // pixels; of the distance fit
    FitReport fitReport;
};

// The input with its fit, which is what takes the options `fit`, `halfWidth` and `band`: makeLadder() then only climbs. One
// that is fitted stays as it is.
ISOWAVE_EXPORT Input fitted(Input input, const LadderOptions& options = {}, const Progress& progress = {});

// Polygons that are added to a shape, or cut out of it. The tool is sampled on the lattice of `level`: its corners are as round
// as the curves of that level are, and its straight edges are where they should be.
struct PolygonEdit {
    bool cut = false;
    std::vector<Polygon> polygons;
    int level = 0;
};
// A fitted input with an edit: level 0 as it is away from the tool, to the bit, and every coarser level follows from it.
// REQUIRES: input.fitted; 0 <= level <= 20. name: of the tool, for messages. Throws InputError: the tool covers no pixel's
// middle at its level, it changes nothing, nothing would be left.
ISOWAVE_EXPORT Input edited(Input input, const PolygonEdit& edit, const std::string& name = "tool",
                            const Progress& progress = {});

// The file of a pyramid (.iwc): level 0 of a fitted input to the bit, compressed, from which every step follows, and what of
// the input the curves need. makeLadder() of readInput() of it gives the curves of the input itself, to the bit.
// REQUIRES: input.fitted. savePyramid() throws OperationError; the file appears whole or not at all.
ISOWAVE_EXPORT std::string pyramidBytes(const Input& input);
ISOWAVE_EXPORT void savePyramid(const std::filesystem::path& path, const Input& input);

using LadderVisitor = std::function<void(const LadderStep& step)>;

// Fits the input, unless it is fitted, and visits the curves of every step, the finest first. `input` is let go of as soon as it is fitted:
// move it in where memory counts. The same curves in the same order for any number of threads.
// REQUIRES: 0 < band <= halfWidth.
ISOWAVE_EXPORT Ladder makeLadder(Input input, const LadderOptions& options, const LadderVisitor& visit,
                                 const Progress& progress = {});

// The curves of all levels at once, for inputs of a size that allows it.
struct LevelCurves {
    StepFacts facts;
    DrawnCurves drawn;
};
ISOWAVE_EXPORT std::vector<LevelCurves> levelCurves(Input input, const LadderOptions& options = {},
                                                    const DrawOptions& draw = {},
                                                    const Progress& progress = {});

// ---- drawing ----

// All of the input.
inline View viewOf(const Input& input) { return {input.extent, input.yUp}; }

// An SVG of one path of all rings, filled by the even-odd rule; 1024 units along the longer side. Coordinates are the
// input's, with 10 digits.
ISOWAVE_EXPORT std::string svg(const Curves& curves, const View& view);
ISOWAVE_EXPORT std::string svg(const SmoothCurves& curves, const View& view);
// The smooth curves where there are any.
ISOWAVE_EXPORT std::string svg(const DrawnCurves& curves, const View& view);

// A FeatureCollection of one MultiPolygon: every outer ring with the holes directly in it, the first point repeated at
// the end (RFC 7946). 12 digits, so that rings which are simple stay so. name: a property of the feature.
ISOWAVE_EXPORT std::string geojson(const Curves& curves, const std::string& name);

// GMT's multiple segments: "> outer" or "> hole in N" before the lines `x y` of each ring, the first point repeated;
// ring N is the N-th in the text, from 0. 12 digits.
ISOWAVE_EXPORT std::string gmtText(const Curves& curves);

// One SVG of several panels: left to right, top to bottom, each with its label below.
ISOWAVE_EXPORT std::string sheetOf(const std::vector<Panel>& panels, const View& view);

}  // namespace isowave::curves2d
