#include "io/mesh/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "polygonize/topology.h"
#include "volume/mesh_repair.h"

namespace isowave {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary formats are written as the memory has them");

using FloatPoint = std::array<float, 3>;

constexpr std::array<std::pair<MeshFormat, const char*>, 5> kExtensions{{{MeshFormat::stl, ".stl"},
                                                                         {MeshFormat::ply, ".ply"},
                                                                         {MeshFormat::obj, ".obj"},
                                                                         {MeshFormat::off, ".off"},
                                                                         {MeshFormat::glb, ".glb"}}};

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

// Bytes to an AtomicFile, in big pieces.
class Sink {
  public:
    explicit Sink(const std::filesystem::path& path) : path_(path), file_(path) {
        buffer_.reserve(kPiece + 256);
    }

    void text(std::string_view s) {
        buffer_.append(s);
        flushPiece();
    }
    template <class... T>
    void binary(const T&... values) {
        (buffer_.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
        flushPiece();
    }
    // The shortest decimal that reads back exactly, after `before`.
    template <class Number>
    void number(char before, Number value) {
        std::array<char, 32> digits;
        digits[0] = before;
        const auto end = std::to_chars(digits.data() + 1, digits.data() + digits.size(), value).ptr;
        text({digits.data(), end});
    }
    void finish() {
        write();
        file_.commit();
    }

  private:
    static constexpr std::size_t kPiece = 1 << 20;
    void flushPiece() {
        if (buffer_.size() >= kPiece) write();
    }
    void write() {
        errno = 0;
        try {
            file_.stream().write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        } catch (const std::ios_base::failure&) {
            throw OperationError(path_.string(), std::string("writing failed (") + std::strerror(errno) +
                                                     "); is the disk full? Nothing was left behind");
        }
        buffer_.clear();
    }
    std::filesystem::path path_;
    AtomicFile file_;
    std::string buffer_;
};

const char* spaceComment(Space space) {
    return space == Space::lps ? "SPACE=LPS" : space == Space::ras ? "SPACE=RAS" : "";
}

// The mesh as the file shall have it: a reference to the caller's triangles, own points and normals.
// + 0.0 turns -0 into 0, which are one point to a reader.
struct PlacedMesh {
    std::vector<Point> points;
    std::vector<FloatPoint> normals;
    const std::vector<Triangle>& triangles;

