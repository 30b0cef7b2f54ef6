#include "tools/report/mesh_json.h"

namespace isowave::tools {

Json triple(const std::array<double, 3>& v) {
    return Json::array({finite(v[0]), finite(v[1]), finite(v[2])});
}

void putTopology(Json& json, const MeshTopology& topology) {
    const bool whole = topology.closed() && topology.manifold();
    json["vertices"] = topology.vertices;
    json["triangles"] = topology.triangles;
    json["components"] = topology.components;
    json["genus"] = whole ? Json(topology.genus) : Json(nullptr);
    json["closed"] = topology.closed();
    json["manifold"] = topology.manifold();
    json["volume"] = finite(topology.volume);
    json["area"] = finite(topology.area);
}

}  // namespace isowave::tools
