#include "lod/regions/level_regions.h"

#include <algorithm>

namespace isowave::lod {
namespace {

void addAll(RegionsByStep& all, const RegionsByStep& more) {
    for (const auto& [step, regions] : more)
        all[step].insert(all[step].end(), regions.begin(), regions.end());
}

}  // namespace

LevelRegions::LevelRegions(const LevelOptions& options, const StepOrder& order, const Progress& progress)
    : keptSteps_(stepsOf(options.fine, order)),
      order_(order),
      fine_(options.fine, order, progress),
      levels_(order) {
    if (options.adaptive) adaptive_.emplace(*options.adaptive, order);
}

bool LevelRegions::keeps(int step) const {
    return step == 0 || (adaptive_ && order_.levelOf(step)) ||
           std::binary_search(keptSteps_.begin(), keptSteps_.end(), step);
}

void LevelRegions::see(const DrawnLevel& level, const TriangleMesh& mesh, const Progress& progress) {
    if (level.step == 0 && !mesh.triangles.empty()) fine_.requireWithin(boxAround(mesh));
    const bool isKept = fine_.place(level.step, level.field.transform(), progress);
    if (adaptive_ && order_.levelOf(level.step)) adaptive_->see(level, mesh, progress);
    if (isKept || adaptive_) levels_.remember(level);
}

LevelRegions::Choice LevelRegions::choiceFor(const DrawnLevel& own) const {
    Choice choice;
    choice.asked = fine_.regionsFor(own.step, own.field.transform());
    if (adaptive_) choice.kept = adaptive_->keptFor(own.step);
    return choice;
}

std::optional<RegionBlend> LevelRegions::blended(const DrawnLevel& own, const Choice& choice,
                                                 const Progress& progress) const {
    RegionsByStep regions = choice.asked;
    if (adaptive_) addAll(regions, adaptive_->regionsOf(choice.kept));
    return levels_.blended(own, regions, progress);
}

bool LevelRegions::widen(Choice& choice, const TriangleMesh& mesh, const Progress& progress) const {
    return adaptive_ && adaptive_->widen(choice.kept, mesh, choice.summary, progress);
}

}  // namespace isowave::lod
