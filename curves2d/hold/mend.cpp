#include "curves2d/hold/mend.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <set>
#include <utility>

#include "curves2d/contour.h"
#include "curves2d/hold/ascent.h"
#include "curves2d/hold/interior.h"
#include "curves2d/hold/point_grid.h"
#include "curves2d/hold/regions.h"

namespace isowave::curves2d {
namespace {

constexpr int kMostRounds = 6;       // then what is in excess goes
constexpr double kSampleWeight = 4;  // of a part with thin samples
constexpr double kClear = 0.5;       // lattice steps between a cut and a sample
constexpr double kDepth = 0.1;       // of a lattice step: how far beyond zero a changed lattice point lies
constexpr int kBeside = 4;           // lattice points around a change that keep their signs
constexpr double kTolerance = 1e-3;  // of a lattice step
constexpr int kMostSweeps = 60;

using Cell = std::pair<std::int32_t, std::int32_t>;  // j, i: row by row

// The cheapest way from one region to another of its kind.
class PathFinder {
  public:
    // samples: a cut keeps away from them.
    PathFinder(const Regions& now, const Regions& before, const std::set<std::int32_t>& excess,
               const PointGrid& samples, double spacing)
        : now_(now), before_(before), excess_(excess), samples_(samples), spacing_(spacing) {}

    // Lattice points to change, fewer than `most`; nothing where there is no such way. Breadth first, steps that change
    // nothing before those that do.
    std::optional<std::vector<Cell>> find(std::int32_t region, double most) {
        visits_.clear();
        const bool inside = now_.inside(region);
        std::deque<Cell> queue;
        for (const Regions::Cell& cell : now_.points(region)) {
            queue.push_back({cell.j, cell.i});
            visits_[key(queue.back())] = {0, queue.back(), false};
        }
        while (!queue.empty()) {
            const Cell at = queue.front();
            queue.pop_front();
            Visit& visit = visits_[key(at)];
            if (std::exchange(visit.done, true)) continue;
            if (isGoal(at, region, inside)) return wayTo(at);
            const int cost = visit.cost;
            for (const auto& [dj, di] : {Cell{0, -1}, Cell{0, 1}, Cell{-1, 0}, Cell{1, 0}}) {
                const Cell next{at.first + dj, at.second + di};
                const bool free = kindAt(now_, next) == inside;
                if (!free && (cost + 1 >= most || !mayChange(next, inside))) continue;
                const int reached = cost + !free;
                const auto [old, isNew] = visits_.insert({key(next), Visit{reached, at, false}});
                if (!isNew && (old->second.done || old->second.cost <= reached)) continue;
                old.value() = {reached, at, false};
                free ? queue.push_front(next) : queue.push_back(next);
            }
        }
        return std::nullopt;
    }

  private:
    struct Visit {
        int cost = 0;
        Cell from;
        bool done = false;
    };
    static std::uint64_t key(Cell cell) { return GridCell{cell.second, cell.first}.key(); }
    static bool kindAt(const Regions& regions, Cell cell) {
        return regions.inside(regions.at(cell.second, cell.first));
    }
    bool mayChange(Cell cell, bool toInside) const {
        if (kindAt(before_, cell) != toInside) return false;
        return toInside ||
               !samples_.nearest({spacing_ * cell.second, spacing_ * cell.first}, kClear * spacing_);
    }
    bool isGoal(Cell cell, std::int32_t region, bool inside) const {
        const std::int32_t here = now_.at(cell.second, cell.first);
        return here != region && now_.inside(here) == inside && !excess_.count(here);
    }
    std::vector<Cell> wayTo(Cell at) {
        std::vector<Cell> way;
        for (;;) {
            const Visit& visit = visits_[key(at)];
            if (visit.from == at) break;
            if (visits_[key(visit.from)].cost != visit.cost) way.push_back(at);
            at = visit.from;
        }
        std::sort(way.begin(), way.end());
        return way;
    }

