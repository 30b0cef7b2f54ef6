// A mesh taken apart into a coarse base and details, and put back together to any level: the passes behind
// isowave/subdivision.h, for a given scheme.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "isowave/progress.h"
#include "isowave/subdivision.h"
#include "subdivision/meshes/mesh_scheme.h"
#include "subdivision/meshes/mesh_schemes.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

Hierarchy decompose(const PolygonMesh& mesh, const MeshScheme& scheme, const DecomposeOptions& options,
                    const Progress& progress = {});
inline Hierarchy decompose(const PolygonMesh& mesh, const MeshScheme& scheme, std::string_view variant,
                           int levels, const Progress& progress = {}) {
    return decompose(mesh, scheme, DecomposeOptions{variant, levels, {}}, progress);
}

// reconstruct() with another way to take a step: it gets the step, its coarse points, what is stored for it, and the
// fine mesh, whose points it is to fill in.
using StepFunction = std::function<void(const SubdivisionStep&, const std::vector<Vec3>& coarse,
                                        const std::vector<Vec3>& stored, PolygonMesh& fine)>;
PolygonMesh rebuilt(const Hierarchy& hierarchy, int steps, const Progress& progress,
                    const StepFunction& takeStep);

PolygonMesh subdivided(const PolygonMesh& mesh, const MeshScheme& scheme, int levels,
                       const Progress& progress = {});

std::vector<Vec3> limitPoints(const PolygonMesh& mesh, const MeshScheme& scheme);

}  // namespace isowave::subdivision
