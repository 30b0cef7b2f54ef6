#include "tools/report/mesh_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/mesh_json.h"
#include "tools/report/text.h"

namespace isowave::tools {
namespace {

// The text lists the largest components only; the JSON lists all.
constexpr std::size_t kListed = 10;

Json componentsJson(const MeshTopology& topology) {
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

std::string componentsText(const MeshTopology& t, bool whole) {
    Table table({"component", "triangles", "genus", "volume", "area"});
    for (std::size_t i = 0; i < std::min(kListed, t.each.size()); ++i)
        table.row({std::to_string(i + 1), grouped(t.each[i].triangles),
                   whole ? grouped(t.each[i].genus) : "-", shortNumber(t.each[i].volume),
                   shortNumber(t.each[i].area)});
    std::string text = table.text();
    if (t.each.size() > kListed)
        text += fmt::format("... and {} smaller ones\n", grouped(t.components - kListed));
    return text;
}

// In per cent; a surface that is flat, or open in the right way, has the volume 0.
std::string relativeText(double difference, double whole) {
    const double percent = 100 * difference / whole;
    return std::isfinite(percent) ? fmt::format("{:+.3g}", percent) : "-";
}

Json sideJson(const OneSidedDistance& side) {
    return {{"mean", finite(side.mean)},
            {"rms", finite(side.rms)},
            {"max", finite(side.max)},
            {"max_bound", finite(side.maxBound)},
            {"samples", side.samples}};
}

}  // namespace

std::string jsonOf(const CheckReport& check) {
    const MeshTopology& t = check.topology;
    Json json;
    json["version"] = 1;
    json["input"] = {{"path", check.path}, {"kind", "mesh"}, {"format", check.format}};
    putTopology(json, t);
    json["oriented"] = t.oriented();
    json["boundary_edges"] = t.boundaryEdges;
    json["non_manifold_edges"] = t.nonManifoldEdges;
    json["non_manifold_vertices"] = t.nonManifoldVertices;
    json["misoriented_edges"] = t.misorientedEdges;
    json["degenerate_triangles"] = t.degenerateTriangles;
    json["self_intersections"] = orNull(check.selfIntersections);
    json["each"] = componentsJson(t);
    return dumped(json);
}

std::string textOf(const CheckReport& check) {
    const MeshTopology& t = check.topology;
    std::string text = fmt::format("{}: {}, {}\n", check.path, counted(t.triangles, "triangle"),
                                   counted(t.vertices, "vertex", "vertices"));
    text +=
        fmt::format("closed        {:<5}{} boundary edges\n", yesNo(t.closed()), grouped(t.boundaryEdges));
    text += fmt::format("2-manifold    {:<5}{} edges, {} vertices, {} degenerate triangles break it\n",
                        yesNo(t.manifold()), grouped(t.nonManifoldEdges), grouped(t.nonManifoldVertices),
                        grouped(t.degenerateTriangles));
    text += fmt::format("oriented      {:<5}{} edges run the same way on both sides\n", yesNo(t.oriented()),
                        grouped(t.misorientedEdges));
    if (check.selfIntersections)
        text += fmt::format("intersecting  {} pairs of triangles\n", grouped(*check.selfIntersections));
    const bool whole = t.closed() && t.manifold();
    text += fmt::format("volume {}, area {}, {}, genus {}\n", shortNumber(t.volume), shortNumber(t.area),
                        counted(t.components, "component"), whole ? grouped(t.genus) : "-");
    return text + componentsText(t, whole);
}

std::string jsonOf(const CompareReport& compare) {
    const MeshComparison& c = compare.comparison;
    Json json;
    json["version"] = 1;
    json["a"] = {{"path", compare.pathA}, {"volume", finite(c.volumeA)}};
    json["b"] = {{"path", compare.pathB}, {"volume", finite(c.volumeB)}};
    json["sampling"] = compare.sampling;
    json["a_to_b"] = sideJson(c.aToB);
    json["b_to_a"] = sideJson(c.bToA);
    json["symmetric"] = {{"mean", finite(c.mean)},
                         {"rms", finite(c.rms)},
                         {"max", finite(c.max)},
                         {"max_bound", finite(c.maxBound)}};
    json["volume_difference"] = finite(c.volumeDifference);
    return dumped(json);
}

std::string textOf(const CompareReport& compare) {
    const MeshComparison& c = compare.comparison;
    Table table({"distance", "mean", "rms", "max", "at most", "samples"});
    const auto side = [&](const char* name, const OneSidedDistance& d) {
        table.row({name, shortNumber(d.mean), shortNumber(d.rms), shortNumber(d.max), shortNumber(d.maxBound),
                   grouped(d.samples)});
    };
    side("A -> B", c.aToB);
    side("B -> A", c.bToA);
    table.row(
        {"symmetric", shortNumber(c.mean), shortNumber(c.rms), shortNumber(c.max), shortNumber(c.maxBound)});
    return table.text() + fmt::format("volume A {}, B {}, B - A {} ({} %)\n", shortNumber(c.volumeA),
                                      shortNumber(c.volumeB), shortNumber(c.volumeDifference),
                                      relativeText(c.volumeDifference, c.volumeA));
}

}  // namespace isowave::tools
