#include "simplify/budget_chooser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "isowave/error.h"
#include "simplify/triangle_subset.h"

namespace isowave {
namespace {

// A step is decimated to a quarter, a quarter of that and so on, as long as this many times the triangles
// wanted are left; Collapse starts there.
constexpr std::int64_t kDecimated = 4;
// For a tolerance: as long as the decimated mesh is within this share of it.
constexpr double kDecimationShare = 0.25;

// For a number of triangles: Collapse::Options::errorFloor, as shares of the distance that decimate() ends
// with. The one that ends nearest wins.
constexpr std::array<double, 3> kErrorFloors{0.6, 0.42, 0.3};

// A step that is itself so many times as far from level 0 as the best mesh so far is not collapsed.
constexpr double kHopeless = 2;

// A mesh of so few triangles is not decimated.
constexpr std::int64_t kFewTriangles = 2000;

// To rank candidates, so many triangles of level 0 are enough; what is reported is measured from all of them.
constexpr std::size_t kRankingTriangles = 20'000;

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
    : steps_(std::move(steps)),
      name_(std::move(name)),
      original_(steps_.front().mesh),
      sample_(evenSubset(steps_.front().mesh, kRankingTriangles)) {
    assert(steps_.front().step == 0);
    for (const StepMesh& step : steps_)
        if (limits.allow(step.topology)) allowed_.push_back(&step);
    if (allowed_.empty())
        throw InputError(name_, "no step has " + limitsText(limits) + "; loosen the limits");
}

MeshComparison BudgetChooser::measured(const TriangleMesh& mesh, double enough,
                                       const Progress& progress) const {
    return compareMeshes(mesh, steps_.front().mesh, 0, progress, enough);
}

double BudgetChooser::roughDistance(const TriangleMesh& mesh, const Progress& progress) const {
    return std::max(original_.distanceFrom(mesh, 0, progress).max,
                    DistanceTarget(mesh).distanceFrom(sample_, 0, progress).max);
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
    if (from.topology.triangles <= triangles) return {&from, from.mesh, roughDistance(from.mesh, progress)};
    int times = 0;
    for (std::int64_t left = from.topology.triangles / 4; left >= kDecimated * triangles; left /= 4) ++times;
    const TriangleMesh& start = decimated(from, times, progress);
    // How far a collapse gets that does not measure distances; one that does gets nearer.
    const double rough = original_.distanceFrom(decimate(start, triangles, progress), 0, progress).max;
    std::optional<Trial> best;
    for (const double share : kErrorFloors) {
        Collapse collapse(start, steps_.front().mesh, original_, {from.voxel, share * rough}, progress);
        collapse.reduce(triangles, std::numeric_limits<double>::infinity(), progress);
        Trial trial{&from, collapse.mesh(), 0};
        trial.distance = roughDistance(trial.mesh, progress);
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
            if (const double own = roughDistance(tried[i]->mesh, progress);
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

std::optional<TriangleMesh> BudgetChooser::collapsedWithin(const StepMesh& from, double distance,
                                                           const Progress& progress) {
    int times = 0;
    while (from.step == 0 &&
           static_cast<std::int64_t>(decimated(from, times, progress).triangles.size()) > kFewTriangles &&
           roughDistance(decimated(from, times + 1, progress), progress) <= kDecimationShare * distance)
        ++times;
    // What a collapse costs is measured at points, so the true distance is somewhat larger than the largest
    // cost. The limit on the cost is raised bit by bit, and the last mesh that is proven to be within is the
    // result.
    constexpr std::array<double, 6> kShares{0.25, 0.4, 0.55, 0.7, 0.85, 1.0};
    std::optional<TriangleMesh> within;
    if (from.step == 0) within = from.mesh;
    Collapse collapse(decimated(from, times, progress), steps_.front().mesh, original_,
                      {from.voxel, kShares.front() * distance}, progress);
    for (const double share : kShares) {
        collapse.reduce(4, share * distance, progress);
        TriangleMesh mesh = collapse.mesh();
        if (measured(mesh, distance, progress).maxBound > distance) break;
        within = std::move(mesh);
    }
    return within;
}

BudgetMesh BudgetChooser::withinDistance(double distance, const Progress& progress) {
    std::vector<const StepMesh*> tried{allowed_.front()};
    // From the coarsest on; those that are far are told from samples.
    for (auto step = allowed_.rbegin(); step != allowed_.rend() - 1; ++step)
        if (roughDistance((*step)->mesh, progress) <= distance) {
            tried.push_back(*step);
            break;
        }
    std::string list;
    std::optional<BudgetMesh> best;
    for (const StepMesh* step : tried) {
        std::optional<TriangleMesh> mesh = collapsedWithin(*step, distance, progress);
        list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", step->step,
                            mesh ? fmt::format("{} triangles", mesh->triangles.size()) : "too far");
        if (mesh && (!best || mesh->triangles.size() < best->mesh.triangles.size()))
            best = BudgetMesh{std::move(*mesh), step->step, {}, {}};
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
            result = withinDistance(budget.value, progress);
            break;
        case Budget::Kind::none:
            result = {allowed_.front()->mesh, allowed_.front()->step, "the finest step that is allowed", {}};
            break;
    }
    const double enough = budget.kind == Budget::Kind::distance ? budget.value : 0;
    result.distance = measured(result.mesh, enough, progress);
    return result;
}

}  // namespace isowave
