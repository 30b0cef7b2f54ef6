// The connected pieces of a mesh. What a mesh is as a whole, topologyOf() of isowave/measure.h, is counted here, too: no
// geometry library is needed for that, and a mesh that CGAL's data structures cannot hold can still be counted.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/measure.h"
#include "isowave/mesh.h"

namespace isowave {

// The connected pieces of a mesh, in the order of their smallest vertices.
struct MeshComponents {
    static constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> of;     // point -> component; kNone for a point that no triangle uses
    std::vector<double> volume, area;  // of each, as ComponentTopology has them

    std::size_t count() const { return volume.size(); }
};
// What topologyOf() knows of components at a fifth of its price: no edges, so no genus.
MeshComponents componentsOf(const TriangleMesh& mesh);

// topologyOf() of a mesh that is known to be closed, oriented and 2-manifold, as polygonize() makes it: three sides a triangle
// are two an edge, and no star is looked at, which is most of the price. components: componentsOf(mesh).
MeshTopology closedTopologyOf(const TriangleMesh& mesh, const MeshComponents& components);
MeshTopology closedTopologyOf(const TriangleMesh& mesh);

}  // namespace isowave
