#include "tools/subdivision/mesh_options.h"

#include "subdivision/meshes/mesh_files.h"
#include "tools/console.h"
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

subdivision::PolygonMesh readAndRemark(const std::filesystem::path& path, Console& console) {
    std::vector<std::string> remarks;
    subdivision::PolygonMesh mesh = subdivision::readPolygonMesh(path, &remarks);
    for (const std::string& remark : remarks) console.say(remark);
    return mesh;
}

const subdivision::MeshScheme& schemeWanted(const std::string& name) {
    return asked("--scheme",
                 [&]() -> const subdivision::MeshScheme& { return subdivision::meshScheme(name); });
}

std::string_view variantWanted(const subdivision::MeshScheme& scheme, const std::string& name) {
    return asked("--variant", [&] { return subdivision::meshVariant(scheme, name); });
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

void requireMeshName(const std::filesystem::path& output) {
    asked("-o", [&] { return subdivision::polygonFormatOf(output); });
}

}  // namespace isowave::tools
