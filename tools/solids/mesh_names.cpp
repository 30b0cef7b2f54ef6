#include "tools/solids/mesh_names.h"

#include <fmt/format.h>

#include <algorithm>

namespace isowave::tools {
namespace {

// Coordinates have 32 bits, so an axis is halved at most so often, and of several levels each halves one axis at least.
constexpr int kMostSteps = 32 * kStepsPerLevel;

std::string trianglesSuffix(std::int64_t triangles) { return fmt::format("T{}", triangles); }
std::string ratioSuffix(double ratio) { return fmt::format("R{:g}", ratio); }
std::string toleranceSuffix(double tolerance) { return fmt::format("D{:g}", tolerance); }

}  // namespace

MeshNames::MeshNames(std::string folder, MeshFormat format, const LevelOptions& levels,
                     const BudgetOptions& budgets)
    : folder_(std::move(folder)), format_(format), levels_(levels), budgets_(budgets) {}

std::string MeshNames::named(const std::string& suffix) const {
    return fmt::format("{}_{}{}", folder_, suffix, extensionOf(format_));
}

std::string MeshNames::numbered(int number) const {
    return named(fmt::format("{}{}", levels_.steps ? "s" : "L", number));
}

std::string MeshNames::ofLevel(const LevelReport& level) const {
    return numbered(levels_.steps ? level.step : *level.level);
}

std::string MeshNames::ofBudget(const BudgetReport& budget) const {
    if (budget.ratioAsked) return named(ratioSuffix(*budget.ratioAsked));
    if (budget.trianglesAsked) return named(trianglesSuffix(*budget.trianglesAsked));
    if (budget.toleranceAsked) return named(toleranceSuffix(*budget.toleranceAsked));
    return named("chosen");
}

std::string MeshNames::ofPage() const { return folder_ + ".html"; }

std::string MeshNames::ofLods() const { return folder_ + "_lods.glb"; }

std::string MeshNames::suffixOf(const std::string& name) const {
    const std::size_t begin = folder_.size() + 1;
    return name.substr(begin, name.size() - begin - std::string_view(extensionOf(format_)).size());
}

std::vector<std::string> MeshNames::all() const {
    std::vector<std::string> names;
    const StepRange range = levels_.steps ? *levels_.steps : levels_.levels.value_or(StepRange{});
    const int last = std::min(range.last.value_or(kMostSteps), kMostSteps);
    for (int number = range.first; number <= last; ++number) names.push_back(numbered(number));
    for (const std::int64_t n : budgets_.triangles) names.push_back(named(trianglesSuffix(n)));
    for (const double ratio : budgets_.ratios) names.push_back(named(ratioSuffix(ratio)));
    for (const double tolerance : budgets_.tolerances) names.push_back(named(toleranceSuffix(tolerance)));
    if (budgets_.maxGenus || budgets_.minComponent) names.push_back(named("chosen"));
    return names;
}

}  // namespace isowave::tools
