#include "simplify/budget_chooser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "isowave/error.h"
#include "isowave/ladder.h"
#include "simplify/collapse.h"

namespace isowave {
namespace {

// A step is decimated to a quarter, a quarter of that and so on, as long as this many times the triangles
// wanted are left; Collapse starts there.
constexpr std::int64_t kDecimated = 4;

// For a number of triangles: Collapse::Options::errorFloor, as shares of the distance that decimate() ends
// with. The one that ends nearest wins.
constexpr std::array<double, 3> kErrorFloors{0.6, 0.42, 0.3};

// A step that is itself so many times as far from level 0 as the best mesh so far is not collapsed.
constexpr double kHopeless = 2;

std::string limitsText(const TopologyLimits& limits) {
    std::string text;
    if (limits.maxGenus) text += fmt::format("genus at most {}", *limits.maxGenus);
    if (limits.minComponent)
        text +=
            fmt::format("{}components of at least {:.4g}", text.empty() ? "" : " and ", *limits.minComponent);
    return text;
}

}  // namespace

bool TopologyLimits::allow(const MeshTopology& topology) const {
    if (maxGenus && topology.genus > *maxGenus) return false;
    return !minComponent || std::all_of(topology.each.begin(), topology.each.end(),
                                        [&](const auto& c) { return std::abs(c.volume) >= *minComponent; });
}

BudgetChooser::BudgetChooser(std::vector<StepMesh> steps, const TopologyLimits& limits, std::string name)
    : steps_(std::move(steps)), name_(std::move(name)), original_(steps_.front().mesh) {
    assert(steps_.front().step == 0);
    for (const StepMesh& step : steps_)
        if (limits.allow(step.topology)) allowed_.push_back(&step);
    if (allowed_.empty())
        throw InputError(name_, "no step has " + limitsText(limits) + "; loosen the limits");
    const auto pieces = [](const StepMesh& s) { return s.topology.components + s.topology.genus; };
    std::int64_t fewest = std::numeric_limits<std::int64_t>::max();
    for (const StepMesh* step : allowed_) {
        if (step != allowed_.front() && (!step->isLevel || pieces(*step) >= fewest)) continue;
        fewest = pieces(*step);
        chains_.emplace_back(*step, original_, steps_.front().voxel);
    }
}

// ---- a number of triangles

struct BudgetChooser::Trial {
    const StepMesh* from;
    TriangleMesh mesh;
    double distance;  // to level 0, from samples
};

const TriangleMesh& BudgetChooser::decimated(const StepMesh& from, int times, const Progress& progress) {
    if (times == 0) return from.mesh;
    const std::pair key{from.step, times};
    if (const auto found = decimated_.find(key); found != decimated_.end()) return found->second;
    const TriangleMesh& before = decimated(from, times - 1, progress);
    return decimated_[key] =
               decimate(before, static_cast<std::int64_t>(before.triangles.size()) / 4, progress);
}

BudgetChooser::Trial BudgetChooser::collapsed(const StepMesh& from, std::int64_t triangles,
                                              const Progress& progress) {
    if (from.topology.triangles <= triangles)
        return {&from, from.mesh, original_.roughDistance(from.mesh, progress)};
    int times = 0;
    for (std::int64_t left = from.topology.triangles / 4; left >= kDecimated * triangles; left /= 4) ++times;
    const TriangleMesh& start = decimated(from, times, progress);
    // How far a collapse gets that does not measure distances; one that does gets nearer.
    const double rough = original_.target.distanceFrom(decimate(start, triangles, progress), 0, progress).max;
    std::optional<Trial> best;
    for (const double share : kErrorFloors) {
        Collapse collapse(start, original_.mesh, original_.target, {from.voxel, share * rough}, progress);
        collapse.reduce(triangles, std::numeric_limits<double>::infinity(), progress);
        Trial trial{&from, collapse.mesh(), 0};
        trial.distance = original_.roughDistance(trial.mesh, progress);
        const auto rank = [&](const Trial& t) {
            return std::pair(static_cast<std::int64_t>(t.mesh.triangles.size()) > triangles, t.distance);
        };
        if (!best || rank(trial) < rank(*best)) best = std::move(trial);
    }
    return *std::move(best);
}

// The finest step, the finest one of few triangles more than wanted, and the coarsest one that has as many.
std::vector<const StepMesh*> BudgetChooser::firstTries(std::int64_t triangles) const {
    std::vector<const StepMesh*> tries{allowed_.front()};
    const auto tryToo = [&](const StepMesh* step) {
        if (std::find(tries.begin(), tries.end(), step) == tries.end()) tries.push_back(step);
    };
    const StepMesh *few = nullptr, *coarsest = nullptr;
    for (const StepMesh* step : allowed_) {
        if (step->topology.triangles < triangles) continue;
        if (!few && step->topology.triangles <= kDecimated * triangles) few = step;
        coarsest = step;
    }
    if (few) tryToo(few);
    if (coarsest) tryToo(coarsest);
    return tries;
}

// The next coarser step than all of `tried`, or null.
const StepMesh* BudgetChooser::coarserThan(const std::vector<const StepMesh*>& tried) const {
    const auto found = std::find_if(allowed_.begin(), allowed_.end(),
                                    [&](const StepMesh* step) { return step->step > tried.back()->step; });
    return found == allowed_.end() ? nullptr : *found;
}

BudgetMesh BudgetChooser::withTriangles(std::int64_t triangles, const Progress& progress) {
    std::vector<const StepMesh*> tried = firstTries(triangles);
    std::string list;
    std::optional<Trial> best;
    std::int64_t fewest = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < tried.size(); ++i) {
        if (best)
            if (const double own = original_.roughDistance(tried[i]->mesh, progress);
                own > kHopeless * best->distance) {
                list += fmt::format(", {} ({:.3g} by itself)", tried[i]->step, own);
                continue;
            }
        Trial trial = collapsed(*tried[i], triangles, progress);
        const auto count = static_cast<std::int64_t>(trial.mesh.triangles.size());
        fewest = std::min(fewest, count);
        list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", tried[i]->step,
                            count <= triangles ? fmt::format("{:.3g}", trial.distance)
                                               : fmt::format("not below {} triangles", count));
        if (count <= triangles && (!best || trial.distance < best->distance)) best = std::move(trial);
        if (i + 1 == tried.size() && !best)
            if (const StepMesh* coarser = coarserThan(tried)) tried.push_back(coarser);
    }
    if (!best)
        throw InputError(name_,
                         fmt::format("cannot come down to {} triangles; the fewest are {}, because a closed "
                                     "mesh keeps its holes and parts; ask for that many",
                                     triangles, fewest));
    BudgetMesh result{std::move(best->mesh), best->from->step, {}, {}};
    result.why = tried.size() == 1 ? "the only step tried: " + list
                                   : "smallest distance to level 0 of the steps tried: " + list;
    return result;
}

