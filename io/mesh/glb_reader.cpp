#include "io/mesh/glb_reader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/mesh/lines.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using nlohmann::json;

constexpr int kDeepest = 64;  // nodes above each other
// Points and corners of all nodes: one mesh may hang from many, and a small file must not fill the memory.
constexpr std::size_t kMostByInstances = 20'000'000;

// Rows of a 3 x 4 matrix: p -> A p + t.
struct Affine {
    std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    Point operator()(const Point& p) const {
        Point q;
        for (std::size_t r = 0; r < 3; ++r)
            q[r] = rows[r][0] * p[0] + rows[r][1] * p[1] + rows[r][2] * p[2] + rows[r][3];
        return q;
    }
    // First `other`, then this.
    Affine after(const Affine& other) const {
        Affine result;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c) {
                result.rows[r][c] = c == 3 ? rows[r][3] : 0;
                for (std::size_t k = 0; k < 3; ++k) result.rows[r][c] += rows[r][k] * other.rows[k][c];
            }
        return result;
    }
    bool mirrors() const {
        const auto& [a, b, c] = rows;
        return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]) <
               0;
    }
};

// A component type of glTF: bytes, and a component as a double.
struct Component {
    int code;
    std::size_t size;
    double (*value)(const char* bytes);
    double largest;  // what a normalized integer divides by
};

