// Options that reverse, rebuild and subdivide share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "isowave/error.h"
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
// Before the work. Throws UsageError for a name that is none of a polygon mesh: of an output that is wrong usage, not bad data.
void requireMeshName(const std::filesystem::path& output);
// What --limit asks for.
inline subdivision::Positions positionsOf(bool limit) {
    return limit ? subdivision::Positions::limit : subdivision::Positions::control;
}
// Throws UsageError for an angle with a scheme that has no creases.
void refuseCrease(const std::optional<double>& angle, std::string_view scheme);

// get() for an option's value: what it complains of is wrong usage.
template <class Get>
auto asked(const std::string& option, const Get& get) -> decltype(get()) {
    try {
        return get();
    } catch (const InputError& error) {
        throw UsageError(option + ": " + error.what());
    }
}

}  // namespace isowave::tools
