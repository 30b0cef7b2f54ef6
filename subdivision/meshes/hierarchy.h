// A mesh taken apart into a coarse base and details, and put back together to any level.
//
// Steps count from the base: after K steps, 0 <= K <= steps(), the mesh has been subdivided K times and has got the
// first K of the details. Nothing finer has to be read or rebuilt for that.
//   (1) reconstruct(decompose(mesh)) is `mesh`: its vertices, faces and their order; points to kMeshRoundTrip times
//       the diagonal. Creases come in the order of the base's.
//   (2) Stored numbers: base points + details = fine points, three numbers each. (Plus two whole numbers a fine
//       point for the order of the file that the mesh came from, when it is not the canonical one.)
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/progress.h"
#include "subdivision/meshes/mesh_scheme.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

inline constexpr double kMeshRoundTrip = 1e-12;

// Where the vertices and faces of the finest mesh stood in the mesh that was decomposed. Empty: in canonical order
// (mesh_scheme.h).
struct FinestOrder {
    std::vector<Index> vertex;       // of each canonical vertex
    std::vector<Index> firstCorner;  // of each canonical face: the corner there that its first corner was
    bool empty() const { return vertex.empty(); }
    friend bool operator==(const FinestOrder&, const FinestOrder&) = default;
};

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
// Throws InputError, without a file name: a defect of the mesh; no subdivision connectivity; fewer levels than asked
// for (how many are possible, and what is in the way).
Hierarchy decompose(const PolygonMesh& mesh, const MeshScheme& scheme, const DecomposeOptions& options,
                    const Progress& progress = {});
inline Hierarchy decompose(const PolygonMesh& mesh, const MeshScheme& scheme, std::string_view variant,
                           int levels, const Progress& progress = {}) {
    return decompose(mesh, scheme, DecomposeOptions{variant, levels, {}}, progress);
}

// The mesh after `steps` steps (kAllLevels: all). The finest has the order of the mesh that was decomposed, the
// others the canonical one. Throws InputError when the parts do not belong together.
PolygonMesh reconstruct(const Hierarchy& hierarchy, int steps = kAllLevels, const Progress& progress = {});

// The same with another way to take a step: it gets the step, its coarse points, what is stored for it, and the fine
// mesh, whose points it is to fill in.
using StepFunction = std::function<void(const SubdivisionStep&, const std::vector<Vec3>& coarse,
                                        const std::vector<Vec3>& stored, PolygonMesh& fine)>;
PolygonMesh rebuilt(const Hierarchy& hierarchy, int steps, const Progress& progress,
                    const StepFunction& takeStep);

// `mesh` subdivided `levels` times, without details.
PolygonMesh subdivided(const PolygonMesh& mesh, const MeshScheme& scheme, int levels,
                       const Progress& progress = {});

// Throws InputError when `moved` does not have the very faces and number of points of the base ("another
// connectivity", and where they part). Its creases do not count.
void requireSameConnectivity(const PolygonMesh& base, const PolygonMesh& moved);

// One file (docs/interfaces.md, "Details of meshes"): magic, version, a JSON header with the sizes and checksums of
// the sections, then the sections themselves, base first and coarse details before fine ones.
// Throws OperationError; the file appears whole or not at all.
void saveHierarchy(const std::filesystem::path& path, const Hierarchy& hierarchy);
// The same bytes into a stream that throws std::ios_base::failure (AtomicFile's).
void writeHierarchy(std::ostream& stream, const Hierarchy& hierarchy);
// Reads the base and the details of the first `steps` steps (kAllLevels: all, and the order of the finest) and
// nothing behind them. Throws InputError: not such a file, of a later version, truncated, damaged (a checksum of what
// is read does not agree), fewer steps than asked for.
Hierarchy loadHierarchy(const std::filesystem::path& path, int steps = kAllLevels);

}  // namespace isowave::subdivision
