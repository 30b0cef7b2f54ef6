#include "view/page.h"

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "isowave/error.h"
#include "isowave/version.h"
#include "view/embedded.h"
#include "view/mesh_packing.h"

namespace isowave::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRingSteps = 1 << 24;

template <class Value>
void put(Json& json, const char* key, const std::optional<Value>& value) {
    if (value) json[key] = *value;
}

Json rowOf(const LevelFacts& facts) {
    Json row;
    row["name"] = facts.name;
    row["file"] = facts.file;
    put(row, "step", facts.step);
    put(row, "voxel", facts.voxel);
    put(row, "faces", facts.faces);
    put(row, "triangles", facts.triangles);
    put(row, "vertices", facts.vertices);
    put(row, "rings", facts.rings);
    put(row, "holes", facts.holes);
    put(row, "points", facts.points);
    put(row, "components", facts.components);
    put(row, "parts", facts.parts);
    put(row, "handles", facts.handles);
    put(row, "cavities", facts.cavities);
    put(row, "closed", facts.closed);
    put(row, "volume", facts.volume);
    put(row, "area", facts.area);
    put(row, "volumeError", facts.volumeError);
    put(row, "rms", facts.rms);
    put(row, "max", facts.max);
    return row;
}

// In a <script>, where "</script" and "<!--" would have a meaning.
std::string scriptText(const Json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
        c == '<' ? text += "\\u003c" : text += c;
    return text;
}

// The template with each {{name}} replaced.
std::string filled(std::string_view text, const std::vector<std::pair<std::string, std::string>>& values) {
    std::string result;
    while (true) {
        const auto open = text.find("{{"), close = text.find("}}", open);
        if (open == text.npos || close == text.npos) return result.append(text);
        result.append(text.substr(0, open));
        const std::string_view name = text.substr(open + 2, close - open - 2);
        for (const auto& [key, value] : values)
            if (key == name) result += value;
        text.remove_prefix(close + 2);
    }
}

std::string blockOf(const std::string& id, const Bytes& bytes) {
    return "<script type=\"application/octet-stream\" id=\"" + id + "\">" + base64(deflated(bytes)) +
           "</script>\n";
}

}  // namespace

PackedRings packedRings(const Rings& rings) {
    PackedRings result;
    curves2d::Box box;
    for (const auto& ring : rings)
        for (const curves2d::Point& p : ring) box.take(p);
    if (box.empty()) return result;
    result.low = box.low;
    result.high = box.high;
    const double longest = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
    result.step = longest > 0 ? longest / kRingSteps : 1;
    result.rings = static_cast<std::int64_t>(rings.size());
    for (const auto& ring : rings) putVarint(result.bytes, ring.size());
    std::int64_t x = 0, y = 0;
    for (const auto& ring : rings)
        for (const curves2d::Point& p : ring) {
            const std::int64_t atX = std::llround((p.x - result.low.x) / result.step);
            const std::int64_t atY = std::llround((p.y - result.low.y) / result.step);
            putVarint(result.bytes, zigzag(atX - x));
            putVarint(result.bytes, zigzag(atY - y));
            x = atX, y = atY;
            ++result.points;
        }
    return result;
}

struct Page::State {
    PageOptions options;
    Json levels = Json::array();
    std::string blocks;  // of the html
    std::optional<SurfaceDistance> surface;
    std::optional<CurveDistance> curve;
    TriangleMesh referenceMesh;  // level 0, until a distance to it is asked for
    Rings referenceRings;
    bool planar = false;
    double largestStep = 0;

    std::string nextId(const char* kind) const { return kind + std::to_string(levels.size()); }

    // A report that was made from these very surfaces has the better digits.
    void putDistance(Json& level, const DistanceSummary& summary, const std::vector<std::uint32_t>& order) {
        Json& row = level["facts"];
        if (!row.contains("rms")) row["rms"] = summary.rms;
        if (!row.contains("max")) row["max"] = summary.max;
        level["distance"] = {{"max", summary.max}, {"rms", summary.rms}, {"histogram", summary.histogram}};
        blocks += blockOf(nextId("distance"), packedValues(summary.ofVertex, order, summary.max));
    }
};

bool canMakePages() { return !embedded::three.empty(); }

void requirePages() {
    if (!canMakePages())
        throw OperationError(
            "view",
            "this isowave was built where three.js was not installed, and writes no pages; install Debian's "
            "libjs-three (scripts/setup does) and build again");
}

Page::Page(PageOptions options) : state_(std::make_unique<State>()) {
    assert(canMakePages());
    state_->options = std::move(options);
}
Page::~Page() = default;

void Page::add(LevelFacts facts, const TriangleMesh& mesh, const Progress& progress) {
    State& s = *state_;
    const PackedMesh mine = packed(mesh);
    facts.vertices = mine.vertices;
    facts.triangles = mine.triangles;
    Json level;
    level["facts"] = rowOf(facts);
    level["vertices"] = mine.vertices;
    level["triangles"] = mine.triangles;
    level["low"] = mine.low;
    level["high"] = mine.high;
    level["step"] = mine.step;
    s.blocks += blockOf(s.nextId("mesh"), mine.bytes);
    s.largestStep = std::max(s.largestStep, mine.step);
    if (s.levels.empty()) {
        s.referenceMesh = {mesh.points, mesh.triangles, {}};
    } else {
        if (!s.surface) s.surface.emplace(std::exchange(s.referenceMesh, {}));
        s.putDistance(level, s.surface->of(mesh, progress), mine.order);
    }
    s.levels.push_back(std::move(level));
}

void Page::add(LevelFacts facts, const Rings& rings) {
    State& s = *state_;
    s.planar = true;
    const PackedRings mine = packedRings(rings);
    facts.points = mine.points;
    Json level;
    level["facts"] = rowOf(facts);
    level["rings"] = mine.rings;
    level["points"] = mine.points;
    level["low"] = {mine.low.x, mine.low.y};
    level["high"] = {mine.high.x, mine.high.y};
    level["step"] = mine.step;
    s.blocks += blockOf(s.nextId("rings"), mine.bytes);
    s.largestStep = std::max(s.largestStep, mine.step);
    if (s.levels.empty()) {
        s.referenceRings = rings;
    } else {
        if (!s.curve) s.curve.emplace(std::exchange(s.referenceRings, {}));
        std::vector<std::uint32_t> order(static_cast<std::size_t>(mine.points));
        std::iota(order.begin(), order.end(), 0u);
        s.putDistance(level, s.curve->of(rings), order);
    }
    s.levels.push_back(std::move(level));
}

std::size_t Page::levelCount() const { return state_->levels.size(); }

double Page::largestRounding() const { return state_->largestStep / 2; }

std::string Page::html() const {
    const State& s = *state_;
    const Json document = {{"title", s.options.title},
                           {"unit", s.options.unit},
                           {"planar", s.planar},
                           {"anatomical", s.options.anatomical},
                           {"yUp", s.options.yUp},
                           {"notes", s.options.notes},
                           {"rounding", largestRounding()},
                           {"program", "isowave " ISOWAVE_VERSION},
                           {"levels", s.levels}};
    return filled(embedded::page, {{"style", std::string(embedded::style)},
                                   {"document", scriptText(document)},
                                   {"blocks", s.blocks},
                                   {"three", s.planar ? std::string() : std::string(embedded::three)},
                                   {"scripts", std::string(embedded::scripts)}});
}

}  // namespace isowave::view
