#include "subdivision/meshes/mesh_schemes.h"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "isowave/error.h"
#include "subdivision/meshes/catmull_clark.h"
#include "subdivision/meshes/catmull_clark_wide.h"
#include "subdivision/meshes/quad_connectivity.h"
#include "subdivision/meshes/triangle_coarsen.h"
#include "subdivision/meshes/triangle_step.h"

namespace isowave::subdivision {
namespace {

std::unique_ptr<SubdivisionStep> catmullClarkStep(const PolygonMesh& coarse, std::string_view variant) {
    if (variant == "wide") return std::make_unique<WideCatmullClarkStep>(coarse);
    auto kind = CatmullClarkVariant::refined;
    if (variant == "trial") kind = CatmullClarkVariant::trial;
    if (variant == "unscaled") kind = CatmullClarkVariant::unscaled;
    if (variant == "tensor") kind = CatmullClarkVariant::tensor;
    return std::make_unique<CatmullClarkStep>(coarse, kind);
}

template <TriangleStep::Family family>
std::unique_ptr<SubdivisionStep> triangleStep(const PolygonMesh& coarse, std::string_view variant) {
    using Fit = TriangleStep::Fit;
    return std::make_unique<TriangleStep>(family,
                                          variant == "trial"  ? Fit::Trial
                                          : variant == "wide" ? Fit::Wide
                                                              : Fit::Refined,
                                          coarse);
}

const std::vector<MeshScheme>& table() {
    static const std::vector<MeshScheme> schemes{
        {"catmull-clark",
         "polygons of any size, boundaries and creases; the fine mesh is one of quads",
         {"refined", "trial", "unscaled", "tensor", "wide"},
         catmullClarkStep,
         recoverQuads},
        {"loop",
         "Loop's, of triangles: box splines where six meet",
         {"refined", "trial", "wide"},
         triangleStep<TriangleStep::Family::Loop>,
         recoverTriangles},
        {"butterfly",
         "modified Butterfly, of triangles: goes through the points",
         {"refined", "trial", "wide"},
         triangleStep<TriangleStep::Family::Butterfly>,
         recoverTriangles}};
    return schemes;
}

}  // namespace

std::span<const MeshScheme> meshSchemes() { return table(); }

const MeshScheme& meshScheme(std::string_view name) {
    std::string list;
    for (const auto& scheme : table()) {
        if (scheme.name == name) return scheme;
        list += (list.empty() ? "" : ", ") + std::string(scheme.name);
    }
    throw InputError(fmt::format("'{}' is no subdivision of meshes; they are {}", name, list));
}

}  // namespace isowave::subdivision
