#include "tools/commands.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "isowave/error.h"

namespace isowave::tools {
namespace {

// ---- one function a type: text -> value, UsageError in words when it is not one ----

template <class Number>
Number parseWhole(const std::string& text, const char* expected) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty())
        throw UsageError("'" + text + "' is not " + expected);
    return value;
}

double number(const std::string& text) {
    const double value = parseWhole<double>(text, "a number");
    if (!std::isfinite(value)) throw UsageError("'" + text + "' is not a finite number");
    return value;
}

double positive(const std::string& text) {
    const double value = number(text);
    if (value <= 0) throw UsageError("'" + text + "' is not above 0");
    return value;
}

std::int64_t integer(const std::string& text, std::int64_t low, std::int64_t high) {
    const auto value = parseWhole<std::int64_t>(text, "a whole number");
    if (value < low || value > high)
        throw UsageError("'" + text + "' is not between " + std::to_string(low) + " and " +
                         std::to_string(high));
    return value;
}

// A,B,C
template <class Parse>
auto list(const std::string& text, Parse parse) {
    std::vector<decltype(parse(text))> result;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        result.push_back(parse(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return result;
}

constexpr int kMaxStep = 10'000;

// A..B, A.., ..B or A.
StepRange range(const std::string& text) {
    const auto step = [](const std::string& t) { return static_cast<int>(integer(t, 0, kMaxStep)); };
    const auto dots = text.find("..");
    StepRange result;
    if (dots == std::string::npos) {
        result.first = step(text);
        result.last = result.first;
        return result;
    }
    const std::string first = text.substr(0, dots), last = text.substr(dots + 2);
    if (first.empty() && last.empty()) throw UsageError("'..' names no number; write for example 0..3");
    if (!first.empty()) result.first = step(first);
    if (!last.empty()) result.last = step(last);
    if (result.last && *result.last < result.first)
        throw UsageError("'" + text + "' runs backwards; write the smaller number first");
    return result;
}

// AxBxC; commas will do too.
template <class Number, class Parse>
std::array<Number, 3> triple(const std::string& text, const char* example, Parse parse) {
    std::array<Number, 3> result{};
    std::size_t begin = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t end = text.find_first_of("x,", begin);
        if ((end == std::string::npos) != (axis == 2))
            throw UsageError("'" + text + "' is not three numbers such as " + example);
        result[axis] = parse(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return result;
}

template <class Value, std::size_t N>
Value choice(const std::string& text, const std::array<std::pair<std::string_view, Value>, N>& choices) {
    std::string list;
    for (const auto& [name, value] : choices) {
        if (text == name) return value;
        list += (list.empty() ? "" : ", ") + std::string(name);
    }
    throw UsageError("'" + text + "' is not one of " + list);
}

// ---- the table ----

constexpr std::string_view kOutput =
    "lod analyse mesh field curve-levels relief reverse rebuild subdivide curves";
constexpr std::string_view kFit = "lod analyse mesh field";  // those that turn an input into a field
constexpr std::string_view kShaped = "lod analyse mesh field curves";  // those that fit a field
constexpr std::string_view kImages = "lod analyse mesh field info";    // those that read images
constexpr std::string_view kAll = "lod analyse mesh field info check compare curves";
constexpr std::string_view kQuiet =
    "lod analyse mesh field info check compare curves filters curve-levels relief reverse rebuild subdivide";

constexpr Command kCommands[] = {
    {"lod", "INPUT", "a solid -> a ladder of closed meshes, one a level, and a report",
     "INPUT is an image (NIfTI, NRRD, MetaImage, TIFF; a folder of DICOM, TIFF or PNG slices; raw with "
     "--size), a "
     "mesh (STL, OBJ, PLY, OFF), a level set (.vdb) or a pyramid (analyse). -o out/part makes the folder "
     "out/part "
     "with part_L0.ply, part_L1.ply, ... and report.json; with --steps the meshes are part_s0.ply, "
     "part_s1.ply, ... "
     "Level L is step 3L: every axis halved L times. With a budget there is one mesh a budget "
     "instead of one a level (give --levels to have both): the step whose topology suits it, with edges "
     "collapsed; the report says which and why. The ladder ends where one node is left, or before the "
     "first "
     "level at which the whole solid has vanished. A run that fails or is interrupted leaves the folder as "
     "it was.",
     true, runLod},
    {"analyse", "INPUT", "a solid -> its pyramid, lossless, in one .vdb",
     "Takes what lod takes. Every step of the pyramid can be had back with mesh and field.", true,
     runAnalyse},
    {"mesh", "INPUT", "any step of a pyramid (or of a solid) -> a mesh file",
     "The format follows from the name of the output, or from --format.", true, runMesh},
    {"field", "INPUT", "any step of a pyramid (or of a solid) -> its B-spline field as .vdb for other tools",
     "The grid 'field' holds control points, negative inside; outside the band they are plus or minus K.",
     true, runField},
    {"info", "FILE", "what is in an image, a mesh, a .vdb or a pyramid",
     "Prints size, spacing, orientation and the range of values of an image; counts and bounds of a mesh; "
     "the grids "
     "of a .vdb; a table of the steps of a pyramid.",
     false, runInfo},
    {"check", "MESH", "is a mesh closed, 2-manifold and oriented? components, genus, volume, area",
     "Reads the mesh as it is, merges equal points and repairs nothing. Exit code 4 when it is not closed, "
     "not "
     "2-manifold or not oriented.",
     false, runCheck},
    {"compare", "A B", "distances between two meshes, both ways, and their volume difference",
     "Distances from samples of one surface to the nearest point of the other: mean and rms weighted by "
     "area, "
     "max over the samples, and a bound that no point of the surface exceeds.",
     false, runCompare},
    {"filters", "[SUBDIVISION]", "a subdivision -> its four filters A, B, P, Q, exactly, with proof",
     "SUBDIVISION is chaikin, cubic, dlg, dlg-refined, bspline-D, butterfly, loop, loop-like:ALPHA,GAMMA or "
     "catmull-clark; or give your own --mask. Prints the diagrams as rationals: rows on the line, pictures "
     "of "
     "the lattice else. AP = I, BP = 0, AQ = 0 and BQ = I are checked in rationals.",
     false, runFilters},
    {"curve-levels", "INPUT", "curves -> the same curves at coarser levels, losslessly",
     "INPUT holds polylines: .txt (a point a line), GeoJSON, SVG paths. -o out/coast makes the folder "
     "out/coast with "
     "level_0, level_1, ... in the same format, and smooth: the coarsest level subdivided back, without "
     "details. "
     "Open curves keep their ends; any number of points will do. Prints the points and the L2 error of each "
     "level.",
     true, runCurveLevels},
    {"relief", "INPUT", "a height field -> coarser levels on the triangular lattice, losslessly",
     "INPUT is a picture (PNG, TIFF), a NumPy array (.npy) or an ESRI ASCII grid (.asc). -o out/relief makes "
     "the folder "
     "out/relief with level_K.npy and .png, shade_K.png (lit), details_K.png, suppressed.npy and .png (the "
     "coarsest "
     "level subdivided back, without details) and reconstructed.npy.",
     true, runRelief},
    {"reverse", "MESH", "a mesh with subdivision connectivity -> a coarse base mesh and details, losslessly",
     "MESH (OBJ, OFF, PLY) is one that subdivision has made, moved points and all: catmull-clark finds the "
     "polygons "
     "inside a mesh of quads, loop and butterfly the triangles inside one of triangles; vertices and faces "
     "may come "
     "in any order. -o BASE is the coarse mesh, --details FILE everything that is needed to have MESH back. "
     "Marked "
     "creases ('t crease 2/1/0 V1 V2 SHARPNESS', vertices counted from 0) and boundaries are curves of their "
     "own.",
     true, runReverse},
    {"rebuild", "BASE", "a base mesh and its details -> the mesh at any level, edited or simplified",
     "BASE and --details FILE come from reverse. --edited BASE2 is BASE with moved vertices: the details "
     "follow. "
     "--threshold and --keep leave short details out and measure what that costs.",
     true, runRebuild},
    {"subdivide", "MESH", "a polygon mesh -> the same, subdivided by Catmull-Clark, Loop or Butterfly",
     "MESH is OBJ, OFF or PLY; so is the output, by its name.", true, runSubdivide},
    {"curves", "INPUT", "a bitmap or polygons -> a ladder of closed planar curves, one a level",
     "INPUT is an image (PNG, TIFF, BMP, PGM, PBM) or polygons (GeoJSON, TopoJSON, text with rings as lines "
     "'x y'). -o out/africa makes the folder out/africa with africa_L0.svg, africa_L1.svg, ...; a level at "
     "which nothing is left has no file. Level L is step 2L: both axes halved L times. Outer rings have "
     "positive area, holes negative, in the input's own coordinates.",
     true, runCurves},
    {"help", "[COMMAND]", "this overview, or the options of one subcommand", "", false, runHelp},
    {"completion", "bash", "a completion script for the shell: source <(isowave completion bash)", "", false,
     runCompletion},
};

constexpr std::array<std::pair<std::string_view, MeshFormat>, 5> kFormats{{{"stl", MeshFormat::stl},
                                                                           {"ply", MeshFormat::ply},
                                                                           {"obj", MeshFormat::obj},
                                                                           {"off", MeshFormat::off},
                                                                           {"glb", MeshFormat::glb}}};
constexpr std::array<std::pair<std::string_view, CurveFormat>, 4> kCurveFormats{
    {{"svg", CurveFormat::svg},
     {"geojson", CurveFormat::geojson},
     {"png", CurveFormat::png},
     {"txt", CurveFormat::txt}}};
constexpr std::array<std::pair<std::string_view, FitMethod>, 2> kMethods{
    {{"binary", FitMethod::binary}, {"distance", FitMethod::distance}}};
constexpr std::array<std::pair<std::string_view, Space>, 2> kSpaces{
    {{"lps", Space::lps}, {"ras", Space::ras}}};
constexpr std::array<std::pair<std::string_view, bool>, 2> kEndians{{{"little", false}, {"big", true}}};
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTypes{{{"int8", "int8"},
                                                                               {"uint8", "uint8"},
                                                                               {"int16", "int16"},
                                                                               {"uint16", "uint16"},
                                                                               {"int32", "int32"},
                                                                               {"uint32", "uint32"},
                                                                               {"float32", "float32"},
                                                                               {"float64", "float64"}}};
constexpr int kMostSubdivisions = 15;  // a quad becomes 2^30
constexpr std::int64_t kHuge = std::int64_t{1} << 40;

constexpr Option kOptions[] = {
    // What comes out.
    {"-o,--output", "PATH", "",
     "where the result goes: a folder for lod, curves, curve-levels and relief, a file otherwise", kOutput,
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.output = v;
     }},
    {"--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)", "lod curves",
     [](Settings& s, const std::string& v) { s.levels = range(v); }},
    {"--steps", "A..B", "", "steps instead of levels; three steps are a level", "lod",
     [](Settings& s, const std::string& v) { s.steps = range(v); }},
    {"--step", "S", "0", "which step", "mesh field",
     [](Settings& s, const std::string& v) { s.step = static_cast<int>(integer(v, 0, kMaxStep)); }},
    {"--level", "L", "", "which level, instead of --step", "mesh field",
     [](Settings& s, const std::string& v) { s.level = static_cast<int>(integer(v, 0, kMaxStep / 3)); }},
    {"--format", "stl|ply|obj|off|glb", "ply for lod, by the file's extension for mesh",
     "format of the meshes", "lod mesh",
     [](Settings& s, const std::string& v) { s.format = choice(v, kFormats); }},
    {"--format", "svg|geojson|png|txt", "svg", "format of the curves", "curves",
     [](Settings& s, const std::string& v) { s.curveFormat = choice(v, kCurveFormats); }},
    {"--smooth", "", "", "SVG: cubic Beziers along the zero set instead of straight pieces", "curves",
     [](Settings& s, const std::string&) { s.smooth = true; }},
    {"--tolerance", "T", "smooth: 0.1; otherwise no added points",
     "the drawn curve stays within T pixels of level 0 of the zero set, by added points", "curves",
     [](Settings& s, const std::string& v) { s.tolerance = positive(v); }},
    {"--table", "", "", "print a table of the steps: domain, control points, nodes, rings, area", "curves",
     [](Settings& s, const std::string&) { s.table = true; }},
    {"--sheet", "FILE", "", "one SVG with all levels side by side", "curves",
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.sheet = v;
     }},
    {"--space", "lps|ras", "lps for images, as it is for meshes",
     "axes of the written coordinates, for medical images and meshes that say SPACE=", "lod mesh",
     [](Settings& s, const std::string& v) { s.space = choice(v, kSpaces); }},
    {"--refine", "1|2|4", "1", "samples of a node along each axis: more triangles, closer to the spline",
     "lod mesh",
     [](Settings& s, const std::string& v) {
         s.refine =
             choice(v, std::array<std::pair<std::string_view, int>, 3>{{{"1", 1}, {"2", 2}, {"4", 4}}});
     }},
    {"--preserve-volume", "", "",
     "each level at the iso-value that gives it the volume of level 0, to 0.01 %", "lod mesh",
     [](Settings& s, const std::string&) { s.preserveVolume = true; }},
    {"--protect-thin", "", "",
     "each level at the least iso-value that keeps thin walls and rods together; sampled twice as fine where "
     "that leaves fewer holes in them",
     "lod mesh", [](Settings& s, const std::string&) { s.protectThin = true; }},
    {"--keep-specks", "", "",
     "coarser levels keep components and cavities that are smaller than one of their nodes", "lod mesh",
     [](Settings& s, const std::string&) { s.keepSpecks = true; }},
    {"--features", "", "",
     "measure parts, holes and cavities, and say up to which size they vanish (takes longer)", "lod info",
     [](Settings& s, const std::string&) { s.features = true; }},
    {"--refit", "", "",
     "the field of each level fitted once more to the surface of level 0: nearer to it, and to its volume",
     "lod mesh", [](Settings& s, const std::string&) { s.refit = true; }},
    {"--compact", "", "",
     "with --refine: collapse each mesh down to about the triangles that it has without it; nearer to the "
     "surface at the same size",
     "lod mesh", [](Settings& s, const std::string&) { s.compact = true; }},
    {"--relax", "N", "0", "N rounds of sliding vertices along the surface: larger angles, same zero set",
     "lod mesh", [](Settings& s, const std::string& v) { s.relax = static_cast<int>(integer(v, 0, 1000)); }},
    {"--deviation", "", "", "measure how far triangles are from the zero set of the spline", "lod mesh",
     [](Settings& s, const std::string&) { s.deviation = true; }},
    {"--json", "FILE", "", "the report goes to this file too; - is standard output", "lod curves",
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.jsonFile = v;
     }},
    {"--json", "", "", "print JSON instead of text",
     "info check compare filters curve-levels relief reverse rebuild subdivide",
     [](Settings& s, const std::string&) { s.json = true; }},

    // Meshes by budget.
    {"--triangles", "N,N,...", "", "instead of the levels, meshes of at most so many triangles: name_TN",
     "lod",
     [](Settings& s, const std::string& v) {
         s.budgetTriangles = list(v, [](const std::string& n) { return integer(n, 4, kHuge); });
     }},
    {"--ratio", "R,R,...", "", "the same as a share of level 0's triangles (0.01 = 1 %): name_RR", "lod",
     [](Settings& s, const std::string& v) {
         s.budgetRatios = list(v, [](const std::string& r) {
             const double ratio = positive(r);
             if (ratio > 1) throw UsageError("'" + r + "' is above 1, all of level 0's triangles");
             return ratio;
         });
     }},
    {"--tolerance", "D,D,...", "",
     "the fewest triangles that stay within D (world units) of level 0, both ways: name_DD", "lod",
     [](Settings& s, const std::string& v) { s.budgetTolerances = list(v, positive); }},
    {"--max-genus", "N", "", "budgets: only from steps with at most N handles; alone: the finest such step",
     "lod", [](Settings& s, const std::string& v) { s.maxGenus = integer(v, 0, kHuge); }},
    {"--min-component", "VOLUME", "",
     "budgets: only from steps without components smaller than that (world units cubed)", "lod",
     [](Settings& s, const std::string& v) { s.minComponent = positive(v); }},

    // What the solid is.
    {"--iso", "V", "masks: midpoint; labels: not zero; level sets: 0; other images: required",
     "the surface is where the value is V; inside is where it is larger (level sets: smaller)", kFit,
     [](Settings& s, const std::string& v) { s.iso = number(v); }},
    {"--iso", "V", "the middle of the range of values",
     "images: the curve is where the value is V; inside is where it is larger", "curves",
     [](Settings& s, const std::string& v) { s.iso = number(v); }},
    {"--pixels", "N", "1024", "polygons: sample with N pixels along the longer side", "curves",
     [](Settings& s, const std::string& v) {
         s.pixels = static_cast<std::int32_t>(integer(v, 1, std::int64_t{1} << 22));
     }},
    {"--label", "L", "every label but 0", "the solid is where a label image is L (after NIfTI's scaling)", kFit,
     [](Settings& s, const std::string& v) { s.label = number(v); }},
    {"--invert", "", "", "swap inside and outside", kShaped,
     [](Settings& s, const std::string&) { s.invert = true; }},
    {"--open-border", "", "", "no cap where the solid touches the border of the image", kFit,
     [](Settings& s, const std::string&) { s.openBorder = true; }},
    {"--voxels", "N", "256", "meshes: sample with N voxels along the longest axis", kFit,
     [](Settings& s, const std::string& v) { s.voxels = integer(v, 4, 1'000'000'000); }},
    {"--voxel", "LEN", "", "meshes: sample with voxels of this size (world units)", kFit,
     [](Settings& s, const std::string& v) { s.voxel = positive(v); }},

    // The fit.
    {"--fit", "binary|distance", "binary for masks and labels, otherwise distance",
     "from signs alone (filtered weights), or from signed distances", kShaped,
     [](Settings& s, const std::string& v) { s.fit = choice(v, kMethods); }},
    {"--half-width", "W", "4", "distance fit: the distance is clamped to W voxels each side", kShaped,
     [](Settings& s, const std::string& v) { s.halfWidth = positive(v); }},
    {"--band", "B", "2", "distance fit: nodes nearer than B voxels are kept; at most W", kShaped,
     [](Settings& s, const std::string& v) { s.band = positive(v); }},

    // How to read the input.
    {"--size", "NXxNYxNZ", "", "the image has no header: voxels on each axis, x fastest", kImages,
     [](Settings& s, const std::string& v) {
         s.size = triple<std::int64_t>(v, "256x256x108",
                                       [](const std::string& t) { return integer(t, 1, kHuge); });
     }},
    {"--type", "int8|uint8|int16|uint16|int32|uint32|float32|float64", "",
     "headerless image: type of a voxel", kImages,
     [](Settings& s, const std::string& v) { s.type = std::string(choice(v, kTypes)); }},
    {"--spacing", "XxYxZ", "1x1x1 where the file has none", "voxel size in mm; replaces the header's",
     kImages,
     [](Settings& s, const std::string& v) { s.spacing = triple<double>(v, "0.957x0.957x1.5", positive); }},
    {"--endian", "little|big", "little", "headerless image: byte order", kImages,
     [](Settings& s, const std::string& v) { s.bigEndian = choice(v, kEndians); }},
    {"--header-bytes", "N", "0", "headerless image: bytes to skip at the start", kImages,
     [](Settings& s, const std::string& v) { s.headerBytes = integer(v, 0, kHuge); }},
    {"--series", "ID", "", "DICOM folder with several series: a part of its UID or description", kImages,
     [](Settings& s, const std::string& v) { s.series = v; }},
    {"--grid", "NAME", "", ".vdb with several level sets: which grid", kFit,
     [](Settings& s, const std::string& v) { s.grid = v; }},

    // Measuring.
    {"--self-intersections", "", "", "count pairs of triangles that intersect (slow)", "check",
     [](Settings& s, const std::string&) { s.selfIntersections = true; }},
    {"--sampling", "LEN", "1/500 of the diagonal", "largest distance of a point of the surface to a sample",
     "compare", [](Settings& s, const std::string& v) { s.sampling = positive(v); }},

    // Filters, curves, reliefs.
    {"--scheme", "NAME", "dlg-refined", "chaikin-W, cubic-W (W taps), dlg-trial, dlg-refined, dlg-optimal",
     "curve-levels", [](Settings& s, const std::string& v) { s.scheme = v; }},
    {"--scheme", "NAME", "butterfly-3",
     "butterfly-trivial, butterfly-W, loop-W (W rings), loop-like:ALPHA,GAMMA", "relief",
     [](Settings& s, const std::string& v) { s.scheme = v; }},
    {"--mask", "TAPS", "", "a subdivision of your own: \"1/8 1/2 3/4 1/2 1/8\"; in spiral order on a lattice",
     "filters curve-levels", [](Settings& s, const std::string& v) { s.mask = v; }},
    {"--lattice", "line|triangular|quad", "line", "where the mask lives", "filters",
     [](Settings& s, const std::string& v) {
         s.lattice = choice(v, std::array<std::pair<std::string_view, std::string_view>, 3>{
                                   {{"line", "line"}, {"triangular", "triangular"}, {"quad", "quad"}}});
     }},
    {"--width", "W", "the usual one, or the smallest there is", "of A: taps on the line, rings on a lattice",
     "filters curve-levels",
     [](Settings& s, const std::string& v) { s.width = static_cast<int>(integer(v, 0, 1000)); }},
    {"--boundary", "", "", "the rows beside an end of a curve, or beside a side of a triangular patch",
     "filters", [](Settings& s, const std::string&) { s.boundary = true; }},
    {"--svg", "FILE", "", "draw the diagrams into this file", "filters",
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.svg = v;
     }},
    {"--levels", "N", "6", "how many decompositions", "curve-levels",
     [](Settings& s, const std::string& v) { s.depth = static_cast<int>(integer(v, 0, 60)); }},
    {"--levels", "N", "2", "how many decompositions", "relief",
     [](Settings& s, const std::string& v) { s.depth = static_cast<int>(integer(v, 0, 20)); }},
    {"--points", "N", "as they are", "first put N points at equal steps along each curve", "curve-levels",
     [](Settings& s, const std::string& v) { s.points = static_cast<std::size_t>(integer(v, 2, kHuge)); }},
    {"--threshold", "LEN", "", "drop details shorter than this, into thresholded", "curve-levels",
     [](Settings& s, const std::string& v) { s.threshold = positive(v); }},
    {"--keep", "N", "", "keep only the N longest details of each curve, into thresholded", "curve-levels",
     [](Settings& s, const std::string& v) { s.keep = static_cast<std::size_t>(integer(v, 0, kHuge)); }},
    {"--layout", "rows|quincunx", "rows",
     "every sample, one diagonal of each square an edge; or every second one, in a hexagon", "relief",
     [](Settings& s, const std::string& v) {
         s.quincunx = choice(
             v, std::array<std::pair<std::string_view, bool>, 2>{{{"rows", false}, {"quincunx", true}}});
     }},
    {"--table", "", "", "compare the schemes' errors too", "curve-levels relief",
     [](Settings& s, const std::string&) { s.table = true; }},

    // Meshes with subdivision connectivity.
    {"--levels", "N", "as many as there are", "how many levels coarser", "reverse",
     [](Settings& s, const std::string& v) { s.depth = static_cast<int>(integer(v, 0, kMostSubdivisions)); }},
    {"--levels", "N", "all", "how many subdivisions finer than BASE; finer details are not even read", "rebuild",
     [](Settings& s, const std::string& v) { s.depth = static_cast<int>(integer(v, 0, kMostSubdivisions)); }},
    {"--levels", "N", "1", "how many subdivisions", "subdivide",
     [](Settings& s, const std::string& v) { s.depth = static_cast<int>(integer(v, 0, kMostSubdivisions)); }},
    {"--scheme", "NAME", "catmull-clark", "catmull-clark, loop or butterfly", "reverse subdivide",
     [](Settings& s, const std::string& v) { s.scheme = v; }},
    {"--variant", "NAME", "the first",
     "how the coarse mesh is fitted; catmull-clark: refined, trial, unscaled, tensor, wide; "
     "loop, butterfly: refined, trial, wide",
     "reverse", [](Settings& s, const std::string& v) { s.variant = v; }},
    {"--crease", "ANGLE", "", "edges that fold by more than ANGLE degrees are creases too (catmull-clark)",
     "reverse subdivide",
     [](Settings& s, const std::string& v) {
         s.creaseAngle = number(v);
         if (*s.creaseAngle < 0 || *s.creaseAngle > 180) throw UsageError("'" + v + "' is not between 0 and 180");
     }},
    {"--details", "FILE", "", "reverse writes the details into this file; rebuild, which needs it, reads them",
     "reverse rebuild",
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.details = v;
     }},
    {"--edited", "FILE", "", "BASE with moved vertices, which takes its place", "rebuild",
     [](Settings& s, const std::string& v) {
         if (v.empty()) throw UsageError("the name is empty");
         s.edited = v;
     }},
    {"--frames", "global|local", "global",
     "details keep their direction in space, or turn with the surface (--edited)", "rebuild",
     [](Settings& s, const std::string& v) {
         s.frames = choice(v, std::array<std::pair<std::string_view, subdivision::Frames>, 2>{
                                  {{"global", subdivision::Frames::global}, {"local", subdivision::Frames::local}}});
     }},
    {"--threshold", "LEN", "", "leave out details shorter than this, in the units of the mesh", "rebuild",
     [](Settings& s, const std::string& v) { s.threshold = positive(v); }},
    {"--keep", "N", "", "only the N longest details", "rebuild",
     [](Settings& s, const std::string& v) { s.keep = static_cast<std::size_t>(integer(v, 0, kHuge)); }},
    {"--table", "", "", "the error that is left with the longest 0 to 50 % of the details", "rebuild",
     [](Settings& s, const std::string&) { s.table = true; }},

    // How the job runs.
    {"--threads", "N", "all", "threads to use; the result does not depend on it, to the bit", kAll,
     [](Settings& s, const std::string& v) { s.threads = static_cast<int>(integer(v, 1, 4096)); }},
    {"--max-memory", "GB", "70 % of this computer's",
     "refuse images, meshes and level sets that would take more, as far as can be told beforehand", kImages,
     [](Settings& s, const std::string& v) { s.maxMemory = positive(v); }},
    {"--quiet", "", "", "no progress and no remarks on standard error", kQuiet,
     [](Settings& s, const std::string&) { s.quiet = true; }},
    {"--markdown", "", "", "everything, as markdown", "help",
     [](Settings& s, const std::string&) { s.markdown = true; }},
};

constexpr ExitCode kExitCodes[] = {
    {0, "done"},
    {1, "the work failed: a file could not be written, memory did not suffice"},
    {2, "the command line is wrong"},
    {3, "the input is not what it must be; one line says what was found, what was expected and what to do"},
    {4, "check: the mesh is not closed, not 2-manifold or not oriented"},
    {130, "interrupted (Ctrl-C); nothing was left behind"},
};

}  // namespace

bool Option::belongsTo(std::string_view command) const {
    std::string_view rest = commands;
    while (!rest.empty()) {
        const auto space = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, space) == command) return true;
        rest.remove_prefix(std::min(space + 1, rest.size()));
    }
    return false;
}

std::string_view Option::longName() const { return names.substr(names.find("--")); }

int Command::argumentCount() const {
    return static_cast<int>(std::count(arguments.begin(), arguments.end(), ' ')) + 1;
}

std::span<const Command> commands() { return kCommands; }
std::span<const Option> options() { return kOptions; }
std::span<const ExitCode> exitCodes() { return kExitCodes; }

const Command* findCommand(std::string_view name) {
    const auto found = std::find_if(std::begin(kCommands), std::end(kCommands),
                                    [&](const Command& command) { return command.name == name; });
    return found == std::end(kCommands) ? nullptr : found;
}

}  // namespace isowave::tools
