// limitTopology = rounds of
//   find    what could be cut or filled (topology_candidates.h)
//   try     each on its surroundings alone: Euler number and volume of the mesh there (local_edit.h)
//   choose  those that move the least to the other side and do not touch each other, as many as are too many
//   apply   all together and count the mesh; where it is not as it should be, each half on its own
#include "hold/cut_or_fill.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/number_text.h"
#include "hold/mesh_counter.h"
#include "hold/plug.h"
#include "hold/topology_candidates.h"
#include "hold/until_stopped.h"
#include "polygonize/specks.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using What = TopologyEdit::What;

constexpr What kOrder[] = {What::part, What::cavity, What::handle};

std::int64_t countOf(const SolidCounts& counts, What what) {
    return what == What::part ? counts.parts : what == What::handle ? counts.handles : counts.cavities;
}
std::optional<std::int64_t> limitOf(const SolidLimits& limits, What what) {
    return what == What::part ? limits.parts : what == What::handle ? limits.handles : limits.cavities;
}
std::string countText(std::int64_t count, What what) {
    return counted(count,
                   what == What::part     ? "part"
                   : what == What::handle ? "handle"
                                          : "cavity",
                   what == What::cavity ? "cavities" : "");
}

// An option that was tried and does what it should.
struct Choice {
    TopologyEdit edit;  // without its volume
    EditPlan plan;
    LocalEdit change;
    OptionKey key;
};
// The cheapest of the options of one thing that do what they should, and those that do not.
struct Tried {
    std::optional<Choice> choice;
    std::vector<OptionKey> useless;
};

// How an option is tried: gently first.
constexpr EditManner kManners[] = {{0.25, false}, {0.25, true}, {1.0, true}};

// Options are tried while their estimate is below this multiple of the cheapest one's that works.
constexpr double kWorthTrying = 4;
// Of K: the depth of holes up to which they are looked for first.
constexpr double kDeepest = 0.95;
// Above all F: what holds walls moves control points beyond K, and a cavity that is deeper than what is looked at is none.
constexpr double kEverything = 1e30;
// Points of a lattice: persistence takes about 1 us each.
constexpr double kMostAtFirst = 8e6, kMostPoints = 4e7;
// More are tried than are too many: some do not work, some touch each other.
constexpr std::size_t kSpare = 16;
// Cells of the lattice: among edits that move no more, order does not matter.
constexpr double kLittle = 4;

BSplineField withOwnGrids(BSplineField field) {
    field.controlPoints = field.controlPoints->deepCopy();
    field.shape = field.shape->deepCopy();
    return field;
}

// Control points and signs that apply() (local_edit.h) may have changed for an edit with this box.
void copyAround(const CoordBBox& box, const BSplineField& from, BSplineField& to) {
    constexpr int kChanges = 3;
    CoordBBox around = box;
    around.expand(kChanges);
    const auto values = from.controlPoints->getConstAccessor();
    const auto signs = from.shape->getConstAccessor();
    auto toValues = to.controlPoints->getAccessor();
    auto toSigns = to.shape->getAccessor();
    for (auto at = around.begin(); at; ++at) {
        if (toValues.getValue(*at) != values.getValue(*at)) toValues.setValueOnly(*at, values.getValue(*at));
        if (toValues.isValueOn(*at) != values.isValueOn(*at))
            toValues.setActiveState(*at, values.isValueOn(*at));
        if (toSigns.getValue(*at) != signs.getValue(*at)) toSigns.setValueOnly(*at, signs.getValue(*at));
        if (toSigns.isValueOn(*at) != signs.isValueOn(*at)) toSigns.setActiveState(*at, signs.isValueOn(*at));
    }
}

class Limiter {
  public:
    Limiter(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
            const Progress& progress)
        : field_(field), refine_(refine), limits_(limits), smallest_(smallestPart), progress_(progress) {}

    TopologyEdits run(const SolidCounts& now) {
        result_.before = result_.after = now;
        bool goesOn = !limits_.allow(result_.after);
        while (goesOn) {
            progress_("limiting the topology", 0);
            goesOn = round() && !limits_.allow(result_.after);
        }
        result_.met = limits_.allow(result_.after);
        if (!result_.met) result_.why = why();
        return result_;
    }

  private:
    // What the field becomes where edits are put in, and the counts of its mesh.
    struct Attempt {
        BSplineField field;
        MeshCounter counter;
    };
    std::int64_t tooMany(What what) const {
        const std::int64_t now = countOf(result_.after, what);
        return now - std::min(now, limitOf(limits_, what).value_or(now));
    }

