#include "lod/budgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"
#include "lod/option_checks.h"
#include "lod/regions/region_shape.h"

namespace isowave::lod {
namespace {

constexpr std::int64_t kFewestTriangles = 4;  // of a closed mesh

}  // namespace

void checkBudgets(const BudgetOptions& options, bool openBorder) {
    if (!options.any()) return;
    for (const std::int64_t n : options.triangles) requireAtLeast("--triangles", n, kFewestTriangles);
    requirePositive("--ratio", options.ratios);
    for (const double ratio : options.ratios)
        if (ratio > 1)
            throw UsageError(fmt::format("--ratio: {:g} is more than 1, which is all triangles", ratio));
    requirePositive("--tolerance", options.tolerances);
    requirePositive("--min-component", options.minComponent);
    requireAtLeast("--max-genus", options.maxGenus, 0);
    if (openBorder)
        throw UsageError("budgets and limits on the topology need closed meshes; leave --open-border out");
    requireSimplifier("a budget (--triangles, --ratio, --tolerance, --max-genus, --min-component)");
}

void requireNoRegions(const BudgetOptions& options, const LevelOptions& levels) {
    const char* option = regionOptionOf(levels);
    if (option && options.any())
        throw UsageError(std::string(option) +
                         " and budgets exclude each other: a budget chooses among whole levels");
}

Budgets::Budgets(const BudgetOptions& options, std::optional<std::int64_t> inputTriangles,
                 std::shared_ptr<const TriangleMesh> input, StepOrder order)
    : limits_{options.maxGenus, options.minComponent},
      wholeTriangles_(inputTriangles),
      input_(std::move(input)),
      order_(std::move(order)) {
    for (const std::int64_t n : options.triangles)
        asked_.push_back({{Budget::Kind::triangles, static_cast<double>(n)}, 0});
    for (const double ratio : options.ratios) asked_.push_back({{Budget::Kind::triangles, 0}, ratio});
    for (const double distance : options.tolerances)
        asked_.push_back({{Budget::Kind::distance, distance}, 0});
    if (asked_.empty() && options.any()) asked_.push_back({});
}

void Budgets::add(int step, const BSplineField& field, const TriangleMesh& mesh,
                  const MeshTopology& topology) {
    if (!wholeTriangles_) wholeTriangles_ = topology.triangles;
    steps_.push_back(
        {step, mesh, topology, field.transform().voxelSize().length(), order_.levelOf(step).has_value()});
}

BudgetReport Budgets::asReport(const Asked& asked, const Budget& budget) const {
    BudgetReport report;
    if (budget.kind == Budget::Kind::triangles)
        report.trianglesAsked = static_cast<std::int64_t>(budget.value);
    if (asked.ratio > 0) report.ratioAsked = asked.ratio;
    if (budget.kind == Budget::Kind::distance) report.toleranceAsked = budget.value;
    report.maxGenus = limits_.maxGenus;
    report.minComponent = limits_.minComponent;
    return report;
}

BudgetLevel Budgets::made(const Asked& asked, BudgetSolver& solver, const LadderVisitor& visitor,
                          const Progress& progress, StageClock& clock) const {
    const double begin = clock.secondsSoFar();
    Budget budget = asked.budget;
    if (asked.ratio > 0)
        budget.value = std::max(static_cast<double>(kFewestTriangles),
                                std::round(asked.ratio * static_cast<double>(wholeTriangles_.value_or(0))));
    // What is within D - d of level 0, which is within d of the input, is within D of the input.
    if (budget.kind == Budget::Kind::distance) budget.value -= level0ToInput_.value_or(0);
    BudgetMesh chosen = [&] {
        const StageClock::Scope scope(clock, "collapse");
        return solver.choose(budget, progress);
    }();
    if (visitor.budget) clock.announce("write");
    BudgetLevel level{asReport(asked, asked.ratio > 0 ? budget : asked.budget), {}};
    BudgetReport& report = level.report;
    report.step = chosen.step;
    report.level = order_.levelOf(chosen.step);
    report.why = std::move(chosen.why);
    {
        const StageClock::Scope scope(clock, "measure");
        report.topology = topologyOf(chosen.mesh);
        report.selfIntersections = countSelfIntersections(chosen.mesh, progress);
    }
    report.toLevel0 = chosen.distance.aToB;
    report.fromLevel0 = chosen.distance.bToA;
    if (level0ToInput_)
        report.maxToInput = *level0ToInput_ + std::max(report.toLevel0.maxBound, report.fromLevel0.maxBound);
    report.seconds = clock.secondsSoFar() - begin;
    if (visitor.budget) {
        const StageClock::Scope scope(clock, "write");
        visitor.budget(report, chosen.mesh);
        report.seconds = clock.secondsSoFar() - begin;
    } else {
        level.mesh = std::move(chosen.mesh);
    }
    return level;
}

void Budgets::measureInput(const std::string& name, const Progress& progress) {
    if (!input_) return;
    level0ToInput_ = compareMeshes(steps_.front().mesh, *input_, 0, progress).maxBound;
    input_.reset();
    for (const Asked& asked : asked_)
        if (asked.budget.kind == Budget::Kind::distance && asked.budget.value <= *level0ToInput_)
            throw InputError(
                name,
                fmt::format("level 0 itself is up to {:.3g} away from the mesh, which leaves nothing of a "
                            "tolerance of {:.4g}; give a larger one, or more --voxels",
                            *level0ToInput_, asked.budget.value));
}

std::vector<BudgetLevel> Budgets::make(const std::string& name, const LadderVisitor& visitor,
                                       const Progress& progress, StageClock& clock) {
    {
        const StageClock::Scope scope(clock, "measure");
        measureInput(name, progress);
    }
    const auto solver = makeBudgetSolver(std::move(steps_), limits_, name);
    std::vector<BudgetLevel> levels;
    for (const Asked& asked : asked_) levels.push_back(made(asked, *solver, visitor, progress, clock));
    return levels;
}

}  // namespace isowave::lod
