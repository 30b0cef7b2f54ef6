#include "io/mesh/glb.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/point_box.h"
#include "io/mesh/distance/distance_colours.h"
#include "io/mesh/float32.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using nlohmann::json;

// The views into the one buffer, and what their numbers mean.
struct Accessors {
    json views = json::array(), accessors = json::array();
    std::size_t bytes = 0;

    std::size_t add(std::size_t count, int component, const char* type, std::size_t width, int target) {
        views.push_back(
            {{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", count * width}, {"target", target}});
        accessors.push_back({{"bufferView", views.size() - 1},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
        bytes += count * width;
        return accessors.size() - 1;
    }
};

// The distance of the last colour.
double rangeOf(const MeshView& mesh) {
    if (mesh.distanceRange > 0) return mesh.distanceRange;
    return *std::max_element(mesh.distances.begin(), mesh.distances.end());
}

// Positions, normals, distances, colours, indices, in this order.
Accessors accessorsOf(const MeshView& mesh, const std::vector<FloatPoint>& points, json& primitive) {
    constexpr int kFloat = 5126, kUint32 = 5125, kUint16 = 5123, kArrayBuffer = 34962,
                  kElementArrayBuffer = 34963;
    FloatPoint low = points[0], high = points[0];
    for (const FloatPoint& p : points)
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    Accessors all;
    json& attributes = primitive["attributes"];
    attributes["POSITION"] = all.add(points.size(), kFloat, "VEC3", sizeof(FloatPoint), kArrayBuffer);
    all.accessors[0]["min"] = low;
    all.accessors[0]["max"] = high;
    if (!mesh.normals.empty())
        attributes["NORMAL"] = all.add(mesh.normals.size(), kFloat, "VEC3", sizeof(FloatPoint), kArrayBuffer);
    if (!mesh.distances.empty()) {
        attributes["_DISTANCE_TO_LEVEL0"] =
            all.add(mesh.distances.size(), kFloat, "SCALAR", sizeof(float), kArrayBuffer);
        attributes["COLOR_0"] =
            all.add(mesh.distances.size(), kUint16, "VEC4", sizeof(StoredColour), kArrayBuffer);
        all.accessors.back()["normalized"] = true;
    }
    primitive["indices"] =
        all.add(3 * mesh.triangles.size(), kUint32, "SCALAR", sizeof(std::uint32_t), kElementArrayBuffer);
    return all;
}

// What is taken off all points and put into the node: nothing, or the middle of the mesh's box where the mesh is farther from
// the origin than it is large, so that float32 has its digits for the shape and not for the place.
Point originOf(std::span<const Point> points) {
    PointBox box;
    for (const Point& p : points) box.add(p);
    double largest = 0, extent = 0;
    for (int a = 0; a < 3; ++a) {
        largest = std::max({largest, std::abs(box.low[a]), std::abs(box.high[a])});
        extent = std::max(extent, box.extent(a));
    }
    return largest > 2 * extent ? box.centre() : Point{};
}

// The JSON chunk, which describes one buffer.
json describe(const MeshView& mesh, const std::vector<FloatPoint>& points, const Point& origin,
              const std::string& title) {
    json gltf{{"asset", {{"version", "2.0"}, {"generator", "isowave"}}}, {"scene", 0}};
    if (mesh.space != Space::unspecified)
        gltf["asset"]["extras"]["SPACE"] = mesh.space == Space::lps ? "LPS" : "RAS";
    gltf["scenes"] = json::array({json{{"nodes", json::array({0})}}});
    json node{{"name", title}};
    if (origin != Point{}) node["translation"] = origin;
    if (!mesh.triangles.empty()) {  // glTF has no empty accessors: an empty mesh is a node without one
        json primitive;
        const Accessors all = accessorsOf(mesh, points, primitive);
        node["mesh"] = 0;
        gltf["meshes"] = json::array({json{{"name", title}, {"primitives", json::array({primitive})}}});
        if (!mesh.distances.empty()) gltf["meshes"][0]["extras"]["distance_of_last_colour"] = rangeOf(mesh);
        gltf["accessors"] = all.accessors;
        gltf["bufferViews"] = all.views;
        gltf["buffers"] = json::array({json{{"byteLength", all.bytes}}});
    }
    gltf["nodes"] = json::array({node});
    return gltf;
}

}  // namespace

void writeGlb(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title) {
    const Point origin = mesh.points.empty() ? Point{} : originOf(mesh.points);
    std::vector<Point> centred(mesh.points.begin(), mesh.points.end());
    for (Point& p : centred)
        for (std::size_t a = 0; a < 3; ++a) p[a] -= origin[a];
    MeshView around = mesh;
    around.points = centred;
    writeGlbAround(sink, around, name, title, origin);
}

void writeGlbAround(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title,
                    const Point& origin) {
    const std::vector<FloatPoint> points = separateFloats(mesh.points, name, "GLB");
    std::string text =
        describe(mesh, points, origin, title).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const bool empty = mesh.triangles.empty();
    const std::uint64_t binary = empty ? 0
                                       : sizeof(FloatPoint) * (points.size() + mesh.normals.size()) +
                                             (sizeof(float) + sizeof(StoredColour)) * mesh.distances.size() +
                                             sizeof(Triangle) * mesh.triangles.size();
    const std::uint64_t total = 12 + 8 + text.size() + (empty ? 0 : 8 + binary);
    if (total > 0xffffffffu)
        throw OperationError(
            name, "GLB holds at most 4 GiB, this mesh takes " + std::to_string(total) + " bytes; write PLY");
    const auto u32 = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a,
                            kBin = 0x004e4942;  // "glTF", "JSON", "BIN"
    sink.binary(kMagic, std::uint32_t{2}, u32(total), u32(text.size()), kJson);
    sink.text(text);
    if (empty) return;
    sink.binary(u32(binary), kBin);
    for (const FloatPoint& p : points) sink.binary(p);
    for (const FloatPoint& n : mesh.normals) sink.binary(n);
    for (const float d : mesh.distances) sink.binary(d);
    if (!mesh.distances.empty()) {
        const double range = rangeOf(mesh);
        for (const float d : mesh.distances) sink.binary(storedDistanceColour(d, range));
    }
    for (const Triangle& t : mesh.triangles) sink.binary(t);
}

}  // namespace isowave
