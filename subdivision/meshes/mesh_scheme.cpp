#include "subdivision/meshes/mesh_scheme.h"

#include <fmt/format.h>

#include <cassert>

#include "isowave/error.h"
#include "subdivision/meshes/quad_connectivity.h"
#include "subdivision/meshes/triangle_step.h"

namespace isowave::subdivision {
namespace {

const std::vector<MeshScheme>& table() {
    static const std::vector<MeshScheme> kSchemes{catmullClarkScheme(), loopScheme(), butterflyScheme()};
    return kSchemes;
}

}  // namespace

std::vector<Vec3> SubdivisionStep::compose(std::span<const Vec3> coarse,
                                           std::span<const Vec3> allDetails) const {
    assert(coarse.size() == coarseSize() && allDetails.size() == fineSize());
    auto moved = shift(allDetails);
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = coarse[v] - moved[v];
    auto fine = subdivide(moved);
    for (std::size_t v = 0; v < fine.size(); ++v) fine[v] += allDetails[v];
    return fine;
}

std::span<const MeshScheme> meshSchemes() { return table(); }

const MeshScheme& meshScheme(std::string_view name) {
    std::string list;
    for (const auto& scheme : table()) {
        if (scheme.name == name) return scheme;
        list += (list.empty() ? "" : ", ") + std::string(scheme.name);
    }
    throw InputError(fmt::format("'{}' is no subdivision of meshes; they are {}", name, list));
}

std::string_view meshVariant(const MeshScheme& scheme, std::string_view variant) {
    if (variant.empty()) return scheme.variants.front();
    for (const auto known : scheme.variants)
        if (known == variant) return known;
    throw InputError(fmt::format("'{}' is no variant of {}; they are {}", variant, scheme.name,
                                 fmt::join(scheme.variants, ", ")));
}

}  // namespace isowave::subdivision
