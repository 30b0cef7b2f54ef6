// A path and the options -> a solid, ready to be taken apart: a field, or a pyramid that somebody made
// before.
//
//   image      -> what kind of image? (mask, labels, grey) -> iso and fit -> nodes or distances -> field
//   mesh       -> closed (repaired) -> voxel size -> distances -> field
//   level set  -> distances in voxels -> field
//   pyramid    -> read
// Every default that was taken is said aloud.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "io/mesh/write.h"
#include "tools/console.h"
#include "tools/report.h"
#include "tools/settings.h"
#include "volume/field.h"
#include "io/image/stream.h"
#include "wavelets/pyramid.h"

namespace isowave::tools {

enum class InputKind { image, mesh, vdb, pyramid };

// By extension, by --size (headerless image) and, for .vdb, by what the file says that it is. Throws
// InputError for a missing file or a name that tells nothing.
InputKind kindOf(const std::filesystem::path& path, const Settings& settings);

struct Solid {
    // One of the two.
    std::optional<BSplineField> field;
    std::optional<wavelets::Pyramid> pyramid;
    Space space = Space::unspecified;  // axes that written meshes have unless --space says otherwise
    // --open-border: where the image ends, and meshes with it.
    struct Border {
        openvdb::Mat4d worldToIndex;
        openvdb::Vec3d low, high;  // the first and the last voxel
    };
    std::optional<Border> openBorder;
    Json input, fit;  // "input" and "fit" of report.json

    double K() const { return field ? field->K : pyramid->K; }
    // input and fit, flattened, for Pyramid::source.
    std::map<std::string, std::string> source() const;
};

// finestStep: of a pyramid's file only what this step and coarser ones need is read.
// Throws InputError (bad data), UsageError (an option that this kind of input does not have), Cancelled.
Solid loadSolid(const std::filesystem::path& path, const Settings& settings, Console& console,
                StageClock& clock, int finestStep = 0);

// A mesh file as it is, in LPS when it says SPACE=RAS. format: as MeshFileInfo has it.
struct LoadedMesh {
    TriangleMesh mesh;
    Space space = Space::unspecified;
    std::string format;
};
LoadedMesh loadMesh(const std::filesystem::path& path, const Progress& progress);

// Where written meshes have their axes: --space where the solid has axes with a meaning. Throws UsageError
// for
// --space on a solid that has none.
Space outputSpace(const Solid& solid, const Settings& settings);

// What the readers of images are told. Throws UsageError for --type and the like without --size.
ImageReadOptions imageReadOptions(const Settings& settings);

// Bytes that a job may take: --max-memory, or 70 % of the computer's (or of the container's) memory.
double memoryLimit(const Settings& settings);

// World position of voxel (0,0,0), and the unit vectors along the three axes of the lattice, LPS.
Json originOf(const Image& image);
Json directionOf(const Image& image);

// "-1024 to 2986; 1 % -1024, 5 % ..."
std::string rangeText(const ImageStatistics& statistics);

}  // namespace isowave::tools
