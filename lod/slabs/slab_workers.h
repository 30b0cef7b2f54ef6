// Who runs the tasks of a job in slabs: this process, one after the other, or whoever takes them as texts.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lod/slabs/slab_fit.h"
#include "lod/slabs/slab_steps.h"
#include "lod/slabs/slab_task.h"

namespace isowave::lod {

class SlabWorkers {
  public:
    virtual ~SlabWorkers() = default;
    // Of the repair, what to try first. Seen: 1 to 4 for smooth images, 5 to 12 for CT, 20 for white noise.
    virtual int firstPasses() const = 0;
    // All slabs: the parts lie in the store, what is told comes back, in order. May end with the first that needs more passes or memory.
    virtual std::vector<SlabFitted> fit(const SlabFitPlan& plan, int passes, const Progress& progress) = 0;
    virtual std::vector<SlabHalved> halve(const SlabHalving& halving, const Progress& progress) = 0;
    // The image is not needed any more.
    virtual void endFit() {}
};

// One after the other, each by all threads.
class SlabsInTurn : public SlabWorkers {
  public:
    SlabsInTurn(ImageStream stream, const SlabStore& store) : stream_(std::move(stream)), store_(store) {}
    int firstPasses() const override { return 4; }
    std::vector<SlabFitted> fit(const SlabFitPlan& plan, int passes, const Progress& progress) override;
    std::vector<SlabHalved> halve(const SlabHalving& halving, const Progress& progress) override;
    void endFit() override { stream_.reset(); }

  private:
    std::optional<ImageStream> stream_;
    const SlabStore& store_;
};

// Somebody else's, who gives what runSlabTask() (slab_task.h) returns for each text, in order.
using SlabMap =
    std::function<std::vector<std::string>(const std::vector<std::string>& tasks, const Progress& progress)>;
class SlabsByMap : public SlabWorkers {
  public:
    SlabsByMap(SlabMap map, SlabJob job) : map_(std::move(map)), job_(std::move(job)) {}
    // All slabs are fitted at once, and again where one of them needs more.
    int firstPasses() const override { return 16; }
    std::vector<SlabFitted> fit(const SlabFitPlan& plan, int passes, const Progress& progress) override;
    std::vector<SlabHalved> halve(const SlabHalving& halving, const Progress& progress) override;

  private:
    SlabMap map_;
    SlabJob job_;
    std::string begun_;  // jobText() of the first plan: others follow from it
};

}  // namespace isowave::lod
