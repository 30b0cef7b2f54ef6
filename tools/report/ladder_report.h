// What `isowave lod` tells: report.json, and the table and the lines on standard output. Functions of the ladder alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isowave/ladder.h"
#include "tools/report/mesh_json.h"

namespace isowave::tools {

// What the files of the meshes are called, one for each of ladder.levels and ladder.budgets; "" where there is none.
struct LadderFiles {
    std::vector<std::string> levels, budgets;
    std::string lods = {};                   // the file of --glb-lods
    std::string view = {};                   // the page of --view
    std::string tiles = {};                  // the folder of --tiles
    std::optional<double> colourRange = {};  // of --colour distance
};

// The bytes of report.json.
std::string jsonOf(const Ladder& ladder, const LadderFiles& files = {});

// The table and the lines. unit: " [mm]" or "".
std::string textOf(const Ladder& ladder, const LadderFiles& files, const std::string& unit);

// What `info` has of a level, by the same keys: step, level, spacing, topology, refine ... features, change, sampling.
Json storyJson(const LevelReport& level);

}  // namespace isowave::tools
