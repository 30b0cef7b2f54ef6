#include "tools/subdivision/mesh_options.h"

#include "subdivision/meshes/mesh_schemes.h"
#include "tools/option_values.h"

namespace isowave::tools {
namespace {

constexpr int kMostSubdivisions = 15;  // a quad becomes 2^30

}  // namespace

void declareDepth(OptionList& options, std::string_view fallback, std::string_view help, int& depth) {
    options.value("--depth", "N", fallback, help,
                  [&](const std::string& v) { depth = static_cast<int>(integer(v, 0, kMostSubdivisions)); });
}

void declareScheme(OptionList& options, std::string& scheme) {
    options.value("--scheme", "NAME", "catmull-clark", "catmull-clark, loop or butterfly",
                  [&](const std::string& v) { scheme = v; });
}

void declareCrease(OptionList& options, std::optional<double>& angle) {
    options.value("--crease", "ANGLE", "",
                  "edges that fold by more than ANGLE degrees are creases too (catmull-clark)",
                  [&](const std::string& v) {
                      angle = number(v);
                      if (*angle < 0 || *angle > 180)
                          throw UsageError("'" + v + "' is not between 0 and 180");
                  });
}

void refuseCrease(const std::optional<double>& angle, std::string_view scheme) {
    if (angle && scheme != "catmull-clark")
        throw UsageError("--crease: belongs to --scheme catmull-clark; " + std::string(scheme) +
                         " has no creases");
}

const subdivision::MeshScheme& meshSchemeAsked(const std::string& scheme) {
    return asked("--scheme",
                 [&]() -> const subdivision::MeshScheme& { return subdivision::meshScheme(scheme); });
}

}  // namespace isowave::tools
