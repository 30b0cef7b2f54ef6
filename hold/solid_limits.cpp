#include "hold/solid_limits.h"

#include "polygonize/polygonize.h"
#include "polygonize/specks.h"

namespace isowave {

bool SolidLimits::allow(const SolidCounts& counts) const {
    return counts.parts <= parts.value_or(counts.parts) &&
           counts.handles <= handles.value_or(counts.handles) &&
           counts.cavities <= cavities.value_or(counts.cavities);
}

SolidCounts meshedCounts(const BSplineField& field, int refine, double smallestPart,
                         const Progress& progress) {
    TriangleMesh mesh = polygonize(field, {.refine = refine}, progress);
    MeshComponents components = componentsOf(mesh);
    removeSpecks(mesh, smallestPart, components);
    const MeshTopology topology = closedTopologyOf(mesh, components);
    return {topology.parts, topology.genus, topology.cavities};
}

}  // namespace isowave
