#include "hold/limit_level.h"

#include <fmt/format.h>

#include <algorithm>

#include "hold/cut_or_fill.h"

namespace isowave {
namespace {

void lower(std::optional<std::int64_t>& limit, std::int64_t most) {
    limit = std::min(most, limit.value_or(most));
}

SolidFeature featureOf(TopologyEdit::What what) {
    switch (what) {
        case TopologyEdit::What::part:
            return SolidFeature::part;
        case TopologyEdit::What::handle:
            return SolidFeature::handle;
        default:
            return SolidFeature::cavity;
    }
}

}  // namespace

SolidLimits limitsOf(const LevelOptions& options, const std::optional<SolidCounts>& before) {
    SolidLimits limits{options.maxParts, options.maxGenus, {}};
    if (before) {
        lower(limits.parts, before->parts);
        lower(limits.handles, before->handles);
        lower(limits.cavities, before->cavities);
    }
    return limits;
}

std::string limitLevel(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                       LevelReport& report, const Progress& progress) {
    if (!limits.any()) return {};
    const MeshTopology& now = report.topology;
    const TopologyEdits edits =
        limitTopology(field, refine, limits, smallestPart, {now.parts, now.genus, now.cavities}, progress);
    for (const TopologyEdit& edit : edits.edits)
        report.edits.push_back({edit.kind == TopologyEdit::Kind::fill,
                                featureOf(edit.what),
                                {edit.at[0], edit.at[1], edit.at[2]},
                                edit.volume});
    return edits.why;
}

std::string nameOf(const LevelReport& report) {
    return report.level ? fmt::format("level {}", *report.level) : fmt::format("step {}", report.step);
}

void missLimits(LevelReport& report, const std::string& why, const Progress& progress) {
    report.limitsMissed = why;
    progress.say(fmt::format("{}: limits on the topology are missed: {}", nameOf(report), why));
}

}  // namespace isowave
