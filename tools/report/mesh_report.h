// What `isowave check` and `isowave compare` tell.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "isowave/measure.h"

namespace isowave::tools {

struct CheckReport {
    std::string path, format;
    MeshTopology topology;
    std::optional<std::int64_t> selfIntersections;  // pairs of triangles, where they were counted
};
std::string jsonOf(const CheckReport& check);
std::string textOf(const CheckReport& check);

struct CompareReport {
    std::string pathA, pathB;
    double sampling = 0;  // world units between samples
    MeshComparison comparison;
};
std::string jsonOf(const CompareReport& compare);
std::string textOf(const CompareReport& compare);

}  // namespace isowave::tools
