// Options of the command, as Python gives them: by the same names, taken by the same table.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "isowave/ladder.h"
#include "isowave/solid.h"
#include "tools/command.h"

namespace isowave::python {

// {"--iso", "300"}, {"--invert", ""}: an option and its value, as a command line has them.
using GivenOptions = std::vector<std::pair<std::string, std::string>>;

// Throws UsageError as the command does: "--iso: 'x' is not a number".
void take(const GivenOptions& given, const tools::OptionList& options);

// All options of lod, analyse, mesh and field that say what is made.
struct SolidChoices {
    SolidOptions solid;
    LevelOptions levels;
    BudgetOptions budgets;

    explicit SolidChoices(const GivenOptions& given);
};

// "--iso", ...: in the order of the help.
std::vector<std::string> namesOf(const tools::OptionList& options);

// The names of these choices.
std::vector<std::string> solidOptionNames();

}  // namespace isowave::python