    // -> whether something was changed. Holes, gaps and cavities that are so deep that the field is cut off in their
    // middle are looked for last, and so is what only a face's decision makes in a large field: that takes several
    // times as long.
    bool round() {
        for (const auto& depth : {TopologyCandidates::Depth{kDeepest * field_.K, kMostAtFirst},
                                  TopologyCandidates::Depth{kEverything, kMostPoints}}) {
            const TopologyCandidates candidates(field_, refine_, smallest_, depth, plugs_, useless_,
                                                progress_);
            for (const What what : kOrder)
                if (tooMany(what) > 0 && roundOf(what, candidates)) return true;
        }
        return false;
    }
    bool roundOf(What what, const TopologyCandidates& candidates) {
        const auto need = static_cast<std::size_t>(tooMany(what));
        const std::size_t before = result_.edits.size();
        for (std::size_t most = 2 * need + kSpare; result_.edits.size() == before;) {
            const std::size_t useless = useless_.size();
            const std::vector<EditOptions> all = candidates.of(what, need, most);
            take(chosen(tried(all), need));
            if (result_.edits.size() > before || useless_.size() > useless) continue;
            if (all.size() < most) break;
            most *= kSpare;
        }
        return result_.edits.size() > before;
    }

    // ---- try

    std::vector<std::optional<Choice>> tried(const std::vector<EditOptions>& all) {
        std::vector<Tried> results(all.size());
        forEachUntilStopped(all.size(), progress_, [&](std::size_t i) {
            const auto known = known_.find(keysOf(all[i]));
            results[i] = known == known_.end() ? cheapest(all[i]) : known->second.tried;
        });
        std::vector<std::optional<Choice>> choices;
        for (std::size_t i = 0; i < all.size(); ++i) {
            known_[keysOf(all[i])] = {readBy(all[i]), results[i]};
            useless_.insert(results[i].useless.begin(), results[i].useless.end());
            choices.push_back(std::move(results[i].choice));
        }
        return choices;
    }
    // The control points that trying reads.
    CoordBBox readBy(const EditOptions& options) const {
        CoordBBox box;
        for (const EditOption& option : options) {
            for (const Coord& c : option.plan.points) {
                box.expand(Coord::floor(c.asVec3d() / refine_));
                box.expand(Coord::ceil(c.asVec3d() / refine_));
            }
            for (const openvdb::Vec3d& place : option.plan.places) box.expand(Coord::floor(place));
        }
        constexpr int kReads = 7;
        box.expand(kReads);
        return box;
    }
    // What was found out near an edit no longer holds.
    void forgetAround(const CoordBBox& changed) {
        std::erase_if(known_, [&](const auto& entry) { return entry.second.reads.hasOverlap(changed); });
        CoordBBox starts(Coord(changed.min().asVec3i() * refine_), Coord(changed.max().asVec3i() * refine_));
        starts.expand(kWidestPlug + 2 * refine_ + 2);
        plugs_.forget(starts);
        std::erase_if(useless_, [&](const OptionKey& key) {
            const openvdb::Vec3d at = field_.transform().worldToIndex({key[2], key[3], key[4]});
            return starts.isInside(Coord::round(at * refine_));
        });
    }
    Tried cheapest(const EditOptions& options) const {
        Tried tried;
        std::optional<Choice>& best = tried.choice;
        double estimate = 0;
        for (const EditOption& option : options) {
            if (best && option.estimate > kWorthTrying * estimate) break;
            auto choice = tryOption(option);
            if (!choice) tried.useless.push_back(keyOf(option));
            if (!choice) continue;
            if (!best) estimate = option.estimate;
            if (!best || choice->change.moved < best->change.moved) best = std::move(choice);
        }
        return tried;
    }
    std::optional<Choice> tryOption(const EditOption& option) const {
        EditTrial trial(field_, refine_, option.plan);
        for (const EditManner& manner : kManners) {
            auto change = trial.attempt(manner, option.euler);
            if (!change) continue;
            return Choice{option.edit, option.plan, std::move(*change), keyOf(option)};
        }
        return {};
    }

    // ---- choose

    // Each edit was made for the control points around it as they are.
    static bool touch(const LocalEdit& a, const LocalEdit& b) {
        constexpr int kReads = 4;
        CoordBBox around = a.box;
        around.expand(kReads);
        return around.hasOverlap(b.box);
    }
    // The cheapest that do not touch each other. One that touches a cheaper one has to wait for the next round, and with it what moves
    // many times as much: else TR12J at 128 voxels is cut through (50 cells) where two of a cell each lie side by side.
    std::vector<Choice> chosen(const std::vector<std::optional<Choice>>& all, std::size_t most) const {
        std::vector<const Choice*> order;
        for (const auto& choice : all)
            if (choice) order.push_back(&*choice);
        std::stable_sort(order.begin(), order.end(),
                         [](const Choice* a, const Choice* b) { return a->change.moved < b->change.moved; });
        const double cell = std::abs(field_.transform().baseMap()->determinant()) / std::pow(refine_, 3);
        double dearest = std::numeric_limits<double>::infinity();
        std::vector<Choice> result;
        for (const Choice* choice : order) {
            const double moved = choice->change.moved;
            if (result.size() == most || moved > dearest) break;
            if (std::none_of(result.begin(), result.end(),
                             [&](const Choice& c) { return touch(c.change, choice->change); }))
                result.push_back(*choice);
            else
                dearest = std::min(dearest, kWorthTrying * std::max(moved, kLittle * cell));
        }
        return result;
    }

