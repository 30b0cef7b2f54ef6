#include "io/mesh/glb_lods.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/point_box.h"
#include "io/mesh/distance/distance_colours.h"
#include "io/mesh/place.h"
#include "io/mesh/sink.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using nlohmann::json;

constexpr int kByte = 5120, kUint16 = 5123, kUint32 = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr double kSteps = 65535;

template <class... T>
void append(std::string& bytes, const T&... values) {
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
}

std::int8_t toByte(float x) { return static_cast<std::int8_t>(std::lround(127 * std::clamp(x, -1.f, 1.f))); }

// Views and accessors in the order in which their bytes lie.
struct Layout {
    json views = json::array(), accessors = json::array();
    std::size_t bytes = 0;

    // stride: of an element, a multiple of 4.
    json& add(std::size_t count, int component, const char* type, std::size_t stride, int target) {
        json view{{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", count * stride}, {"target", target}};
        if (target == kArrayBuffer) view["byteStride"] = stride;
        views.push_back(view);
        accessors.push_back({{"bufferView", views.size() - 1},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
        bytes += count * stride;
        return accessors.back();
    }
    std::size_t last() const { return accessors.size() - 1; }
};

template <class Level>
json primitiveOf(const Level& level, bool quantized, Layout& layout) {
    json primitive;
    json& positions =
        layout.add(level.vertices, quantized ? kUint16 : kFloat, "VEC3", quantized ? 8 : 12, kArrayBuffer);
    positions["min"] = level.low;
    positions["max"] = level.high;
    primitive["attributes"]["POSITION"] = layout.last();
    if (level.normals) {
        json& normals =
            layout.add(level.vertices, quantized ? kByte : kFloat, "VEC3", quantized ? 4 : 12, kArrayBuffer);
        if (quantized) normals["normalized"] = true;
        primitive["attributes"]["NORMAL"] = layout.last();
    }
    layout.add(3 * level.triangles, kUint32, "SCALAR", 4, kElementArrayBuffer);
    primitive["indices"] = layout.last();
    return primitive;
}

// The bytes of distances and colours lie behind those of all levels' shapes: colours are known when the last level is.
void addDistances(std::size_t vertices, Layout& layout, json& mesh, double range) {
    json& attributes = mesh["primitives"][0]["attributes"];
    layout.add(vertices, kFloat, "SCALAR", sizeof(float), kArrayBuffer);
    attributes["_DISTANCE_TO_LEVEL0"] = layout.last();
    layout.add(vertices, kUint16, "VEC4", sizeof(StoredColour), kArrayBuffer)["normalized"] = true;
    attributes["COLOR_0"] = layout.last();
    mesh["extras"]["distance_of_last_colour"] = range;
}

}  // namespace

// 8 bytes a vertex when quantized, the last two of them 0: glTF aligns vertices to 4.
void GlbLods::putPositions(const TriangleMesh& placed, Level& level) {
    const PointBox box = boxAround(placed);
    const double longest = std::max({box.extent(0), box.extent(1), box.extent(2)});
    level.step = quantized_ && longest > 0 ? longest / kSteps : 1;
    level.translation = quantized_ ? box.low : box.centre();
    PointBox stored;
    for (const Point& p : placed.points) {
        Point at;
        for (std::size_t a = 0; a < 3; ++a) at[a] = (p[a] - level.translation[a]) / level.step;
        if (quantized_) {
            for (double& x : at) x = std::round(std::clamp(x, 0.0, kSteps));
            for (const double x : at) append(binary_, static_cast<std::uint16_t>(x));
            append(binary_, std::uint16_t{0});
        } else {
            for (double& x : at) {
                x = static_cast<float>(x);
                append(binary_, static_cast<float>(x));
            }
        }
        stored.add(at);
    }
    level.low = stored.low;
    level.high = stored.high;
}

void GlbLods::putNormals(const TriangleMesh& placed) {
    for (const auto& n : placed.normals)
        if (quantized_)
            append(binary_, toByte(n[0]), toByte(n[1]), toByte(n[2]), std::int8_t{0});
        else
            append(binary_, n);
}

void GlbLods::add(const std::string& name, const TriangleMesh& mesh, double coverage,
                  std::vector<float> distances) {
    assert(distances.empty() || distances.size() == mesh.points.size());
    assert(levels_.empty() || levels_.front().distances.empty() == distances.empty());
    TriangleMesh placed{mesh.points, mesh.triangles, mesh.normals};
    placeFor(MeshFormat::glb, options_, placed);
    Level level;
    level.name = name;
    level.coverage = coverage;
    level.vertices = placed.points.size();
    level.triangles = placed.triangles.size();
    level.normals = !placed.normals.empty();
    level.distances = std::move(distances);
    putPositions(placed, level);
    putNormals(placed);
    for (const Triangle& t : placed.triangles) append(binary_, t);
    levels_.push_back(std::move(level));
}

double GlbLods::largestDistance() const {
    float largest = 0;
    for (const Level& level : levels_)
        for (const float d : level.distances) largest = std::max(largest, d);
    return largest;
}

// The JSON chunk.
std::string GlbLods::description(double range) const {
    json gltf{{"asset", {{"version", "2.0"}, {"generator", "isowave"}}}, {"scene", 0}};
    if (options_.space != Space::unspecified)
        gltf["asset"]["extras"]["SPACE"] = options_.space == Space::lps ? "LPS" : "RAS";
    gltf["scenes"] = json::array({json{{"nodes", json::array({0})}}});
    Layout layout;
    json coarser = json::array(), coverage = json::array();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const Level& level = levels_[i];
        const json primitive = primitiveOf(level, quantized_, layout);
        gltf["meshes"].push_back({{"name", level.name}, {"primitives", json::array({primitive})}});
        json node{{"name", level.name}, {"mesh", i}, {"translation", level.translation}};
        if (quantized_) node["scale"] = {level.step, level.step, level.step};
        gltf["nodes"].push_back(node);
        coverage.push_back(level.coverage);
        if (i > 0) coarser.push_back(i);
    }
    for (std::size_t i = 0; i < levels_.size(); ++i)
        if (!levels_[i].distances.empty())
            addDistances(levels_[i].vertices, layout, gltf["meshes"][i], range);
    if (!coarser.empty()) {
        gltf["extensionsUsed"].push_back("MSFT_lod");
        gltf["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = coarser;
        gltf["nodes"][0]["extras"]["MSFT_screencoverage"] = coverage;
    }
    if (quantized_) {
        gltf["extensionsUsed"].push_back("KHR_mesh_quantization");
        gltf["extensionsRequired"].push_back("KHR_mesh_quantization");
    }
    gltf["accessors"] = layout.accessors;
    gltf["bufferViews"] = layout.views;
    gltf["buffers"] = json::array({json{{"byteLength", layout.bytes}}});
    std::string text = gltf.dump(-1, ' ', false, json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return text;
}

void GlbLods::write(const std::filesystem::path& path, double distanceRange) const {
    if (levels_.empty()) throw InputError(path.string(), "no level has a triangle; nothing to write");
    const double range = distanceRange > 0 ? distanceRange : largestDistance();
    const std::string text = description(range);
    std::uint64_t binary = binary_.size();
    for (const Level& level : levels_)
        binary += (sizeof(float) + sizeof(StoredColour)) * level.distances.size();
    const std::uint64_t total = 12 + 8 + text.size() + 8 + binary;
    if (total > 0xffffffffu)
        throw OperationError(path.string(), "GLB holds at most 4 GiB, these levels take " +
                                                std::to_string(total) + " bytes; write one file a level");
    const auto u32 = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a,
                            kBin = 0x004e4942;  // "glTF", "JSON", "BIN"
    Sink sink(path);
    sink.binary(kMagic, std::uint32_t{2}, u32(total), u32(text.size()), kJson);
    sink.text(text);
    sink.binary(u32(binary), kBin);
    sink.text(binary_);
    for (const Level& level : levels_) {
        for (const float d : level.distances) sink.binary(d);
        for (const float d : level.distances) sink.binary(storedDistanceColour(d, range));
    }
    sink.finish();
}

}  // namespace isowave
