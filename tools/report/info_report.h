// What `isowave info` tells of each kind of file.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "isowave/ladder.h"
#include "isowave/measure.h"
#include "isowave/pyramid.h"
#include "tools/report/json.h"
#include "volume/image_statistics.h"

namespace isowave::tools {

struct ImageInfo {
    std::string path;
    Image header;
    ImageStatistics statistics;
};
std::string jsonOf(const ImageInfo& info);
std::string textOf(const ImageInfo& info);

struct MeshInfo {
    std::string path, format;
    Space space = Space::unspecified;  // that the file names; what it holds is shown in LPS, as it is read
    MeshTopology topology;
    Point low{}, high{};
};
std::string jsonOf(const MeshInfo& info);
std::string textOf(const MeshInfo& info);

struct VdbInfo {
    using Metadata = std::vector<std::pair<std::string, std::string>>;
    struct Grid {
        std::string name, type, gridClass;
        std::int64_t activeVoxels = 0;
        std::array<std::int64_t, 3> dimensions{};
        std::array<double, 3> spacing{};
        Metadata metadata;
    };
    std::string path;
    Metadata metadata;
    std::vector<Grid> grids;
};
std::string jsonOf(const VdbInfo& info);
std::string textOf(const VdbInfo& info);

struct PyramidInfo {
    std::string path;
    bool packed = false;  // .iwz: its steps were computed again
    int formatVersion = 1;
    double K = 1;
    std::map<std::string, std::string> source;
    std::int64_t coefficientsStored = 0, controlPoints = 0, memoryBytes = 0, fileBytes = 0;
    StepOrder order;
    std::vector<StepFacts> steps;
    std::vector<LevelReport> levels;
};
Json stepsJson(const std::vector<StepFacts>& steps);
std::string jsonOf(const PyramidInfo& info);
std::string textOf(const PyramidInfo& info);

}  // namespace isowave::tools