    template <class Turn>
    void transform(const Turn& turn) {
        for (Point& p : points) {
            p = turn(p);
            for (double& x : p) x += 0.0;
        }
        for (FloatPoint& n : normals) {
            n = turn(n);
            for (float& x : n) x += 0.0f;
        }
    }
};

PlacedMesh placeFor(const TriangleMesh& mesh, MeshFormat format, const MeshWriteOptions& options) {
    PlacedMesh placed{mesh.points, mesh.normals, mesh.triangles};
    if (options.space == Space::ras)
        placed.transform([](const auto& p) { return std::decay_t<decltype(p)>{-p[0], -p[1], p[2]}; });
    if (format == MeshFormat::glb) {
        placed.transform([](const auto& p) { return std::decay_t<decltype(p)>{p[0], p[2], -p[1]}; });
        for (Point& p : placed.points)
            for (double& x : p) x *= options.metresPerUnit;
    }
    return placed;
}

FloatPoint toFloat(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}
Point toDouble(const FloatPoint& p) { return {p[0], p[1], p[2]}; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Point& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

// ------------------------------------------------------------------------------------------------- float32

std::vector<std::uint32_t> firstEqualFloats(const std::vector<FloatPoint>& floats) {
    std::vector<Point> points(floats.size());
    std::transform(floats.begin(), floats.end(), points.begin(), toDouble);
    return firstEqualPoints(points);
}

struct HashFloatPoint {
    std::size_t operator()(const FloatPoint& p) const {
        std::size_t h = 0;
        for (const float x : p) h = (h ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u;
        return h ^ h >> 29;
    }
};

// The float32 points within 2 steps of `at` on each axis, nearest to `exact` first.
std::vector<FloatPoint> neighboursOf(const FloatPoint& at, const Point& exact, float step) {
    std::vector<FloatPoint> near;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            for (int k = -2; k <= 2; ++k)
                near.push_back({at[0] + static_cast<float>(i) * step, at[1] + static_cast<float>(j) * step,
                                at[2] + static_cast<float>(k) * step});
    std::stable_sort(near.begin(), near.end(), [&](const FloatPoint& a, const FloatPoint& b) {
        return length(minus(toDouble(a), exact)) < length(minus(toDouble(b), exact));
    });
    return near;
}

// Different points as different float32 triples (see the header). A reader that merges by position, and only
// that, then finds the mesh's own vertices again.
std::vector<FloatPoint> separateFloats(const std::vector<Point>& points, const std::string& path,
                                       const char* format) {
    std::vector<FloatPoint> floats(points.size());
    std::transform(points.begin(), points.end(), floats.begin(), toFloat);
    float largest = 0;
    for (const FloatPoint& p : floats)
        for (const float x : p) {
            if (!std::isfinite(x))
                throw OperationError(
                    path, std::string("a coordinate does not fit float32, which is all that ") + format +
                              " has; write PLY");
            largest = std::max(largest, std::abs(x));
        }
    const std::vector<std::uint32_t> first = firstEqualFloats(floats);
    std::vector<std::uint32_t> fused;
    for (std::uint32_t i = 0; i < first.size(); ++i)
        if (first[i] != i) fused.push_back(i);
    if (fused.empty()) return floats;

    const float step = std::nextafter(largest, INFINITY) - largest;
    std::unordered_set<FloatPoint, HashFloatPoint> taken(floats.begin(), floats.end());
    for (const std::uint32_t i : fused) {
        const auto near = neighboursOf(floats[i], points[i], step);
        const auto free =
            std::find_if(near.begin(), near.end(), [&](const auto& p) { return !taken.count(p); });
        if (free == near.end())
            throw OperationError(path, std::string("float32, which is all that ") + format +
                                           " has, cannot tell " + std::to_string(fused.size()) + " of " +
                                           std::to_string(points.size()) +
                                           " vertices from their neighbours (coordinates up to " +
                                           std::to_string(largest) + "); write PLY, which can have float64");
        floats[i] = *free;
        taken.insert(*free);
    }
    return floats;
}

bool needsFloat64(const PlacedMesh& mesh) {
    constexpr double kAllowed = 1e-4;  // of the mean edge
    double edges = 0, error = 0;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) edges += length(minus(mesh.points[t[k]], mesh.points[t[(k + 1) % 3]]));
    const double mean = edges / std::max<double>(1, 3.0 * static_cast<double>(mesh.triangles.size()));
    std::vector<FloatPoint> floats(mesh.points.size());
    for (std::size_t i = 0; i < floats.size(); ++i) {
        floats[i] = toFloat(mesh.points[i]);
        error = std::max(error, length(minus(toDouble(floats[i]), mesh.points[i])));
    }
    if (!(error <= kAllowed * mean)) return !mesh.triangles.empty();
    const auto first = firstEqualFloats(floats);
    for (std::uint32_t i = 0; i < first.size(); ++i)
        if (first[i] != i) return true;
    return false;
}

// ------------------------------------------------------------------------------------------------- formats

// What STL would leave of the mesh must be enough for readMesh.
void checkSteps(const std::vector<FloatPoint>& points, const std::string& path) {
    if (points.empty()) return;
    float largest = 0, extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            points.begin(), points.end(), [&](const auto& p, const auto& q) { return p[axis] < q[axis]; });
        largest = std::max({largest, (*high)[axis], -(*low)[axis]});
        extent = std::max(extent, (*high)[axis] - (*low)[axis]);
    }
    const float step = std::nextafter(largest, INFINITY) - largest;
    if (extent < kFewestSteps * step)
        throw OperationError(path, fmt::format("float32, which is all that STL has, has steps of {:.2g} at "
                                               "{:g}, fewer than {} across a mesh of {:g}; write PLY, which "
                                               "can have float64",
                                               step, largest, kFewestSteps, extent));
}

void writeStl(const std::filesystem::path& path, const PlacedMesh& mesh, Space space) {
    if (mesh.triangles.size() > 0xffffffffu)
        throw OperationError(path.string(), "STL holds at most 2^32 - 1 triangles; write PLY");
    const std::vector<FloatPoint> points = separateFloats(mesh.points, path.string(), "STL");
    checkSteps(points, path.string());
    Sink sink(path);
    // Not "solid": that is how the text form begins.
    std::string header = "binary STL by isowave";
    if (space != Space::unspecified) header += std::string(" ") + spaceComment(space);
    header.resize(80, ' ');
    sink.text(header);
    sink.binary(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& [a, b, c] : mesh.triangles) {
        const Point origin = toDouble(points[a]);
        Point normal = cross(minus(toDouble(points[b]), origin), minus(toDouble(points[c]), origin));
        if (const double l = length(normal); l > 0)
            for (double& x : normal) x = x / l + 0.0;
        sink.binary(toFloat(normal), points[a], points[b], points[c], std::uint16_t{0});
    }
    sink.finish();
}

void writePly(const std::filesystem::path& path, const PlacedMesh& mesh, Space space) {
    const bool wide = needsFloat64(mesh), normals = !mesh.normals.empty();
    const std::string real = wide ? "double" : "float";
    Sink sink(path);
    sink.text("ply\nformat binary_little_endian 1.0\ncomment isowave\n");
    if (space != Space::unspecified) sink.text(std::string("comment ") + spaceComment(space) + "\n");
    sink.text("element vertex " + std::to_string(mesh.points.size()) + "\n");
    for (const char* axis : {"x", "y", "z"}) sink.text("property " + real + " " + axis + "\n");
    if (normals) sink.text("property float nx\nproperty float ny\nproperty float nz\n");
    sink.text("element face " + std::to_string(mesh.triangles.size()) + "\n");
    // int, as all readers know it, unless indices need the 32nd bit.
    const char* index = mesh.points.size() > 0x7fffffffu ? "uint" : "int";
    sink.text(std::string("property list uchar ") + index + " vertex_indices\nend_header\n");
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (wide)
            sink.binary(mesh.points[i]);
        else
            sink.binary(toFloat(mesh.points[i]));
        if (normals) sink.binary(mesh.normals[i]);
    }
    for (const Triangle& t : mesh.triangles) sink.binary(std::uint8_t{3}, t);
    sink.finish();
}

