#include "io/mesh/soup.h"

#include <array>

namespace isowave {

std::string PolygonSoup::droppedNote() const {
    constexpr std::array kNames{"colours",         "texture coordinates",     "normals",    "materials",
                                "groups",          "lines and single points", "animations", "morph targets",
                                "other properties"};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (dropped >> i & 1) names.emplace_back(kNames[i]);
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
    return text.empty() ? text : text + " are not kept";
}

}  // namespace isowave
