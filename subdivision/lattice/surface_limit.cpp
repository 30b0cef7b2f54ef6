#include "subdivision/lattice/surface_limit.h"

#include <array>

#include "subdivision/filters/limit_mask.h"

namespace isowave::subdivision {
namespace {

using Tap = SurfaceFilters::Tap;

// The sides on which a node lies: none, one, or at a corner more.
std::vector<std::size_t> sidesOf(const Patch& patch, Node node) {
    std::vector<std::size_t> sides;
    if (patch.isTorus()) return sides;
    const std::array<int, 6> distances = patch.distances(node);
    for (std::size_t s = 0; s < distances.size(); ++s)
        if (distances[s] == 0) sides.push_back(s);
    return sides;
}

}  // namespace

SurfaceLimit::SurfaceLimit(const SurfaceScheme& scheme)
    : keepsNodes_(scheme.family == SurfaceScheme::Family::Butterfly) {
    if (keepsNodes_) return;
    for (const auto& [offset, weight] : limitMask(scheme.mask)) inside_.push_back({offset, toDouble(weight)});
}

std::vector<Tap> SurfaceLimit::tapsAt(const Patch& patch, Node node) const {
    const auto sides = sidesOf(patch, node);
    if (sides.empty()) return inside_;
    if (sides.size() > 1) return {{Node{}, 1.0}};
    const Node step = Patch::stepAlong(sides.front());
    return {{Node{}, 4.0 / 6}, {step, 1.0 / 6}, {-1 * step, 1.0 / 6}};
}

SurfaceField SurfaceLimit::of(const SurfaceField& field) const {
    if (keepsNodes_) return field;
    const auto channels = static_cast<std::size_t>(field.channels);
    SurfaceField limit{field.patch, field.channels, std::vector<double>(field.values.size(), 0.0)};
    double* to = limit.values.data();
    for (const Node node : field.patch.nodes()) {
        for (const auto& [offset, weight] : tapsAt(field.patch, node)) {
            const double* from =
                field.values.data() + field.patch.index(field.patch.wrapped(node + offset)) * channels;
            for (std::size_t c = 0; c < channels; ++c) to[c] += weight * from[c];
        }
        to += channels;
    }
    return limit;
}

}  // namespace isowave::subdivision
