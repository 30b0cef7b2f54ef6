// Options that reverse, rebuild and subdivide share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "isowave/error.h"
#include "subdivision/meshes/mesh_scheme.h"
#include "tools/command.h"

namespace isowave::tools {

void declareDepth(OptionList& options, std::string_view fallback, std::string_view help, int& depth);
void declareScheme(OptionList& options, std::string& scheme);
void declareCrease(OptionList& options, std::optional<double>& angle);  // degrees
// Throws UsageError for an angle with a scheme that has no creases.
void refuseCrease(const std::optional<double>& angle, std::string_view scheme);

// Throws UsageError for a name that there is none of: it is not the file's fault.
const subdivision::MeshScheme& meshSchemeAsked(const std::string& scheme);
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
