// What reports of solids and meshes have in common.
#pragma once

#include <array>
#include <optional>

#include "isowave/measure.h"
#include "tools/report/json.h"

namespace isowave::tools {

Json triple(const std::array<double, 3>& v);

// null for nothing, and for a number that is not finite.
inline Json orNull(const std::optional<double>& value) { return value ? finite(*value) : Json(nullptr); }
template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

// vertices, triangles, components, genus, closed, manifold, volume, area: the keys that lod and check share.
// genus is null where it has no meaning (open or not manifold).
void putTopology(Json& json, const MeshTopology& topology);

}  // namespace isowave::tools