// ---- a distance

BudgetMesh BudgetChooser::withinDistance(double distance, const Progress& progress) {
    std::string list;
    std::optional<BudgetMesh> best;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        ToleranceChain& chain = chains_[i];
        if (i > 0 && chain.ownDistance(progress) > distance) break;
        auto made = chain.within(distance, progress);
        list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", chain.step(),
                            made ? fmt::format("{} triangles", made->mesh.triangles.size()) : "too far");
        if (made && (!best || made->mesh.triangles.size() < best->mesh.triangles.size()))
            best = BudgetMesh{std::move(made->mesh), chain.step(), {}, made->distance};
    }
    if (!best)
        throw InputError(name_,
                         fmt::format("no step that is allowed stays within {:.4g} of level 0; loosen the "
                                     "limits or the tolerance",
                                     distance));
    best->why = "fewest triangles of the steps tried: " + list;
    return *std::move(best);
}

BudgetMesh BudgetChooser::choose(const Budget& budget, const Progress& progress) {
    BudgetMesh result;
    switch (budget.kind) {
        case Budget::Kind::triangles:
            result = withTriangles(static_cast<std::int64_t>(budget.value), progress);
            break;
        case Budget::Kind::distance:
            return withinDistance(budget.value, progress);
        case Budget::Kind::none:
            result = {allowed_.front()->mesh, allowed_.front()->step, "the finest step that is allowed", {}};
            break;
    }
    result.distance = compareMeshes(result.mesh, original_.mesh, 0, progress);
    return result;
}

}  // namespace isowave
