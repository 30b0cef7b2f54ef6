#include "lod/source.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace isowave::lod {
namespace {

using Json = nlohmann::ordered_json;
using Source = std::map<std::string, std::string>;

constexpr std::array<const char*, 6> kKinds{"mask", "labels", "grey image", "mesh", "level set", "pyramid"};
constexpr std::array<const char*, 3> kSpaces{"unspecified", "lps", "ras"};

std::string textOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// JSON knows no infinity.
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

class FieldList {
  public:
    void put(const char* key, const Json& value) { fields_.emplace_back(key, textOf(value)); }
    template <class T>
    void putIf(const char* key, const std::optional<T>& value) {
        if (value) put(key, *value);
    }
    void putIf(const char* key, const std::string& value) {
        if (!value.empty()) put(key, value);
    }
    Fields fields() && { return std::move(fields_); }

  private:
    Fields fields_;
};

// "input." -> the rest of the keys that start so, and their texts, made JSON where they are not.
Fields under(const std::string& prefix, const Source& source) {
    Fields fields;
    for (const auto& [key, text] : source) {
        if (!key.starts_with(prefix)) continue;
        Json value = Json::parse(text, nullptr, /*allow_exceptions=*/false);
        if (value.is_discarded()) value = text;
        fields.emplace_back(key.substr(prefix.size()), textOf(value));
    }
    return fields;
}

Json objectOf(const Fields& fields) {
    Json object = Json::object();
    for (const auto& [key, text] : fields) object[key] = Json::parse(text);
    return object;
}

Fields fieldsOfPyramid(const InputReport& input) {
    FieldList list;
    list.put("path", input.path);
    list.put("kind", nameOf(input.kind));
    const Fields source = under("input.", input.source);
    if (source.empty()) return std::move(list).fields();
    const Json object = objectOf(source);
    for (const char* key :
         {"dimensions", "spacing", "iso", "volume", "parts", "handles", "cavities", "space", "unit"})
        if (object.contains(key)) list.put(key, object[key]);
    list.put("source", object);
    return std::move(list).fields();
}

Fields fieldsOfMesh(const InputReport& input) {
    FieldList list;
    list.put("path", input.path);
    list.put("kind", nameOf(input.kind));
    list.put("format", input.format);
    list.putIf("dimensions", input.dimensions);
    list.putIf("spacing", input.spacing);
    list.putIf("triangles", input.triangles);
    list.putIf("volume", input.volume);
    list.putIf("parts", input.parts);
    list.putIf("handles", input.handles);
    list.putIf("cavities", input.cavities);
    list.put("repair", input.repairNotes);
    list.putIf("unit", input.unit);
    list.put("space", nameOf(input.space.value_or(Space::unspecified)));
    return std::move(list).fields();
}

Fields fieldsOfLattice(const InputReport& input) {
    FieldList list;
    list.put("path", input.path);
    list.put("kind", nameOf(input.kind));
    if (input.kind == InputReport::Kind::levelSet) list.put("grid", input.grid);
    list.putIf("format", input.format);
    list.putIf("component_type", input.componentType);
    list.putIf("dimensions", input.dimensions);
    list.putIf("spacing", input.spacing);
    if (input.range) list.put("range", {finite((*input.range)[0]), finite((*input.range)[1])});
    list.putIf("label", input.label);
    if (!input.labels.empty()) list.put("labels", input.labels);
    list.putIf("iso", input.iso);
    list.putIf("inverted", input.inverted);
    list.putIf("open_border", input.openBorder);
    list.putIf("volume", input.volume);
    list.putIf("origin", input.origin);
    list.putIf("direction", input.direction);
    list.putIf("unit", input.unit);
    list.put("space", nameOf(input.space.value_or(Space::unspecified)));
    return std::move(list).fields();
}

// The value of a key, where it is there and converts to T.
template <class T>
std::optional<T> valueOf(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    try {
        return found->template get<T>();
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

template <class Enum, std::size_t N>
std::optional<Enum> choiceOf(const Json& object, const char* key, const std::array<const char*, N>& names) {
    const auto text = valueOf<std::string>(object, key);
    for (std::size_t i = 0; text && i < N; ++i)
        if (*text == names[i]) return static_cast<Enum>(i);
    return std::nullopt;
}

void putWalls(const WallSummary& walls, FieldList& list) {
    list.put("walls_rows", walls.rows);
    list.put("walls_sweeps", walls.sweeps);
    list.put("walls_unmet", walls.unmet);
    list.put("walls_between", walls.between);
    list.put("walls_changed", walls.changed);
    list.put("walls_thickened", walls.thickened);
    list.put("walls_thinnest", walls.thinnest);
    list.put("walls_least_refine", walls.leastRefine);
}

std::optional<WallSummary> wallsOf(const Json& fit) {
    const auto rows = valueOf<std::int64_t>(fit, "walls_rows");
    if (!rows) return std::nullopt;
    WallSummary walls;
    walls.rows = *rows;
    walls.sweeps = valueOf<int>(fit, "walls_sweeps").value_or(0);
    walls.unmet = valueOf<std::int64_t>(fit, "walls_unmet").value_or(0);
    walls.between = valueOf<std::int64_t>(fit, "walls_between").value_or(0);
    walls.changed = valueOf<std::int64_t>(fit, "walls_changed").value_or(0);
    walls.thickened = valueOf<std::int64_t>(fit, "walls_thickened").value_or(0);
    walls.thinnest = valueOf<double>(fit, "walls_thinnest").value_or(0);
    walls.leastRefine = valueOf<int>(fit, "walls_least_refine").value_or(1);
    return walls;
}

}  // namespace

const char* nameOf(InputReport::Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }
const char* nameOf(Space space) { return kSpaces[static_cast<std::size_t>(space)]; }

std::string unitOf(const InputReport& input) {
    const InputReport& made = input.madeFrom ? *input.madeFrom : input;
    if (!made.unit.empty()) return made.unit;
    const bool isImage = made.kind == InputReport::Kind::mask || made.kind == InputReport::Kind::labels ||
                         made.kind == InputReport::Kind::greyImage;
    return isImage || made.space.value_or(Space::unspecified) != Space::unspecified ? "mm" : "";
}

Fields fieldsOf(const InputReport& input) {
    switch (input.kind) {
        case InputReport::Kind::pyramid:
            return fieldsOfPyramid(input);
        case InputReport::Kind::mesh:
            return fieldsOfMesh(input);
        default:
            return fieldsOfLattice(input);
    }
}

Fields fieldsOf(const std::optional<FitSummary>& fit, const InputReport& input) {
    if (input.kind == InputReport::Kind::pyramid) return under("fit.", input.source);
    FieldList list;
    if (!fit) return {};
    list.put("method", kFitMethods[static_cast<std::size_t>(fit->method)]);
    if (fit->method == FitMethod::binary) list.put("filter_passes", fit->filterPasses);
    if (fit->method == FitMethod::mask) list.put("gradient_passes", fit->gradientPasses);
    if (fit->method == FitMethod::distance) {
        list.put("half_width", fit->halfWidth);
        list.put("band", fit->band);
    }
    list.put("lattice_points", fit->latticePoints);
    list.put("disagreeing", fit->disagreeing);
    list.put("repair_passes", fit->repairPasses);
    list.put("repaired", fit->repaired);
    list.put("repair_floor", fit->repairFloor);
    list.put("stopped", fit->repairAgreed ? "agreed" : "pass_limit");
    if (fit->walls) putWalls(*fit->walls, list);
    return std::move(list).fields();
}

std::string valueOf(const std::string& text) { return textOf(text); }

std::map<std::string, std::string> sourceOf(const InputReport& input, const std::optional<FitSummary>& fit) {
    Source source;
    for (auto& [key, text] : fieldsOf(input)) source["input." + key] = text;
    for (auto& [key, text] : fieldsOf(fit, input)) source["fit." + key] = text;
    return source;
}

std::shared_ptr<const InputReport> inputOfSource(const Source& source) {
    const Json json = objectOf(under("input.", source));
    if (json.empty()) return nullptr;
    auto input = std::make_shared<InputReport>();
    input->path = valueOf<std::string>(json, "path").value_or("");
    input->kind = choiceOf<InputReport::Kind>(json, "kind", kKinds).value_or(InputReport::Kind::mesh);
    input->format = valueOf<std::string>(json, "format").value_or("");
    input->componentType = valueOf<std::string>(json, "component_type").value_or("");
    input->grid = valueOf<std::string>(json, "grid").value_or("");
    input->dimensions = valueOf<std::array<std::int64_t, 3>>(json, "dimensions");
    input->spacing = valueOf<std::array<double, 3>>(json, "spacing");
    input->range = valueOf<std::array<double, 2>>(json, "range");
    input->iso = valueOf<double>(json, "iso");
    input->label = valueOf<double>(json, "label");
    input->labels = valueOf<std::vector<double>>(json, "labels").value_or(std::vector<double>());
    input->inverted = valueOf<bool>(json, "inverted");
    input->openBorder = valueOf<bool>(json, "open_border");
    input->origin = valueOf<std::array<double, 3>>(json, "origin");
    input->direction = valueOf<std::array<std::array<double, 3>, 3>>(json, "direction");
    input->triangles = valueOf<std::int64_t>(json, "triangles");
    input->volume = valueOf<double>(json, "volume");
    input->parts = valueOf<std::int64_t>(json, "parts");
    input->handles = valueOf<std::int64_t>(json, "handles");
    input->cavities = valueOf<std::int64_t>(json, "cavities");
    input->repairNotes =
        valueOf<std::vector<std::string>>(json, "repair").value_or(std::vector<std::string>());
    input->unit = valueOf<std::string>(json, "unit").value_or("");
    input->space = choiceOf<Space>(json, "space", kSpaces);
    return input;
}

std::optional<FitSummary> fitOfSource(const Source& source) {
    const Json json = objectOf(under("fit.", source));
    const auto method = choiceOf<FitMethod>(json, "method", kFitMethods);
    if (!method) return std::nullopt;
    FitSummary fit;
    fit.method = *method;
    fit.halfWidth = valueOf<double>(json, "half_width").value_or(0);
    fit.band = valueOf<double>(json, "band").value_or(0);
    fit.filterPasses = valueOf<int>(json, "filter_passes").value_or(0);
    fit.gradientPasses = valueOf<int>(json, "gradient_passes").value_or(0);
    fit.latticePoints = valueOf<std::int64_t>(json, "lattice_points").value_or(0);
    fit.disagreeing = valueOf<std::int64_t>(json, "disagreeing").value_or(0);
    fit.repairPasses = valueOf<int>(json, "repair_passes").value_or(0);
    fit.repaired = valueOf<std::int64_t>(json, "repaired").value_or(0);
    fit.repairFloor = valueOf<double>(json, "repair_floor").value_or(0);
    fit.repairAgreed = valueOf<std::string>(json, "stopped").value_or("agreed") == "agreed";
    fit.walls = wallsOf(json);
    return fit;
}

std::optional<Border> borderOf(const InputReport& input) {
    if (!input.openBorder.value_or(false) || !input.dimensions || !input.spacing || !input.direction ||
        !input.origin)
        return std::nullopt;
    openvdb::math::Mat4d indexToWorld = openvdb::math::Mat4d::identity();
    openvdb::Vec3d high;
    for (int axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row)
            indexToWorld(row, axis) = (*input.spacing)[row] * (*input.direction)[row][axis];
        indexToWorld(3, axis) = (*input.origin)[axis];
        high[axis] = static_cast<double>((*input.dimensions)[axis] - 1);
    }
    return Border{indexToWorld.inverse(), openvdb::Vec3d(0), high};
}

}  // namespace isowave::lod