    // ---- apply

    void take(const std::vector<Choice>& batch) {
        if (batch.empty()) return;
        Attempt& attempt = attempted(batch);
        const SolidCounts now = attempt.counter.counts();
        if (isAsWanted(now, batch)) {
            for (const Choice& choice : batch) result_.edits.push_back(made(choice));
            if (std::exchange(hasSharedGrids_, false)) field_ = withOwnGrids(field_);
            for (const Choice& choice : batch) apply(choice.change, field_);
            result_.after = now;
            for (const Choice& choice : batch) forgetAround(choice.change.box);
            return;
        }
        attempt.counter.undo();
        for (const Choice& choice : batch) copyAround(choice.change.box, field_, attempt.field);
        if (batch.size() == 1) {
            useless_.insert(batch.front().key);
        } else {
            const auto middle = batch.begin() + static_cast<std::ptrdiff_t>(batch.size() / 2);
            take({batch.begin(), middle});
            take({middle, batch.end()});
        }
    }
    // The field with the batch put in.
    Attempt& attempted(const std::vector<Choice>& batch) {
        if (!attempt_) {
            attempt_.emplace(
                Attempt{withOwnGrids(field_), MeshCounter(field_, refine_, smallest_, progress_)});
        }
        std::vector<CoordBBox> boxes;
        for (const Choice& choice : batch) {
            apply(choice.change, attempt_->field);
            boxes.push_back(choice.change.box);
        }
        attempt_->counter.change(attempt_->field, boxes);
        return *attempt_;
    }
    TopologyEdit made(const Choice& choice) const {
        TopologyEdit edit = choice.edit;
        edit.volume = EditTrial(field_, refine_, choice.plan).volumeGained(choice.change);
        return edit;
    }
    bool isAsWanted(const SolidCounts& now, const std::vector<Choice>& batch) const {
        const auto less = static_cast<std::int64_t>(batch.size());
        for (const What what : kOrder) {
            const std::int64_t before = countOf(result_.after, what), after = countOf(now, what);
            if (what == batch.front().edit.what ? after != before - less : after > before) return false;
        }
        return true;
    }

    static std::vector<OptionKey> keysOf(const EditOptions& options) {
        std::vector<OptionKey> keys;
        for (const EditOption& option : options) keys.push_back(keyOf(option));
        return keys;
    }

    std::string why() const {
        std::string text;
        for (const What what : kOrder)
            if (tooMany(what) > 0)
                text += fmt::format("{}{} where {} {} allowed", text.empty() ? "" : ", ",
                                    countText(countOf(result_.after, what), what), *limitOf(limits_, what),
                                    *limitOf(limits_, what) == 1 ? "is" : "are");
        const auto tried = static_cast<std::int64_t>(useless_.size());
        return text + fmt::format("; {} made, {} more would change more than they should",
                                  counted(static_cast<std::int64_t>(result_.edits.size()), "cut or fill",
                                          "cuts and fills"),
                                  tried);
    }

    BSplineField& field_;
    int refine_;
    SolidLimits limits_;
    double smallest_;
    const Progress& progress_;
    std::set<OptionKey> useless_;  // on the whole mesh or on its surroundings alone
    struct Known {
        CoordBBox reads;
        Tried tried;
    };
    std::map<std::vector<OptionKey>, Known> known_;
    PlugMemo plugs_;
    std::optional<Attempt> attempt_;  // made when the first edit is tried
    bool hasSharedGrids_ = true;      // field_: others may hold its grids, too
    TopologyEdits result_;
};

}  // namespace

TopologyEdits limitTopology(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                            const Progress& progress) {
    return limitTopology(field, refine, limits, smallestPart,
                         meshedCounts(field, refine, smallestPart, progress), progress);
}

TopologyEdits limitTopology(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                            const SolidCounts& now, const Progress& progress) {
    return Limiter(field, refine, limits, smallestPart, progress).run(now);
}

bool isSearchedWhole(const BSplineField& field, int refine) {
    return latticePoints(field, 2 * refine) <= kMostPoints;
}

}  // namespace isowave
