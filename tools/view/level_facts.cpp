#include "tools/view/level_facts.h"

#include <algorithm>

namespace isowave::tools {
namespace {

double longest(const std::array<double, 3>& spacing) {
    return *std::max_element(spacing.begin(), spacing.end());
}

template <class Value>
void take(const Json& entry, const char* key, std::optional<Value>& value) {
    const auto found = entry.find(key);
    if (found == entry.end()) return;
    if constexpr (std::is_same_v<Value, bool>) {
        if (found->is_boolean()) value = found->template get<bool>();
    } else {
        if (found->is_number()) value = found->template get<Value>();
    }
}

}  // namespace

void putTopology(view::LevelFacts& facts, const MeshTopology& topology) {
    facts.components = topology.components;
    facts.closed = topology.closed() && topology.manifold();
    if (!*facts.closed) return;
    facts.parts = topology.parts;
    facts.handles = topology.genus;
    facts.cavities = topology.cavities;
    facts.volume = topology.volume;
    facts.area = topology.area;
}

view::LevelFacts factsOf(const LevelReport& level, const std::string& name, bool toLevel0) {
    view::LevelFacts facts{.name = name, .step = level.step, .voxel = longest(level.spacing)};
    putTopology(facts, level.topology);
    facts.volumeError = level.volumeError;
    if (!toLevel0) return facts;
    facts.rms = level.rmsToLevel0;
    facts.max = level.maxToLevel0;
    return facts;
}

view::LevelFacts factsOf(const BudgetReport& budget, const std::string& name, bool toLevel0) {
    view::LevelFacts facts{.name = name, .step = budget.step};
    putTopology(facts, budget.topology);
    if (!toLevel0) return facts;
    facts.rms = budget.toLevel0.rms;
    facts.max = budget.toLevel0.max;
    return facts;
}

view::LevelFacts factsOf(const Json& entry, const std::string& name, bool toLevel0) {
    view::LevelFacts facts{.name = name};
    take(entry, "step", facts.step);
    take(entry, "components", facts.components);
    take(entry, "parts", facts.parts);
    take(entry, "genus", facts.handles);
    take(entry, "cavities", facts.cavities);
    take(entry, "volume", facts.volume);
    take(entry, "volume_error", facts.volumeError);
    take(entry, "rings", facts.rings);
    take(entry, "holes", facts.holes);
    take(entry, "area", facts.area);
    std::optional<bool> closed, manifold;
    take(entry, "closed", closed);
    take(entry, "manifold", manifold);
    if (closed) facts.closed = *closed && manifold.value_or(true);
    if (const auto spacing = entry.find("spacing"); spacing != entry.end() && spacing->is_array())
        for (const Json& side : *spacing)
            if (side.is_number()) facts.voxel = std::max(facts.voxel.value_or(0), side.get<double>());
    if (!toLevel0) return facts;
    take(entry, "rms_to_level0", facts.rms);
    take(entry, "max_to_level0", facts.max);
    return facts;
}

}  // namespace isowave::tools
