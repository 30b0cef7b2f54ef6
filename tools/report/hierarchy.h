// What `isowave reverse`, `rebuild` and `subdivide` say, as text and as JSON (docs/interfaces.md).
#pragma once

#include <cstddef>
#include <string>

#include "isowave/subdivision.h"
#include "tools/report/json.h"

namespace isowave::tools {

std::string textOf(const subdivision::DecompositionReport& report);
std::string jsonOf(const subdivision::DecompositionReport& report);

std::string textOf(const subdivision::RebuildReport& report);
std::string jsonOf(const subdivision::RebuildReport& report);

// Of curves and of heights.
std::string textOf(const subdivision::LevelsRebuildReport& report);
std::string jsonOf(const subdivision::LevelsRebuildReport& report);

struct SubdivisionReport {
    std::string scheme;
    int levels = 0;
    std::size_t creases = 0;              // of the mesh that was subdivided
    std::size_t vertices = 0, faces = 0;  // of the result
    subdivision::Positions positions = subdivision::Positions::control;
};
std::string textOf(const SubdivisionReport& report);
std::string jsonOf(const SubdivisionReport& report);

}  // namespace isowave::tools
