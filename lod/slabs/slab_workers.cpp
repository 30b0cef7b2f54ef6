#include "lod/slabs/slab_workers.h"

namespace isowave::lod {

std::vector<SlabFitted> SlabsInTurn::fit(const SlabFitPlan& plan, int passes, const Progress& progress) {
    std::vector<SlabFitted> told;
    for (int slab = 0; slab < plan.cuts.count(); ++slab) {
        if (!told.empty() && (needsMorePasses(told.back(), plan, passes) || told.back().bytesLacking > 0))
            break;
        progress("fitting", double(slab) / plan.cuts.count());
        told.push_back(fitSlab(store_, *stream_, plan, slab, passes, progress));
    }
    return told;
}

std::vector<SlabHalved> SlabsInTurn::halve(const SlabHalving& halving, const Progress& progress) {
    std::vector<SlabHalved> told;
    for (int slab = 0; slab < halving.phase.slabs(); ++slab) {
        progress("analysing", double(slab) / halving.phase.slabs());
        told.push_back(halveSlab(store_, halving, slab, progress));
    }
    return told;
}

std::vector<SlabFitted> SlabsByMap::fit(const SlabFitPlan& plan, int passes, const Progress& progress) {
    progress("fitting", 0);
    if (begun_.empty()) begun_ = jobText(job_, plan);
    SlabStore(job_.folder).begin(begun_);
    std::vector<std::string> tasks;
    for (int slab = 0; slab < plan.cuts.count(); ++slab) tasks.push_back(fitTask(job_, plan, slab, passes));
    return fittedOf(map_(tasks, progress), tasks.size());
}

std::vector<SlabHalved> SlabsByMap::halve(const SlabHalving& halving, const Progress& progress) {
    progress("analysing", 0);
    std::vector<std::string> tasks;
    for (int slab = 0; slab < halving.phase.slabs(); ++slab) tasks.push_back(halveTask(job_, halving, slab));
    return halvedOf(map_(tasks, progress), tasks.size());
}

}  // namespace isowave::lod
