#include "curves2d/hold/hold.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "curves2d/hold/ascent.h"
#include "curves2d/hold/point_grid.h"

namespace isowave::curves2d {
namespace {

// Parts of H, but for the softness.
constexpr double kCell = 0.25;
constexpr double kHalfThickness = 0.45;  // at r = 1
constexpr double kDepth = 0.02;
constexpr double kMargin = 0.08;
constexpr double kNearCurve = 1.25, kNearPlane = 1.5;  // how far soft constraints lie from a sample
constexpr double kPlaneFrom = kMargin + 0.15, kPlaneTo = 0.9, kPlaneCell = 0.5;
constexpr double kTolerance = 0.005;
constexpr double kClear = 0.8;  // of an outer point's distance
constexpr double kSoft = 0.1, kHard = 0.002;
constexpr int kMostRounds = 40;

std::vector<Point> placesOf(const std::vector<ThinSample>& samples) {
    std::vector<Point> places;
    for (const ThinSample& sample : samples) places.push_back(sample.at);
    return places;
}

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
    Holder(RowField<float>& field, const Outline& outline, std::vector<ThinSample> samples, double H,
           int sampling, Point spacing)
        : field_(field),
          outline_(outline),
          samples_(std::move(samples)),
          near_(placesOf(samples_), kNearPlane * H),
          H_(H),
          half_(kHalfThickness * H / sampling),
          spacing_(spacing),
          ascent_(field) {}

    std::int64_t run(const Progress& progress) {
        addHard(kHard);
        addAlongCurve();
        addInPlane();
        const double tolerance = kTolerance * H_ * outline_.slope();
        ascent_.run(tolerance, kMostRounds, progress);
        ascent_.clear();
        addHard(0);
        ascent_.run(tolerance, kMostRounds, progress);
        return ascent_.write(field_);
    }

  private:
    double grown(const ThinSample& sample) const { return std::max(0.0, half_ - sample.thickness / 2); }

    void add(Point at, double side, double offset, double softness) {
        ascent_.add({{at.x / spacing_.x, at.y / spacing_.y}, side, offset * outline_.slope(), softness});
    }

    void addHard(double softness) {
        for (const ThinSample& sample : samples_) {
            add(sample.at, 1, kDepth * H_, softness);
            add(sample.at + half_ * sample.normal, 1, 0, softness);
            add(sample.at - half_ * sample.normal, 1, 0, softness);
        }
    }

    // Both sides of level 0's curve.
    void addAlongCurve() {
        std::vector<Point> places;
        for (const OutlinePoint& p : outline_.points()) places.push_back(p.at);
        const std::vector<std::uint32_t> chosen =
            oneOfEachCell(places, std::vector<double>(places.size(), 0), std::max(kCell * H_, 0.5));
        struct Pair {
            bool outer = false, inner = false;
            Point out, in;
        };
        std::vector<Pair> pairs(chosen.size());
        tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
            const OutlinePoint& p = outline_.points()[chosen[i]];
            const auto nearest = near_.nearest(p.at, kNearCurve * H_);
            if (!nearest) return;
            const ThinSample& sample = samples_[nearest->index];
            const double out = grown(sample) + kMargin * H_;
            const Interior& interior = outline_.interior();
            pairs[i].out = p.at + out * p.normal;
            pairs[i].outer = interior.away(pairs[i].out, out) >= kClear * out;
            pairs[i].in = p.at - kMargin * H_ * p.normal;
            pairs[i].inner =
                sample.thickness / 2 - kMargin * H_ > half_ && interior.inside(pairs[i].in);
        });
        for (const Pair& pair : pairs) {
            if (pair.outer) add(pair.out, -1, 0, kSoft);
            if (pair.inner) add(pair.in, 1, 0, kSoft);
        }
    }

    // Points farther out.
    void addInPlane() {
        const double cell = kPlaneCell * H_;
        const std::vector<Point> points = pointsNearSamples(cell);
        std::vector<char> wanted(points.size(), 0);
        tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            const auto nearest = near_.nearest(points[i], kNearPlane * H_);
            if (!nearest) return;
            const double e = grown(samples_[nearest->index]), to = e + kPlaneTo * H_;
            const double away = outline_.interior().away(points[i], to);
            wanted[i] = away > e + kPlaneFrom * H_ && away < to;
        });
        for (std::size_t i = 0; i < points.size(); ++i)
            if (wanted[i]) add(points[i], -1, 0, kSoft);
    }

    // The corners of all cells within reach of a sample, row by row.
    std::vector<Point> pointsNearSamples(double cell) const {
        const auto reach = static_cast<std::int32_t>(std::ceil(kNearPlane * H_ / cell));
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
    double H_, half_;
    Point spacing_;
    Ascent ascent_;
};

}  // namespace

int samplingOf(const std::vector<ThinSample>& samples, double H) {
    for (const int sampling : {1, 2}) {
        const double half = kHalfThickness * H / sampling;
        const auto swollen =
            std::count_if(samples.begin(), samples.end(),
                          [&](const ThinSample& sample) { return 2 * half > 1.5 * sample.thickness; });
        if (20 * swollen <= static_cast<std::ptrdiff_t>(samples.size())) return sampling;
    }
    return 4;
}

std::int64_t holdThin(RowField<float>& field, const Outline& outline, const std::vector<ThinSample>& samples,
                      double H, int sampling, Point spacing, const Progress& progress) {
    assert(field.axis == 0);
    if (samples.empty()) return 0;
    return Holder(field, outline, thinnestOfEachCell(samples, kCell * H), H, sampling, spacing).run(progress);
}

}  // namespace isowave::curves2d