    const Regions &now_, &before_;
    const std::set<std::int32_t>& excess_;
    const PointGrid& samples_;
    double spacing_;
    tsl::robin_map<std::uint64_t, Visit> visits_;
};

// Gives lattice points another sign and keeps those around.
void changeSigns(RowField<float>& field, const std::set<Cell>& changed, double step,
                 const Progress& progress) {
    std::set<Cell> around;
    for (const auto& [j, i] : changed)
        for (std::int32_t dj = -kBeside; dj <= kBeside; ++dj)
            for (std::int32_t di = -kBeside; di <= kBeside; ++di) around.insert({j + dj, i + di});
    Ascent ascent(field);
    const double depth = kDepth * step;
    for (const auto& [j, i] : around) {
        const Point at{double(i), double(j)};
        const double F = sample(field, at).value, side = F < 0 ? 1 : -1;
        if (changed.count({j, i}))
            ascent.add({at, -side, depth, 0});
        else
            ascent.add({at, side, std::min(std::abs(F) / 2, depth), 0});
    }
    ascent.run(kTolerance * step, kMostSweeps, progress);
    ascent.write(field);
}

class Mender {
  public:
    Mender(RowField<float>& field, const MendTask& task)
        : field_(field),
          task_(task),
          before_(task.before, task.beforeSpacing, task.spacing),
          samples_(placesOf(task.samples), task.spacing) {}

    Mended run(const Progress& progress) {
        for (int round = 0;; ++round) {
            progress.check();
            look(progress);
            std::set<Cell> changed;
            if (round < kMostRounds) changed = ways();
            if (changed.empty()) break;
            result_.area += pixel() * static_cast<double>(changed.size());
            changeSigns(field_, changed, task_.spacing * task_.slope, progress);
        }
        removeExcess();
        return std::move(result_);
    }

  private:
    double pixel() const { return task_.spacing * task_.spacing; }

    // The curves without specks, and which parts hold samples.
    void look(const Progress& progress) {
        const Curves all = extractCurves(field_, progress);
        std::vector<char> holds = partsWithSamples(all);
        const Regions regions(all, task_.spacing, task_.spacing);
        std::vector<std::int32_t> specks;
        for (std::int32_t r = 0; r < regions.count(); ++r)
            if (regions.inside(r) && !holds[static_cast<std::size_t>(r)] &&
                regions.area(r) < task_.H * task_.H)
                specks.push_back(r);
        result_.islands = specks.size();
        result_.curves = withoutRings(all, specks);
        holds_ = specks.empty() ? std::move(holds) : partsWithSamples(result_.curves);
        now_.emplace(result_.curves, task_.spacing, task_.spacing);
        const std::vector<std::int32_t> excess = excessRegions(*now_, before_);
        excess_ = {excess.begin(), excess.end()};
    }

    std::vector<char> partsWithSamples(const Curves& curves) const {
        std::vector<char> holds(curves.rings.size(), 0);
        const Interior interior(curves);
        for (const ThinSample& sample : task_.samples)
            if (const auto part = interior.part((1 / task_.spacing) * sample.at))
                holds[static_cast<std::size_t>(*part)] = 1;
        return holds;
    }

    // The lattice points to change so that pieces in excess join the rest.
    std::set<Cell> ways() {
        std::set<Cell> changed;
        PathFinder finder(*now_, before_, excess_, samples_, task_.spacing);
        for (const std::int32_t region : excess_) {
            const bool holds = holds_[static_cast<std::size_t>(region)];
            const auto way = finder.find(region, now_->area(region) / pixel() * (holds ? kSampleWeight : 1));
            if (!way) continue;
            ++(now_->inside(region) ? result_.joined : result_.opened);
            changed.insert(way->begin(), way->end());
        }
        return changed;
    }

    void removeExcess() {
        for (const std::int32_t region : excess_) {
            ++(now_->inside(region) ? result_.dropped : result_.filled);
            result_.area += now_->area(region);
        }
        result_.curves = withoutRings(result_.curves, {excess_.begin(), excess_.end()});
    }

    RowField<float>& field_;
    const MendTask& task_;
    Regions before_;
    PointGrid samples_;
    std::optional<Regions> now_;
    std::set<std::int32_t> excess_;
    std::vector<char> holds_;
    Mended result_;
};

}  // namespace

Mended mend(RowField<float>& field, const MendTask& task, const Progress& progress) {
    return Mender(field, task).run(progress);
}

}  // namespace isowave::curves2d
