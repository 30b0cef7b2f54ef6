// What the command line asked for, with types; filled in by the table of commands.h, read by the subcommands.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/mesh/write.h"
#include "subdivision/meshes/hierarchy_edit.h"

namespace isowave::tools {

// The command line itself is wrong or asks for what this kind of input does not have: exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

enum class FitMethod { binary, distance };
enum class CurveFormat { svg, geojson, png, txt };

// A..B, both included; without B: as far as the pyramid goes.
struct StepRange {
    int first = 0;
    std::optional<int> last;
};

struct Settings {
    std::vector<std::filesystem::path> files;  // the positional arguments, in order

    // What the solid is.
    std::optional<double> iso;    // in the image's own unit (HU for CT); of a level set in world units
    std::optional<double> label;  // one value of a label image
    bool invert = false;
    bool openBorder = false;

    // How a mesh is sampled.
    std::optional<std::int64_t> voxels;  // along the longest axis of the bounding box
    std::optional<double> voxel;         // world units

    // Headerless images, and what other formats lose.
    std::optional<std::array<std::int64_t, 3>> size;  // voxels, x fastest
    std::optional<std::string> type;                  // int8 ... float64
    std::optional<std::array<double, 3>> spacing;     // mm
    std::optional<bool> bigEndian;
    std::optional<std::int64_t> headerBytes;
    std::optional<std::string> series;  // of a DICOM folder
    std::optional<std::string> grid;    // of a .vdb

    // The fit.
    std::optional<FitMethod> fit;
    std::optional<double> halfWidth;  // voxels each side; the library's default is 4
    std::optional<double> band;       // voxels each side; the library's default is 2

    // Which steps.
    std::optional<StepRange> levels, steps;
    std::optional<int> step, level;

    // What comes out.
    std::optional<std::filesystem::path> output;
    std::optional<MeshFormat> format;
    std::optional<Space> space;
    int refine = 1;  // samples of a node along each axis: 1, 2, 4
    bool preserveVolume = false;
    bool protectThin = false;
    bool keepSpecks = false;
    bool features = false;   // measure parts, holes and cavities of level 0
    bool refit = false;      // fit the field of a level once more to level 0's surface
    bool compact = false;    // collapse what refine > 1 gives down to the triangles of refine = 1
    int relax = 0;           // rounds of sliding vertices along the surface
    bool deviation = false;  // measure triangles against the zero set
    std::optional<std::string> jsonFile;  // "-" = standard output
    bool json = false;
    bool selfIntersections = false;
    std::optional<double> sampling;  // world units between samples of a distance

    // lod: meshes by budget.
    std::vector<std::int64_t> budgetTriangles;
    std::vector<double> budgetRatios;      // of level 0's triangles
    std::vector<double> budgetTolerances;  // world units
    std::optional<std::int64_t> maxGenus;
    std::optional<double> minComponent;  // world units^3

    // filters, curve-levels, relief.
    std::optional<std::string> scheme, mask;
    std::string lattice = "line";       // of a mask: line, triangular, quad
    std::optional<int> width;           // of A: taps on the line, rings else
    std::optional<int> depth;           // decompositions
    std::optional<std::size_t> points;  // of a curve, resampled
    std::optional<double> threshold;    // details shorter than this are dropped
    std::optional<std::size_t> keep;    // of the details, the longest
    bool quincunx = false;
    bool boundary = false;
    bool table = false;
    std::optional<std::filesystem::path> svg;
    // reverse, rebuild, subdivide.
    std::optional<std::filesystem::path> details, edited;
    std::optional<std::string> variant;
    std::optional<double> creaseAngle;  // degrees
    std::optional<subdivision::Frames> frames;
    // Planar curves.
    std::optional<std::int32_t> pixels;  // along the longer side of the polygons
    std::optional<CurveFormat> curveFormat;
    std::optional<double> tolerance;  // pixels of level 0
    std::optional<std::filesystem::path> sheet;
    bool smooth = false;

    // How the job runs.
    int threads = 0;                  // 0 = all
    std::optional<double> maxMemory;  // GB
    bool quiet = false;
    bool markdown = false;
    bool help = false;
    std::optional<std::string> topic;  // `completion SHELL`, `help COMMAND`
};

}  // namespace isowave::tools
