// What a job did, as JSON and as text: stage times, memory, aligned tables.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "polygonize/topology.h"
#include "volume/field.h"

namespace isowave::tools {

// Keys keep the order in which they were put in.
using Json = nlohmann::ordered_json;

// null when not finite: JSON knows no infinity.
Json finite(double value);
Json triple(const openvdb::Vec3d& v);

// Seconds by stage, in order of first use.
class StageClock {
  public:
    StageClock();

    // Time from construction to destruction goes to a stage; a nested one stops the outer one's clock, so the
    // sum of all stages never exceeds the total.
    class Scope {
      public:
        Scope(StageClock& clock, std::string stage);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

      private:
        StageClock& clock_;
    };

    double secondsSoFar() const;
    // {"read": 0.1, ..., "total": 1.2}
    Json seconds() const;

  private:
    using Time = std::chrono::steady_clock::time_point;
    void charge(Time now);  // to the innermost stage

    Time start_, last_;
    std::vector<std::pair<std::string, double>> stages_;
    std::vector<std::size_t> open_;  // indices into stages_, outermost first
};

// Largest resident set of this process so far.
std::int64_t peakMemoryBytes();

// vertices, triangles, components, genus, closed, manifold, volume, area: the keys that lod and check share.
// genus is null where it has no meaning (open or not manifold).
void putTopology(Json& json, const MeshTopology& topology);

// Indented, one trailing newline; file names that are not UTF-8 get replacement characters.
std::string textOf(const Json& json);

// Into an open file, all of it: a full disk is found here. commit() is the caller's. Throws OperationError.
void writeWhole(AtomicFile& file, const std::string& text);
void writeJson(AtomicFile& file, const Json& json);

// Columns aligned to the right, the first one to the left; headers carry the units.
class Table {
  public:
    explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
    void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
    std::string text() const;

  private:
    std::vector<std::vector<std::string>> rows_;
};

// 1234567 -> "1,234,567"
std::string grouped(std::int64_t value);
// "1 triangle", "1,234 triangles"; many: the plural where it is not one + "s" ("vertices").
std::string counted(std::int64_t value, std::string_view one, std::string_view many = {});
// Four significant digits; thousands grouped.
std::string shortNumber(double value);
// "1.2 GB"
std::string bytesText(double bytes);

}  // namespace isowave::tools
