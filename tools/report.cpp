#include "tools/report.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "isowave/error.h"

namespace isowave::tools {

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json triple(const openvdb::Vec3d& v) { return Json::array({finite(v.x()), finite(v.y()), finite(v.z())}); }

// ---- StageClock ----

StageClock::StageClock() : start_(std::chrono::steady_clock::now()), last_(start_) {}

void StageClock::charge(Time now) {
    if (!open_.empty()) stages_[open_.back()].second += std::chrono::duration<double>(now - last_).count();
    last_ = now;
}

StageClock::Scope::Scope(StageClock& clock, std::string stage) : clock_(clock) {
    clock.charge(std::chrono::steady_clock::now());
    auto& stages = clock.stages_;
    auto found = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.first == stage; });
    if (found == stages.end()) found = stages.insert(stages.end(), {std::move(stage), 0.0});
    clock.open_.push_back(static_cast<std::size_t>(found - stages.begin()));
}

StageClock::Scope::~Scope() {
    clock_.charge(std::chrono::steady_clock::now());
    clock_.open_.pop_back();
}

double StageClock::secondsSoFar() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

Json StageClock::seconds() const {
    Json json = Json::object();
    for (const auto& [stage, seconds] : stages_) json[stage] = seconds;
    json["total"] = secondsSoFar();
    return json;
}

std::int64_t peakMemoryBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{usage.ru_maxrss} * 1024;  // Linux counts kilobytes
}

// ---- JSON ----

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

std::string textOf(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeWhole(AtomicFile& file, const std::string& text) {
    try {
        file.stream() << text << std::flush;
    } catch (const std::ios_base::failure&) {
        throw OperationError(file.place().string(),
                             std::string("writing failed (") + std::strerror(errno) + "); is the disk full?");
    }
}

void writeJson(AtomicFile& file, const Json& json) { writeWhole(file, textOf(json)); }

// ---- text ----

std::string Table::text() const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (const auto& row : rows_) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i)
            line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i])
                           : fmt::format("  {:>{}}", row[i], widths[i]);
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

std::string grouped(std::int64_t value) {
    std::string digits = std::to_string(value);
    const std::size_t first = digits.front() == '-' ? 1 : 0;
    for (std::size_t i = digits.size(); i > first + 3; i -= 3) digits.insert(i - 3, ",");
    return digits;
}

std::string counted(std::int64_t value, std::string_view one, std::string_view many) {
    if (value == 1) return fmt::format("1 {}", one);
    return many.empty() ? fmt::format("{} {}s", grouped(value), one)
                        : fmt::format("{} {}", grouped(value), many);
}

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "-";
    if (std::abs(value) >= 1000 && std::abs(value) < 1e15) return grouped(std::llround(value));
    return fmt::format("{:.4g}", value);
}

std::string bytesText(double bytes) {
    for (const char* unit : {"B", "kB", "MB", "GB"}) {
        if (bytes < 1000) return fmt::format("{:.3g} {}", bytes, unit);
        bytes /= 1000;
    }
    return fmt::format("{:.4g} TB", bytes);
}

}  // namespace isowave::tools
