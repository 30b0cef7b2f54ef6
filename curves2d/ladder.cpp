#include "curves2d/ladder.h"

#include <algorithm>
#include <cmath>

#include "curves2d/hold/level.h"

namespace isowave::curves2d {
namespace {

constexpr int kMostSamples = 64;

StepFacts factsOf(int step, const RowField<float>& field, const Curves& curves) {
    StepFacts facts;
    facts.step = step;
    const Bounds box = field.bounds();
    facts.domain = {box.size(0), box.size(1)};
    facts.controlPoints = field.controlPointCount();
    facts.nodes = definedNodeCount(field);
    facts.holes = curves.holeCount();
    facts.rings = curves.outerCount();
    facts.points = curves.pointCount();
    facts.area = curves.area();
    return facts;
}

}  // namespace

RowField<float> fit(const Shape& shape, Fit method, const DistanceFitOptions& options, FitReport* report,
                    const Progress& progress) {
    return method == Fit::binary ? fitBinary<float>(shape, {.K = options.K}, report, progress)
                                 : fitDistance<float>(shape, options, report, progress);
}

std::vector<Segment> segmentsOf(const Curves& curves) {
    std::vector<Segment> segments;
    segments.reserve(curves.pointCount());
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const Ring ring = curves.world(r);
        for (std::size_t i = 0; i < ring.size(); ++i)
            segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    return segments;
}

// Samples at the middles of equal parts, each weighing its part's length.
Distance distanceTo(const SegmentTree& target, const Curves& curves, double spacing) {
    Distance result;
    double weight = 0, sum = 0;
    for (const Segment& s : segmentsOf(curves)) {
        const double size = length(s.b - s.a);
        const int parts = static_cast<int>(std::clamp(std::ceil(size / spacing), 1.0, double(kMostSamples)));
        for (int k = 0; k < parts; ++k) {
            const double d = target.distance(s.a + ((k + 0.5) / parts) * (s.b - s.a));
            result.max = std::max(result.max, d);
            sum += d * d * size / parts;
        }
        weight += size;
    }
    result.rms = weight > 0 ? std::sqrt(sum / weight) : 0;
    return result;
}

Ladder traceSteps(RowField<float> field, std::optional<int> lastStep, Hold hold, const FieldVisitor& visit,
                  const Progress& progress) {
    Ladder ladder;
    std::optional<SegmentTree> finest;
    std::optional<LevelHolder> holder;
    double spacing = 0;
    bool hasEnded = false;
    const auto tell = [&](StepFacts facts, const RowField<float>& f, const Curves& curves,
                          const Curves& traced) {
        if (facts.step > 0) {
            const Distance d = distanceTo(*finest, curves, spacing);
            facts.maxToLevel0 = d.max;
            facts.rmsToLevel0 = d.rms;
        }
        ladder.steps.push_back(facts);
        hasEnded = curves.rings.empty();
        if (visit) visit(facts, f, curves, traced);
    };
    // What has vanished stays so: a coarser step could hold something again, which is no part of the input any more.
    const auto onStep = [&](int step, const RowField<float>& f) {
        if (hasEnded) return;
        if (holder && step % 2 == 0) {
            const HeldLevel level = holder->hold(f, progress);
            StepFacts facts = factsOf(step, f, level.curves);
            facts.hold = level.facts;
            return tell(facts, level.field, level.curves, level.traced);
        }
        const Curves curves = extractCurves(f, progress);
        if (step == 0) {
            spacing = std::min(f.frame.spacing.x, f.frame.spacing.y);
            finest.emplace(segmentsOf(curves));
            if (hold == Hold::local) holder.emplace(f, curves);
        }
        tell(factsOf(step, f, curves), f, curves, curves);
    };
    const Pyramid<float> pyramid =
        analyse<float>(std::move(field), lastStep.value_or(1000), progress, onStep);
    ladder.coefficients = pyramid.coefficientCount();
    ladder.controlPoints = ladder.steps.front().controlPoints;
    return ladder;
}

}  // namespace isowave::curves2d
