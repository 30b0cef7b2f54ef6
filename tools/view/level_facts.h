// What stands in a row of the page's table, out of what the library or a report says of a level.
#pragma once

#include <string>

#include "isowave/ladder.h"
#include "tools/report/json.h"
#include "view/page.h"

namespace isowave::tools {

// Handles only of meshes that are closed and 2-manifold; parts and cavities likewise.
void putTopology(view::LevelFacts& facts, const MeshTopology& topology);

// toLevel0: the report's distances are to the first level of the page.
view::LevelFacts factsOf(const LevelReport& level, const std::string& name, bool toLevel0);
view::LevelFacts factsOf(const BudgetReport& budget, const std::string& name, bool toLevel0);

// The same of an entry of report.json (docs/interfaces.md): one of `levels`, `budgets`, or of the `steps` of curves. Keys that are
// missing or null stay empty.
view::LevelFacts factsOf(const Json& entry, const std::string& name, bool toLevel0);

}  // namespace isowave::tools
