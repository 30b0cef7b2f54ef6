// Options that reverse, rebuild and subdivide share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subdivision/meshes/hierarchy.h"
#include "tools/command.h"

namespace isowave::tools {

void declareDepth(OptionList& options, std::string_view fallback, std::string_view help, int& depth);
void declareScheme(OptionList& options, std::string& scheme);
// A mesh file; what of it is not kept becomes a remark.
subdivision::PolygonMesh readAndRemark(const std::filesystem::path& path, Console& console);

// The scheme or the variant of that name. Throws UsageError that names the option and what there is.
const subdivision::MeshScheme& schemeWanted(const std::string& name);
std::string_view variantWanted(const subdivision::MeshScheme& scheme, const std::string& name);
void declareCrease(OptionList& options, std::optional<double>& angle);  // degrees

}  // namespace isowave::tools
