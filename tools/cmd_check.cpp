// isowave check MESH: counts what the mesh is, repairs nothing.
#include <fmt/format.h>

#include "simplify/measure.h"
#include "polygonize/topology.h"
#include "tools/commands.h"
#include "tools/input.h"

namespace isowave::tools {
namespace {

constexpr int kExitDefective = 4;

// The text lists the largest components only; the JSON lists all.
constexpr std::size_t kListed = 10;

Json componentsOf(const MeshTopology& topology) {
    Json list = Json::array();
    for (const ComponentTopology& c : topology.each)
        list.push_back({{"vertices", c.vertices},
                        {"edges", c.edges},
                        {"triangles", c.triangles},
                        {"euler", c.euler},
                        {"genus", c.genus},
                        {"volume", finite(c.volume)},
                        {"area", finite(c.area)}});
    return list;
}

const char* yesNo(bool yes) { return yes ? "yes" : "no"; }

std::string textOf(const MeshTopology& t, const std::string& name, const Json& intersections) {
    std::string text = fmt::format("{}: {}, {}\n", name, counted(t.triangles, "triangle"),
                                   counted(t.vertices, "vertex", "vertices"));
    text +=
        fmt::format("closed        {:<5}{} boundary edges\n", yesNo(t.closed()), grouped(t.boundaryEdges));
    text += fmt::format("2-manifold    {:<5}{} edges, {} vertices, {} degenerate triangles break it\n",
                        yesNo(t.manifold()), grouped(t.nonManifoldEdges), grouped(t.nonManifoldVertices),
                        grouped(t.degenerateTriangles));
    text += fmt::format("oriented      {:<5}{} edges run the same way on both sides\n", yesNo(t.oriented()),
                        grouped(t.misorientedEdges));
    if (!intersections.is_null())
        text +=
            fmt::format("intersecting  {} pairs of triangles\n", grouped(intersections.get<std::int64_t>()));
    const bool whole = t.closed() && t.manifold();
    text += fmt::format("volume {}, area {}, {}, genus {}\n", shortNumber(t.volume), shortNumber(t.area),
                        counted(t.components, "component"), whole ? grouped(t.genus) : "-");
    Table table({"component", "triangles", "genus", "volume", "area"});
    for (std::size_t i = 0; i < std::min(kListed, t.each.size()); ++i)
        table.row({std::to_string(i + 1), grouped(t.each[i].triangles),
                   whole ? grouped(t.each[i].genus) : "-", shortNumber(t.each[i].volume),
                   shortNumber(t.each[i].area)});
    text += table.text();
    if (t.each.size() > kListed)
        text += fmt::format("... and {} smaller ones\n", grouped(t.components - kListed));
    return text;
}

}  // namespace

int runCheck(const Settings& settings, Console& console) {
    const std::string name = settings.files[0].string();
    const LoadedMesh loaded = loadMesh(settings.files[0], console.progress());
    const TriangleMesh mesh = mergeEqualPoints(loaded.mesh);
    const MeshTopology topology = topologyOf(mesh);
    const Json intersections =
        settings.selfIntersections ? Json(countSelfIntersections(mesh, console.progress())) : Json(nullptr);

    console.progress().check();  // a stop that came while counting prints nothing either
    if (settings.json) {
        Json json;
        json["version"] = 1;
        json["input"] = {{"path", name}, {"kind", "mesh"}, {"format", loaded.format}};
        putTopology(json, topology);
        json["oriented"] = topology.oriented();
        json["boundary_edges"] = topology.boundaryEdges;
        json["non_manifold_edges"] = topology.nonManifoldEdges;
        json["non_manifold_vertices"] = topology.nonManifoldVertices;
        json["misoriented_edges"] = topology.misorientedEdges;
        json["degenerate_triangles"] = topology.degenerateTriangles;
        json["self_intersections"] = intersections;
        json["each"] = componentsOf(topology);
        console.print(tools::textOf(json));
    } else {
        console.print(textOf(topology, name, intersections));
    }
    return topology.closed() && topology.manifold() && topology.oriented() ? 0 : kExitDefective;
}

}  // namespace isowave::tools
