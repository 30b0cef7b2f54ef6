#include "python/native/options.h"

#include <algorithm>

#include "isowave/error.h"
#include "tools/solids/solid_options.h"

namespace isowave::python {
namespace {

void declare(tools::OptionList& options, SolidOptions& solid, LevelOptions& levels, BudgetOptions& budgets) {
    tools::declareLevels(options, levels);
    tools::declareMesh(options, levels, /*features=*/true);
    tools::declareRegions(options, levels);
    tools::declareBudgets(options, budgets, levels);
    tools::declareSolid(options, solid);
    tools::declareMaxMemory(options, solid);
    tools::declareSlabs(options, solid);
}

}  // namespace

void take(const GivenOptions& given, const tools::OptionList& options) {
    for (const auto& [name, value] : given) {
        const auto& all = options.all();
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const tools::Option& o) { return o.longName() == name; });
        if (found == all.end()) throw UsageError(name + ": there is no such option here");
        try {
            found->apply(value);
        } catch (const UsageError& error) {
            throw UsageError(name + ": " + error.what());
        }
    }
}

SolidChoices::SolidChoices(const GivenOptions& given) {
    tools::OptionList options;
    declare(options, solid, levels, budgets);
    options.flag("--field-only", "no levels will be made (isowave.analyse, field)", solid.fieldOnly);
    take(given, options);
    if (budgets.any()) budgets.maxGenus = levels.maxGenus;
}

std::vector<std::string> namesOf(const tools::OptionList& options) {
    std::vector<std::string> names;
    for (const tools::Option& option : options.all()) names.emplace_back(option.longName());
    return names;
}

std::vector<std::string> solidOptionNames() {
    SolidOptions solid;
    LevelOptions levels;
    BudgetOptions budgets;
    tools::OptionList options;
    declare(options, solid, levels, budgets);
    return namesOf(options);
}

}  // namespace isowave::python
