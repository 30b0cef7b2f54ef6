#include "subdivision/meshes/mesh_scheme.h"

#include <fmt/format.h>

#include <cassert>

#include "isowave/error.h"

namespace isowave::subdivision {

std::vector<Vec3> SubdivisionStep::compose(std::span<const Vec3> coarse,
                                           std::span<const Vec3> allDetails) const {
    assert(coarse.size() == coarseSize() && allDetails.size() == fineSize());
    auto moved = shift(allDetails);
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v] = coarse[v] - moved[v];
    auto fine = subdivide(moved);
    for (std::size_t v = 0; v < fine.size(); ++v) fine[v] += allDetails[v];
    return fine;
}

std::string_view meshVariant(const MeshScheme& scheme, std::string_view variant) {
    if (variant.empty()) return scheme.variants.front();
    for (const auto known : scheme.variants)
        if (known == variant) return known;
    throw InputError(fmt::format("'{}' is no variant of {}; they are {}", variant, scheme.name,
                                 fmt::join(scheme.variants, ", ")));
}

}  // namespace isowave::subdivision
