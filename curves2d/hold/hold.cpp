#include "curves2d/hold/hold.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "curves2d/hold/ascent.h"
#include "curves2d/hold/point_grid.h"

namespace isowave::curves2d {
namespace {

// In steps h of the lattice, but for the reach, in pixels H of the level, and the softness.
constexpr double kCell = 0.25;
constexpr double kHalfThickness = 0.45;
constexpr double kDepth = 0.1;
constexpr double kMargin = 0.02;
constexpr double kPlaneFrom = 0.17, kPlaneTo = 0.9, kPlaneCell = 0.5;
constexpr double kTolerance = 0.005;
constexpr double kClear = 0.8;  // of an outer point's distance
constexpr double kCurveReach = 1.25, kPlaneReach = 1.5;
constexpr double kSoft = 0.005, kHard = 0.002;
constexpr int kSoftRounds = 8, kMostRounds = 40;
constexpr int kFinest = 4, kOfSamples = 50;

std::vector<ThinSample> thinnestOfEachCell(const std::vector<ThinSample>& samples, double cell) {
    std::vector<double> thickness;
    for (const ThinSample& sample : samples) thickness.push_back(sample.thickness);
    std::vector<ThinSample> chosen;
    for (const std::uint32_t i : oneOfEachCell(placesOf(samples), thickness, cell))
        chosen.push_back(samples[i]);
    return chosen;
}

// Collects the constraints of one level and lets them act.
class Holder {
  public:
    Holder(RowField<float>& field, const HoldTask& task)
        : field_(field),
          outline_(task.outline),
          samples_(thinnestOfEachCell(task.samples, kCell * task.spacing)),
          near_(placesOf(samples_), task.spacing),
          H_(task.H),
          h_(task.spacing),
          half_(kHalfThickness * h_),
          ascent_(field) {}

    void run(const Progress& progress) {
        addHard(kHard);
        addAlongCurve();
        addInPlane();
        const double tolerance = kTolerance * h_ * outline_.slope();
        ascent_.run(tolerance, kSoftRounds, progress);
        ascent_.clear();
        addHard(0);
        ascent_.run(tolerance, kMostRounds, progress);
        ascent_.write(field_);
    }

  private:
    double grown(const ThinSample& sample) const { return std::max(0.0, half_ - sample.thickness / 2); }

    void add(Point at, double side, double offset, double softness) {
        ascent_.add({(1 / h_) * at, side, offset * outline_.slope(), softness});
    }

    void addHard(double softness) {
        for (const ThinSample& sample : samples_) {
            add(sample.at, 1, kDepth * h_, softness);
            add(sample.at + half_ * sample.normal, 1, 0, softness);
            add(sample.at - half_ * sample.normal, 1, 0, softness);
        }
    }

    // Both sides of level 0's curve.
    void addAlongCurve() {
        std::vector<Point> places;
        for (const OutlinePoint& p : outline_.points()) places.push_back(p.at);
        const std::vector<std::uint32_t> chosen =
            oneOfEachCell(places, std::vector<double>(places.size(), 0), std::max(kCell * h_, 0.5));
        struct Pair {
            bool outer = false, inner = false;
            Point out, in;
        };
        std::vector<Pair> pairs(chosen.size());
        tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
            const OutlinePoint& p = outline_.points()[chosen[i]];
            const auto nearest = near_.nearest(p.at, kCurveReach * H_);
            if (!nearest) return;
            const ThinSample& sample = samples_[nearest->index];
            const double out = grown(sample) + kMargin * h_;
            const Interior& interior = outline_.interior();
            pairs[i].out = p.at + out * p.normal;
            pairs[i].outer = interior.away(pairs[i].out, out) >= kClear * out;
            pairs[i].in = p.at - kMargin * h_ * p.normal;
            pairs[i].inner = sample.thickness / 2 - kMargin * h_ > half_ && interior.inside(pairs[i].in);
        });
        for (const Pair& pair : pairs) {
            if (pair.outer) add(pair.out, -1, 0, kSoft);
            if (pair.inner) add(pair.in, 1, 0, kSoft);
        }
    }

    // Points farther out.
    void addInPlane() {
        const double cell = kPlaneCell * h_;
        const std::vector<Point> points = pointsNearSamples(cell);
        std::vector<char> wanted(points.size(), 0);
        tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            const auto nearest = near_.nearest(points[i], kPlaneReach * H_);
            if (!nearest) return;
            const double e = grown(samples_[nearest->index]), to = e + kPlaneTo * h_;
            const double away = outline_.interior().away(points[i], to);
            wanted[i] = away > e + kPlaneFrom * h_ && away < to;
        });
        for (std::size_t i = 0; i < points.size(); ++i)
            if (wanted[i]) add(points[i], -1, 0, kSoft);
    }

    // The corners of all cells within reach of a sample, row by row.
    std::vector<Point> pointsNearSamples(double cell) const {
        const auto reach = static_cast<std::int32_t>(std::ceil(kPlaneReach * H_ / cell));
        tsl::robin_map<std::int32_t, Spans> rows;
        for (const ThinSample& sample : samples_) {
            const GridCell at = GridCell::of(sample.at, cell);
            for (std::int32_t y = at.y - reach; y <= at.y + reach + 1; ++y) {
                Spans& row = rows[y];
                const Span span{at.x - reach, at.x + reach + 1};
                if (row.empty() || row.back() != span) row.push_back(span);
            }
        }
        std::vector<std::int32_t> numbers;
        for (const auto& [y, row] : rows) numbers.push_back(y);
        std::sort(numbers.begin(), numbers.end());
        std::vector<Point> points;
        for (const std::int32_t y : numbers) {
            Spans row = rows[y];
            normalise(row);
            for (const Span& span : row)
                for (std::int32_t x = span.first; x <= span.last; ++x) points.push_back({cell * x, cell * y});
        }
        return points;
    }

    RowField<float>& field_;
    const Outline& outline_;
    std::vector<ThinSample> samples_;
    PointGrid near_;
    double H_, h_, half_;
    Ascent ascent_;
};

}  // namespace

int samplingOf(const std::vector<ThinSample>& samples, double H) {
    int sampling = 1;
    const auto isThickened = [&](const ThinSample& sample) {
        return 2 * kHalfThickness * H / sampling > sample.thickness;
    };
    for (; sampling < kFinest; sampling *= 2)
        if (kOfSamples * std::count_if(samples.begin(), samples.end(), isThickened) <=
            static_cast<std::ptrdiff_t>(samples.size()))
            break;
    return sampling;
}

void deepen(RowField<float>& field, const HoldTask& task, double depth, const Progress& progress) {
    Ascent ascent(field);
    const double unit = task.spacing * task.outline.slope();
    for (const ThinSample& sample : task.samples)
        ascent.add({(1 / task.spacing) * sample.at, 1, depth * unit, 0});
    ascent.run(kTolerance * unit, kMostRounds, progress);
    ascent.write(field);
}

void holdThin(RowField<float>& field, const HoldTask& task, const Progress& progress) {
    assert(field.axis == 0);
    if (!task.samples.empty()) Holder(field, task).run(progress);
}

}  // namespace isowave::curves2d
