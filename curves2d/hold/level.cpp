#include "curves2d/hold/level.h"

#include <tsl/robin_set.h>

#include <cmath>

#include "curves2d/hold/coarsened.h"
#include "curves2d/hold/hold.h"
#include "curves2d/hold/mend.h"
#include "curves2d/hold/point_grid.h"

namespace isowave::curves2d {
namespace {

struct Change {
    std::int64_t count = 0;
    tsl::robin_set<std::uint64_t> squares;  // in which the spline is another, by their cells' keys
};

// Control point (x, y) has a weight in the lattice squares x-2 .. x+1, y-2 .. y+1. REQUIRES: equal runs.
Change changeBetween(const RowField<float>& a, const RowField<float>& b, int sampling) {
    Change change;
    for (const auto& [y, row] : a.rows) {
        const std::vector<float>& other = b.find(y)->values;
        std::size_t v = 0;
        for (const KnownRun& run : row.runs)
            for (std::int32_t x = run.first; x <= run.last; ++x, ++v) {
                if (row.values[v] == other[v]) continue;
                ++change.count;
                for (const std::int32_t dx : {-2, 0, 1})
                    for (const std::int32_t dy : {-2, 0, 1})
                        change.squares.insert(GridCell::of({double(x + dx), double(y + dy)}, sampling).key());
            }
    }
    return change;
}

// And the squares that a thin place reaches, one step beyond its ends.
void addThinPlaces(tsl::robin_set<std::uint64_t>& squares, const std::vector<ThinSample>& samples, double H,
                   double spacing) {
    for (const ThinSample& sample : samples) {
        const double reach = sample.thickness / 2 + spacing;
        const GridCell low = GridCell::of(sample.at - Point{reach, reach}, H),
                       high = GridCell::of(sample.at + Point{reach, reach}, H);
        for (std::int32_t y = low.y; y <= high.y; ++y)
            for (std::int32_t x = low.x; x <= high.x; ++x) squares.insert(GridCell{x, y}.key());
    }
}

std::vector<ThinSample> outsideOf(const Curves& curves, double spacing,
                                  const std::vector<ThinSample>& samples) {
    if (samples.empty()) return {};
    const Interior interior(curves);
    std::vector<ThinSample> outside;
    for (const ThinSample& sample : samples)
        if (!interior.inside((1 / spacing) * sample.at)) outside.push_back(sample);
    return outside;
}

// In lattice steps, one try after the other.
constexpr double kDeeper[] = {0.25, 0.4};

// Holds the samples, and then no more parts and holes than before. What is outside then, for the curves are straight between
// the lattice's lines and cuts have been made, is held deeper.
Mended heldAndMended(RowField<float>& field, const HoldTask& task, const MendTask& mending,
                     const Progress& progress) {
    holdThin(field, task, progress);
    Mended mended = mend(field, mending, progress);
    for (const double depth : kDeeper) {
        const std::vector<ThinSample> outside = outsideOf(mended.curves, task.spacing, task.samples);
        if (outside.empty()) break;
        deepen(field, {task.outline, outside, task.H, task.spacing}, depth, progress);
        Mended again = mend(field, mending, progress);
        again.joined += mended.joined;
        again.opened += mended.opened;
        mended = std::move(again);
    }
    return mended;
}

}  // namespace

LevelHolder::LevelHolder(const RowField<float>& field, const Curves& curves)
    : outline_(field, curves),
      samples_(thinSamples(outline_)),
      before_(curves),
      pixel_(field.frame.spacing.x) {}

HeldLevel LevelHolder::hold(const RowField<float>& plain, const Progress& progress) {
    const double H = plain.frame.spacing.x / pixel_;
    const std::vector<ThinSample> samples = samplesOfLevel(samples_, outline_, H);
    HeldLevel level;
    level.facts.sampling = samplingOf(samples, H);
    level.field = plain.axis == 0 ? plain : transposed(plain);
    for (int k = 1; k < level.facts.sampling; k *= 2) level.field = onHalfSpacing(level.field);
    const RowField<float> unchanged = level.field;
    const double spacing = H / level.facts.sampling;
    Mended mended = heldAndMended(level.field, {outline_, samples, H, spacing},
                                  {before_, beforeSpacing_, samples, H, spacing, outline_.slope()}, progress);
    Change change = changeBetween(unchanged, level.field, level.facts.sampling);
    addThinPlaces(change.squares, samples, H, spacing);
    level.traced = std::move(mended.curves);
    level.curves = coarsened(level.traced, level.facts.sampling, [&](std::int32_t i, std::int32_t j) {
        return change.squares.count(GridCell{i, j}.key()) > 0;
    });
    level.facts.samples = static_cast<std::int64_t>(samples.size());
    if (!samples.empty())
        level.facts.kept = 1 - static_cast<double>(outsideOf(level.curves, spacing, samples).size()) /
                                   static_cast<double>(samples.size());
    level.facts.changed = change.count;
    level.facts.islands = mended.islands;
    level.facts.joined = mended.joined;
    level.facts.opened = mended.opened;
    level.facts.dropped = mended.dropped;
    level.facts.filled = mended.filled;
    level.facts.area = mended.area * pixel_ * pixel_;
    before_ = level.curves;
    beforeSpacing_ = spacing;
    return level;
}

}  // namespace isowave::curves2d
