// The page of what `isowave view` was given: a folder of lod or curves, its report, a pyramid, meshes, curves, or the details of a
// subdivision.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "isowave/ladder.h"
#include "tools/console.h"
#include "view/page.h"

namespace isowave::tools {

// The first input says which kind it is; several are meshes or curves, a row each. Throws InputError for what is none of these
// and for files that a report names and that are not there; UsageError for several inputs that cannot be one page.
std::unique_ptr<view::Page> pageOf(const std::vector<std::filesystem::path>& inputs, Console& console);

// What a page says of the ladder of a solid. name: its title.
view::PageOptions pageOptionsOf(const InputReport& input, const std::string& name);

}  // namespace isowave::tools