template <class T>
double valueOf(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

constexpr Component kComponents[] = {
    {5120, 1, valueOf<std::int8_t>, 127},    {5121, 1, valueOf<std::uint8_t>, 255},
    {5122, 2, valueOf<std::int16_t>, 32767}, {5123, 2, valueOf<std::uint16_t>, 65535},
    {5125, 4, valueOf<std::uint32_t>, 1},    {5126, 4, valueOf<float>, 1},
};

// Where the values of an accessor lie.
struct Values {
    std::string_view bytes;
    std::size_t count = 0, stride = 0, width = 0;
    const Component* component = nullptr;
    bool normalized = false;

    double at(std::size_t i, std::size_t k) const {
        const double value = component->value(bytes.data() + i * stride + k * component->size);
        return normalized ? std::max(value / component->largest, -1.0) : value;
    }
};

class GlbReader {
  public:
    GlbReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    PolygonSoup read() {
        takeChunks();
        refuseForeign();
        for (const std::size_t node : roots()) takeNode(node, Affine(), 0);
        if (soup_.faceCount() == 0) fail("no triangles");
        note();
        return std::move(soup_);
    }

  private:
    [[noreturn]] void fail(const std::string& what) const { throw InputError(name_, what); }

    // ---- chunks

    std::uint32_t wordAt(std::size_t place) const {
        std::uint32_t word = 0;
        std::memcpy(&word, bytes_.data() + place, sizeof word);
        return word;
    }
    // "glTF", version, length; then chunks: length, type, bytes.
    void takeChunks() {
        if (!bytes_.starts_with("glTF")) fail("is no GLB file: it does not start with 'glTF'");
        if (bytes_.size() < 20) fail("the file ends in its header; it is truncated");
        if (wordAt(4) != 2) fail(fmt::format("glTF version {} is not read; version 2 is", wordAt(4)));
        if (wordAt(8) > bytes_.size())
            fail(fmt::format("the header promises {} bytes but the file holds {}; it is truncated", wordAt(8),
                             bytes_.size()));
        constexpr std::uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
        std::optional<std::string_view> text, binary;
        for (std::size_t at = 12; at + 8 <= bytes_.size();) {
            const std::size_t size = wordAt(at);
            if (size > bytes_.size() - at - 8)
                fail(fmt::format(
                    "a chunk at byte {} of {} bytes reaches beyond the end; the file is truncated or damaged",
                    at, size));
            if (wordAt(at + 4) == kJson && !text) text = bytes_.substr(at + 8, size);
            if (wordAt(at + 4) == kBin && !binary) binary = bytes_.substr(at + 8, size);
            at += 8 + size;
        }
        if (!text) fail("has no JSON chunk; it is damaged");
        root_ = json::parse(*text, nullptr, /*allow_exceptions=*/false);
        if (!root_.is_object()) fail("its JSON chunk is not valid JSON; it is damaged");
        binary_ = binary.value_or(std::string_view());
    }
    void refuseForeign() const {
        for (const auto& [key, what] : {std::pair{"KHR_draco_mesh_compression", "Draco"},
                                        std::pair{"EXT_meshopt_compression", "meshopt"}})
            for (const json& extension : list(root_, "extensionsRequired"))
                if (extension == key)
                    fail(
                        fmt::format("its triangles are compressed by {}, which is not read; export it "
                                    "uncompressed (gltf-transform copy)",
                                    what));
    }

    // ---- JSON

    // The elements of an array, none where there is none.
    static const json& list(const json& object, const char* key) {
        static const json kNone = json::array();
        const auto found = object.is_object() ? object.find(key) : object.end();
        return object.is_object() && found != object.end() && found->is_array() ? *found : kNone;
    }
    const json& element(const char* of, std::size_t index) const {
        const json& elements = list(root_, of);
        if (index >= elements.size() || !elements[index].is_object())
            fail(fmt::format("refers to number {} of '{}', which has {}; it is damaged", index, of,
                             elements.size()));
        return elements[index];
    }
    std::optional<std::size_t> number(const json& object, const char* key) const {
        const auto found = object.find(key);
        if (found == object.end()) return std::nullopt;
        if (!found->is_number_unsigned()) fail(fmt::format("'{}' is not a whole number; it is damaged", key));
        return found->get<std::size_t>();
    }
    std::size_t needed(const json& object, const char* key) const {
        const auto found = number(object, key);
        if (!found) fail(fmt::format("'{}' is missing where glTF needs it; it is damaged", key));
        return *found;
    }
    template <std::size_t N>
    std::optional<std::array<double, N>> numbers(const json& object, const char* key) const {
        if (!object.contains(key)) return std::nullopt;
        const json& values = list(object, key);
        std::array<double, N> result{};
        bool good = values.size() == N;
        for (std::size_t i = 0; good && i < N; ++i) {
            good = values[i].is_number();
            if (good) result[i] = values[i].get<double>();
        }
        if (!good) fail(fmt::format("'{}' of a node is not {} numbers; it is damaged", key, N));
        return result;
    }

    // ---- nodes

    std::vector<std::size_t> indices(const json& object, const char* key) const {
        std::vector<std::size_t> result;
        for (const json& index : list(object, key)) {
            if (!index.is_number_unsigned())
                fail(fmt::format("'{}' holds no whole numbers; it is damaged", key));
            result.push_back(index.get<std::size_t>());
        }
        return result;
    }
    // Of the scene; of a file without scenes, the nodes that are no node's children.
    std::vector<std::size_t> roots() const {
        if (!list(root_, "scenes").empty())
            return indices(element("scenes", number(root_, "scene").value_or(0)), "nodes");
        const json& nodes = list(root_, "nodes");
        std::vector<bool> isChild(nodes.size());
        for (const json& node : nodes)
            for (const std::size_t child : indices(node, "children"))
                if (child < isChild.size()) isChild[child] = true;
        std::vector<std::size_t> roots;
        for (std::size_t i = 0; i < isChild.size(); ++i)
            if (!isChild[i]) roots.push_back(i);
        return roots;
    }
    Affine placeOf(const json& node) const {
        Affine place;
        if (const auto m = numbers<16>(node, "matrix")) {  // by columns
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 4; ++c) place.rows[r][c] = (*m)[4 * c + r];
            return place;
        }
        const auto t = numbers<3>(node, "translation").value_or(std::array<double, 3>{0, 0, 0});
        const auto s = numbers<3>(node, "scale").value_or(std::array<double, 3>{1, 1, 1});
        const auto [x, y, z, w] = numbers<4>(node, "rotation").value_or(std::array<double, 4>{0, 0, 0, 1});
        place.rows = {
            {{s[0] * (1 - 2 * (y * y + z * z)), s[1] * 2 * (x * y - z * w), s[2] * 2 * (x * z + y * w), t[0]},
             {s[0] * 2 * (x * y + z * w), s[1] * (1 - 2 * (x * x + z * z)), s[2] * 2 * (y * z - x * w), t[1]},
             {s[0] * 2 * (x * z - y * w), s[1] * 2 * (y * z + x * w), s[2] * (1 - 2 * (x * x + y * y)),
              t[2]}}};
        return place;
    }
    void takeNode(std::size_t index, const Affine& above, int depth) {
        if (depth > kDeepest || ++nodesTaken_ > 1'000'000) fail("its nodes hold each other; it is damaged");
        const json& node = element("nodes", index);
        const Affine place = above.after(placeOf(node));
        if (const auto mesh = number(node, "mesh")) {
            ++meshesTaken_;
            const json& meshOfNode = element("meshes", *mesh);
            const json& weights = list(list(node, "weights").empty() ? meshOfNode : node, "weights");
            for (const json& primitive : list(meshOfNode, "primitives"))
                takePrimitive(primitive, place, weights);
        }
        for (const std::size_t child : indices(node, "children")) takeNode(child, place, depth + 1);
    }

    // ---- triangles

    Values valuesOf(std::size_t accessorIndex, std::size_t width, const char* type) const {
        const json& accessor = element("accessors", accessorIndex);
        if (accessor.contains("sparse")) fail("an accessor is sparse, which is not read; export it without");
        Values values;
        values.width = width;
        values.count = needed(accessor, "count");
        if (accessor.value("type", json()) != type)
            fail(fmt::format("an accessor is not of type {}, as its use needs it; it is damaged", type));
        const std::size_t code = needed(accessor, "componentType");
        for (const Component& c : kComponents)
            if (code == static_cast<std::size_t>(c.code)) values.component = &c;
        if (!values.component) fail(fmt::format("component type {} is none of glTF; it is damaged", code));
        values.normalized = accessor.value("normalized", json()) == true;
        const json& view = element("bufferViews", needed(accessor, "bufferView"));
        const std::size_t buffer = number(view, "buffer").value_or(0);
        if (buffer != 0 || element("buffers", 0).contains("uri"))
            fail("its data lies in another file or in its text; export it as one GLB file");
        const std::size_t item = width * values.component->size;
        values.stride = number(view, "byteStride").value_or(0);
        if (values.stride == 0) values.stride = item;
        const std::size_t begin = number(view, "byteOffset").value_or(0), size = needed(view, "byteLength"),
                          offset = number(accessor, "byteOffset").value_or(0);
        const bool fits =
            begin <= binary_.size() && size <= binary_.size() - begin && offset <= size &&
            (values.count == 0 ||
             (item <= size - offset && (values.count - 1) <= (size - offset - item) / values.stride));
        if (!fits) fail("an accessor reaches beyond its data; the file is truncated or damaged");
        values.bytes = binary_.substr(begin + offset, size - offset);
        return values;
    }
    // (x, y up, z) in metres -> (x, -z, y up) in mm.
    static Point inMillimetres(const Point& p) { return {1000 * p[0], -1000 * p[2] + 0.0, 1000 * p[1]}; }

    // The points of the file: its positions, moved by the morph targets as far as the weights say.
    std::vector<Point> pointsOf(const json& primitive, const json& attributes, const json& weights) {
        const Values positions = valuesOf(needed(attributes, "POSITION"), 3, "VEC3");
        std::vector<Point> points(positions.count);
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] = {positions.at(i, 0), positions.at(i, 1), positions.at(i, 2)};
        const json& targets = list(primitive, "targets");
        if (!targets.empty()) soup_.drop(Dropped::morphTargets);
        for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
            if (!weights[t].is_number()) fail("'weights' holds no numbers; it is damaged");
            const double weight = weights[t].get<double>();
            if (weight == 0 || !targets[t].is_object() || !targets[t].contains("POSITION")) continue;
            const Values moves = valuesOf(needed(targets[t], "POSITION"), 3, "VEC3");
            if (moves.count != points.size())
                fail(fmt::format("a morph target moves {} of {} points; it is damaged", moves.count,
                                 points.size()));
            for (std::size_t i = 0; i < points.size(); ++i)
                for (std::size_t a = 0; a < 3; ++a) points[i][a] += weight * moves.at(i, a);
        }
        return points;
    }
    void takePrimitive(const json& primitive, const Affine& place, const json& weights) {
        if (!primitive.is_object()) fail("a primitive is no object; it is damaged");
        constexpr std::size_t kTriangles = 4, kFan = 6;  // and strips between them
        const std::size_t mode = number(primitive, "mode").value_or(kTriangles);
        const json attributes = primitive.value("attributes", json::object());
        noteAttributes(primitive, attributes);
        if (mode < kTriangles || mode > kFan) return soup_.drop(Dropped::lines);
        if (!attributes.is_object() || !attributes.contains("POSITION")) return;
        const std::vector<Point> points = pointsOf(primitive, attributes, weights);
        const std::size_t first = soup_.points.size();
        if (first + points.size() > std::numeric_limits<std::uint32_t>::max()) fail("more than 2^32 points");
        for (const Point& p : points) soup_.points.push_back(inMillimetres(place(p)));
        std::vector<std::uint32_t> corners = cornersOf(primitive, points.size());
        takeTriangles(corners, first, mode, place.mirrors());
    }
    std::vector<std::uint32_t> cornersOf(const json& primitive, std::size_t points) const {
        std::vector<std::uint32_t> corners;
        const auto accessor = number(primitive, "indices");
        if (!accessor) {
            for (std::size_t i = 0; i < points; ++i) corners.push_back(static_cast<std::uint32_t>(i));
            return corners;
        }
        const Values indices = valuesOf(*accessor, 1, "SCALAR");
        for (std::size_t i = 0; i < indices.count; ++i) {
            const double index = indices.at(i, 0);
            if (!(index >= 0 && index < static_cast<double>(points)))
                fail(fmt::format("a triangle refers to point {}; its mesh has points 0 to {}", index,
                                 static_cast<std::int64_t>(points) - 1));
            corners.push_back(static_cast<std::uint32_t>(index));
        }
        return corners;
    }
    void refuseMany(std::size_t count) const {
        if (count > std::max(kMostByInstances, bytes_.size()))
            fail(fmt::format(
                "its nodes show the same meshes so often that {} points or corners come of {} bytes; "
                "export fewer copies",
                count, bytes_.size()));
    }
    // List: 012 345; strip: 012 213 234; fan: 012 023.
    void takeTriangles(const std::vector<std::uint32_t>& corners, std::size_t first, std::size_t mode,
                       bool mirrored) {
        const auto take = [&](std::size_t a, std::size_t b, std::size_t c) {
            if (mirrored) std::swap(b, c);
            for (const std::size_t i : {a, b, c})
                soup_.corners.push_back(static_cast<std::uint32_t>(first + corners[i]));
            soup_.endFace();
        };
        refuseMany(soup_.corners.size() + 3 * corners.size());
        if (mode == 4)
            for (std::size_t i = 2; i < corners.size(); i += 3) take(i - 2, i - 1, i);
        else
            for (std::size_t i = 2; i < corners.size(); ++i)
                mode == 6 ? take(0, i - 1, i) : i % 2 == 0 ? take(i - 2, i - 1, i) : take(i - 1, i - 2, i);
    }

    // ---- what is not kept

    void noteAttributes(const json& primitive, const json& attributes) {
        if (primitive.contains("material")) soup_.drop(Dropped::materials);
        if (!attributes.is_object()) return;
        for (const auto& [key, accessor] : attributes.items()) {
            if (key.starts_with("COLOR")) soup_.drop(Dropped::colours);
            if (key.starts_with("TEXCOORD")) soup_.drop(Dropped::textureCoordinates);
            if (key == "NORMAL") soup_.drop(Dropped::normals);
        }
    }
    void note() {
        if (meshesTaken_ > 1) soup_.drop(Dropped::groups);
        if (!list(root_, "animations").empty() || !list(root_, "skins").empty())
            soup_.drop(Dropped::animations);
        const json asset = root_.value("asset", json::object());
        const json extras = asset.is_object() ? asset.value("extras", json::object()) : json::object();
        if (extras.is_object() && extras.contains("SPACE") && extras["SPACE"].is_string())
            soup_.space = spaceIn("SPACE=" + extras["SPACE"].get<std::string>());
    }

    std::string_view bytes_, binary_;
    const std::string& name_;
    json root_;
    PolygonSoup soup_;
    std::size_t nodesTaken_ = 0, meshesTaken_ = 0;
};

}  // namespace

PolygonSoup readGlb(std::string_view bytes, const std::string& name) {
    PolygonSoup soup = GlbReader(bytes, name).read();
    soup.format = "GLB";
    soup.float32 = false;  // of the values in the file; nodes move them in double
    return soup;
}

}  // namespace isowave
