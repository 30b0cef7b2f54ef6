#include "multires.h"

#include <openvdb/tools/VolumeToMesh.h>

namespace isowave::bench {

TriangleMesh multiresMesh(const MultiRes& grids, int level) {
    const auto grid = grids.grid(static_cast<std::size_t>(level));
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, quads);
    TriangleMesh mesh;
    for (const auto& p : points) mesh.points.push_back({p[0], p[1], p[2]});
    for (const auto& q : quads) {  // OpenVDB turns its polygons inwards
        mesh.triangles.push_back({q[0], q[2], q[1]});
        mesh.triangles.push_back({q[0], q[3], q[2]});
    }
    return mesh;
}

}  // namespace isowave::bench