void writeObj(const std::filesystem::path& path, const PlacedMesh& mesh, Space space) {
    Sink sink(path);
    sink.text("# isowave\n");
    if (space != Space::unspecified) sink.text(std::string("# ") + spaceComment(space) + "\n");
    for (const Point& p : mesh.points) {
        sink.text("v");
        for (const double x : p) sink.number(' ', x);
        sink.text("\n");
    }
    for (const FloatPoint& n : mesh.normals) {
        sink.text("vn");
        for (const float x : n) sink.number(' ', x);
        sink.text("\n");
    }
    for (const Triangle& t : mesh.triangles) {
        sink.text("f");
        for (const std::uint32_t v : t) {
            sink.number(' ', std::uint64_t{v} + 1);
            if (mesh.normals.empty()) continue;
            sink.text("/");
            sink.number('/', std::uint64_t{v} + 1);
        }
        sink.text("\n");
    }
    sink.finish();
}

void writeOff(const std::filesystem::path& path, const PlacedMesh& mesh, Space space) {
    Sink sink(path);
    sink.text("OFF\n");
    if (space != Space::unspecified) sink.text(std::string("# ") + spaceComment(space) + "\n");
    sink.text(std::to_string(mesh.points.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
    for (const Point& p : mesh.points) {
        std::array<char, 96> line;
        char* at = line.data();
        for (const double x : p) {
            at = std::to_chars(at, line.data() + line.size(), x).ptr;
            *at++ = ' ';
        }
        at[-1] = '\n';
        sink.text({line.data(), at});
    }
    for (const Triangle& t : mesh.triangles) {
        sink.text("3");
        for (const std::uint32_t v : t) sink.number(' ', v);
        sink.text("\n");
    }
    sink.finish();
}

// glTF 2.0: a JSON chunk that describes one buffer, and the buffer: positions, normals, indices.
nlohmann::json describeGlb(const std::string& name, const PlacedMesh& mesh,
                           const std::vector<FloatPoint>& points, Space space) {
    constexpr int kFloat = 5126, kUint32 = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;
    using nlohmann::json;
    json asset{{"version", "2.0"}, {"generator", "isowave"}};
    if (space != Space::unspecified) asset["extras"]["SPACE"] = space == Space::lps ? "LPS" : "RAS";
    json node{{"name", name}};
    json gltf{{"asset", asset}, {"scene", 0}};
    gltf["scenes"] = json::array({json{{"nodes", json::array({0})}}});
    if (mesh.triangles.empty()) {  // glTF has no empty accessors: an empty mesh is a node without one
        gltf["nodes"] = json::array({node});
        return gltf;
    }
    FloatPoint low = points[0], high = points[0];
    for (const FloatPoint& p : points)
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    json views = json::array(), accessors = json::array();
    std::size_t offset = 0;
    const auto add = [&](std::size_t count, int component, const char* type, std::size_t width, int target) {
        views.push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", count * width}, {"target", target}});
        accessors.push_back({{"bufferView", views.size() - 1},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
        offset += count * width;
        return accessors.size() - 1;
    };
    json attributes{{"POSITION", add(points.size(), kFloat, "VEC3", sizeof(FloatPoint), kArrayBuffer)}};
    accessors[0]["min"] = low;
    accessors[0]["max"] = high;
    if (!mesh.normals.empty())
        attributes["NORMAL"] = add(mesh.normals.size(), kFloat, "VEC3", sizeof(FloatPoint), kArrayBuffer);
    const auto indices =
        add(3 * mesh.triangles.size(), kUint32, "SCALAR", sizeof(std::uint32_t), kElementArrayBuffer);
    node["mesh"] = 0;
    gltf["nodes"] = json::array({node});
    const json primitive{{"attributes", attributes}, {"indices", indices}};
    gltf["meshes"] = json::array({json{{"name", name}, {"primitives", json::array({primitive})}}});
    gltf["accessors"] = accessors;
    gltf["bufferViews"] = views;
    gltf["buffers"] = json::array({json{{"byteLength", offset}}});
    return gltf;
}

void writeGlb(const std::filesystem::path& path, const PlacedMesh& mesh, Space space) {
    const std::vector<FloatPoint> points = separateFloats(mesh.points, path.string(), "GLB");
    std::string json = describeGlb(path.stem().string(), mesh, points, space)
                           .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const bool empty = mesh.triangles.empty();
    const std::uint64_t binary = empty ? 0
                                       : sizeof(FloatPoint) * (points.size() + mesh.normals.size()) +
                                             sizeof(Triangle) * mesh.triangles.size();
    const std::uint64_t total = 12 + 8 + json.size() + (empty ? 0 : 8 + binary);
    if (total > 0xffffffffu)
        throw OperationError(path.string(), "GLB holds at most 4 GiB, this mesh takes " +
                                                std::to_string(total) + " bytes; write PLY");
    const auto u32 = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a,
                            kBin = 0x004e4942;  // "glTF", "JSON", "BIN"
    Sink sink(path);
    sink.binary(kMagic, std::uint32_t{2}, u32(total), u32(json.size()), kJson);
    sink.text(json);
    if (!empty) {
        sink.binary(u32(binary), kBin);
        for (const FloatPoint& p : points) sink.binary(p);
        for (const FloatPoint& n : mesh.normals) sink.binary(n);
        for (const Triangle& t : mesh.triangles) sink.binary(t);
    }
    sink.finish();
}

}  // namespace

MeshFormat meshFormatFromName(const std::string& name) {
    for (const auto& [format, extension] : kExtensions)
        if (lowerCase(name) == extension + 1) return format;
    throw InputError("'" + name + "'",
                     "not a mesh format that isowave writes; expected stl, ply, obj, off or glb");
}

MeshFormat meshFormatOf(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    for (const auto& [format, known] : kExtensions)
        if (extension == known) return format;
    throw InputError(path.string(), (extension.empty() ? "no extension" : "extension '" + extension + "'") +
                                        std::string("; expected .stl, .ply, .obj, .off or .glb"));
}

const char* extensionOf(MeshFormat format) {
    return std::find_if(kExtensions.begin(), kExtensions.end(),
                        [&](const auto& e) { return e.first == format; })
        ->second;
}

void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format,
               const MeshWriteOptions& options) {
    assert(mesh.normals.empty() || mesh.normals.size() == mesh.points.size());
    const PlacedMesh placed = placeFor(mesh, format, options);
    switch (format) {
        case MeshFormat::stl:
            return writeStl(path, placed, options.space);
        case MeshFormat::ply:
            return writePly(path, placed, options.space);
        case MeshFormat::obj:
            return writeObj(path, placed, options.space);
        case MeshFormat::off:
            return writeOff(path, placed, options.space);
        case MeshFormat::glb:
            return writeGlb(path, placed, options.space);
    }
}

}  // namespace isowave
