// --dry-run of lod and analyse: what the job would take, in words.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lod/dry_run/dry_run.h"
#include "tools/console.h"

namespace isowave::tools {

// Four lines: what is read, memory, levels, walls.
std::string textOf(const lod::DryRun& run, const std::string& name);

// Prints that for every input; of several, one that fails does not stop the others. Returns the exit code. Throws what
// lod::dryRun() throws where there is one input.
int tellDryRuns(const std::vector<std::filesystem::path>& inputs, const SolidOptions& options,
                Console& console);

}  // namespace isowave::tools
