// A level's field -> the same with no more parts, handles and cavities than were asked for.
#pragma once

#include <optional>
#include <string>

#include "hold/solid_limits.h"
#include "isowave/ladder.h"
#include "volume/field.h"

namespace isowave {

// What the options allow, and no more of anything than `before` has, where that is given: the level before, which a
// coarser one must not exceed.
SolidLimits limitsOf(const LevelOptions& options, const std::optional<SolidCounts>& before = {});

// limitTopology() (hold/cut_or_fill.h) at F = 0; puts the edits into the report. The field is the level's own copy: the pyramid stays as
// it is. The report has the counts of the level's mesh as it is. -> why limits are missed; empty where they are met.
std::string limitLevel(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                       LevelReport& report, const Progress& progress);

// "level 2"; "step 7" where that is none.
std::string nameOf(const LevelReport& report);

// Puts into the report, and says, why the level has more than it may.
void missLimits(LevelReport& report, const std::string& why, const Progress& progress);

}  // namespace isowave
