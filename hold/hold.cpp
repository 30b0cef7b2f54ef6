// apply = samples that are thin here -> rows (hard, beside the surface, farther out) -> ascent -> hard rows alone
#include "hold/hold.h"

#include <openvdb/tools/Morphology.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "hold/point_grid.h"
#include "volume/mesh_nearest.h"
#include "volume/row_ascent.h"
#include "volume/walls/one_per_cell.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using openvdb::Vec3f;

constexpr double kSamplesReachSurface = 1.25, kSamplesReachOut = 1.5;  // of H
constexpr double kAwayReach = 1.6;  // of H: where it is asked how far the surface is, up to here
constexpr double kFewThin = 0.01;   // of the surface: so little asks for no finer sampling of all of it
constexpr double kCoarse = 3,
                 kFewCoarse = 0.1;  // of H, of the surface: what one sample a voxel cuts the corners off
constexpr double kFewThickened = 0.002, kFewThickenedAtLevel1 = 0.05;  // of what is thin
constexpr double kLongestRun = 2;     // of H: a longer one runs along a wall rather than across it
constexpr double kKnownDistance = 3;  // voxels: level 0's field is a distance up to there

// n things in parallel, in pieces that cancel.
template <class Body>
void forEach(std::size_t n, const Progress& progress, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 256), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

// Which of n places are kept, as onePerCell() keeps them, in their own order.
template <class PlaceOf, class KeyOf>
std::vector<std::uint32_t> onePlacePerCell(std::size_t n, const Vec3d& cell, const PlaceOf& placeOf,
                                           const KeyOf& keyOf) {
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::uint32_t> kept = onePerCell(all, cell, placeOf, keyOf);
    std::sort(kept.begin(), kept.end());
    return kept;
}

// Index space of level 0 -> that of a level.
struct LevelScale {
    Vec3d h;   // the level's voxel on each axis, in voxels of level 0
    double H;  // its mean

    LevelScale(const BSplineField& finest, const BSplineField& level)
        : h(level.transform().voxelSize() / finest.transform().voxelSize()),
          H(std::cbrt(h[0] * h[1] * h[2])) {}
    Vec3d toLevel(const Vec3d& at, const Vec3d& origin) const { return (at - origin) / h; }
    // The level's voxel along a direction.
    double along(const Vec3f& n) const { return (Vec3d(n) * h).length(); }
};

// The mean length of the gradient of F at the surface.
double slopeOf(const BSplineField& field, const FinestSurface& surface) {
    constexpr std::size_t kAsked = 2000;
    const std::size_t stride = surface.points.size() / kAsked + 1;
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < surface.points.size(); i += stride, ++count)
        sum += evaluateGradient(field, surface.points[i]).length();
    return count > 0 ? sum / count : 1;
}

// How far a place is from level 0's solid; 0 inside.
class Away {
  public:
    Away(const BSplineField& finest, double slope, const std::vector<Vec3d>& surface)
        : finest_(finest), slope_(slope) {
        std::vector<Triangle> each(surface.size());
        for (std::uint32_t i = 0; i < each.size(); ++i) each[i] = {i, i, i};
        points_.emplace(surface, each);
    }
    // `reach` where it is at least that.
    double at(const Vec3d& place, double reach) const {
        const double near = evaluate(finest_, place) / slope_;
        if (near < kKnownDistance) return std::clamp(near, 0.0, reach);
        return std::max(kKnownDistance, std::sqrt(points_->nearest(place, {reach * reach, -1}).squared));
    }

  private:
    const BSplineField& finest_;
    double slope_;
    std::optional<TriangleHierarchy> points_;
};

// The rows of one level.
class Rows {
  public:
    Rows(const FinestSurface& surface, const BSplineField& finest, double slope, const BSplineField& level,
         int refine, const HoldOptions& options, const Progress& progress)
        : surface_(surface),
          finest_(finest),
          slope_(slope),
          scale_(finest, level),
          origin_(finest.transform().worldToIndex(level.transform().indexToWorld(Vec3d(0)))),
          refine_(refine),
          options_(options),
          progress_(progress) {}

    bool isThin(const ThinSample& s) const {
        const double H = scale_.along(s.normal);
        return s.thickness <= options_.longest * H && s.length <= kLongestRun * H &&
               s.partVolume >= scale_.h[0] * scale_.h[1] * scale_.h[2];
    }

    bool isCoarse(const ThinSample& s) const {
        return s.thickness <= kCoarse * scale_.along(s.normal) &&
               s.partVolume >= scale_.h[0] * scale_.h[1] * scale_.h[2];
    }

    void choose(const std::vector<ThinSample>& samples) {
        std::vector<ThinSample> thin;
        for (const ThinSample& s : samples)
            if (isThin(s)) thin.push_back(s);
        const auto kept = onePlacePerCell(
            thin.size(), cell(), [&](std::uint32_t i) { return Vec3d(thin[i].at); },
            [&](std::uint32_t i) { return thin[i].thickness; });
        for (const std::uint32_t i : kept) samples_.push_back(thin[i]);
    }

    void chooseGaps() {
        if (options_.closedGaps <= 0) return;
        const double longest = kLongestRun * std::max({scale_.h[0], scale_.h[1], scale_.h[2]});
        for (const ThinSample& s : thinSamplesOf(surface_, longest, Side::outside, progress_))
            if (s.thickness <= options_.closedGaps * scale_.along(s.normal)) gaps_.push_back(Vec3d(s.at));
        const auto kept = onePlacePerCell(
            gaps_.size(), cell(), [&](std::uint32_t i) { return gaps_[i]; },
            [](std::uint32_t) { return 0.0; });
        std::vector<Vec3d> chosen;
        for (const std::uint32_t i : kept) chosen.push_back(gaps_[i]);
        gaps_ = std::move(chosen);
    }

    void add() {
        for (const Vec3d& x : gaps_) hard_.push_back(row(x, 1, options_.depth * scale_.H, options_.rhoHard));
        if (samples_.empty()) return;
        std::vector<Vec3f> at;
        for (const ThinSample& s : samples_) at.push_back(s.at);
        grid_.emplace(at, scale_.H);
        chooseSurface();
        std::vector<Vec3d> points;
        for (const std::uint32_t i : near_) points.push_back(surface_.points[i]);
        if (points.empty()) points.push_back(Vec3d(samples_.front().at));
        away_.emplace(finest_, slope_, points);
        addHard();
        addBesideSurface();
        addFartherOut();
    }

    const std::vector<ThinSample>& samples() const { return samples_; }
    const std::vector<Vec3d>& gaps() const { return gaps_; }
    const std::vector<FieldRow>& hard() const { return hard_; }
    const std::vector<FieldRow>& soft() const { return soft_; }
    double meanVoxel() const { return scale_.H; }
    double tolerance() const { return 0.005 * scale_.H * slope_; }
    Vec3d toLevel(const Vec3d& at) const { return scale_.toLevel(at, origin_); }
    // By how much the wall is thickened on either side.
    double grown(const ThinSample& s) const { return std::max(0.0, half(s) - s.thickness / 2); }

  private:
    Vec3d cell() const { return scale_.h / options_.density; }
    double half(const ThinSample& s) const {
        return options_.leastThickness * scale_.along(s.normal) / (2 * refine_);
    }
    FieldRow row(const Vec3d& at, float sign, double bound, double rho) const {
        return {toLevel(at), sign, static_cast<float>(bound * slope_), static_cast<float>(rho), false};
    }

    // The level's cells that hold every point of the surface that is asked for: places lie so far from a sample, and points
    // are looked for so far from a place.
    openvdb::MaskTree cellsAround() const {
        const Vec3d h = scale_.h;
        const double H = scale_.H, widest = std::max({h[0], h[1], h[2]}),
                     fartherOut = (kSamplesReachOut + kAwayReach) * H,
                     beside = kSamplesReachSurface * H +
                              3 * (options_.leastThickness / 2 * widest + options_.margin * H),
                     reach = std::max(fartherOut, beside) / std::min({h[0], h[1], h[2]});
        openvdb::MaskTree cells;
        openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor(cells);
        for (const ThinSample& s : samples_) accessor.setValueOn(Coord::floor(Vec3d(s.at) / h));
        openvdb::tools::dilateActiveValues(cells, static_cast<int>(std::ceil(reach)) + 1,
                                           openvdb::tools::NN_FACE_EDGE_VERTEX, openvdb::tools::EXPAND_TILES);
        return cells;
    }
    // Points of the surface in these, ascending.
    std::vector<std::uint32_t> surfaceAround() const {
        const openvdb::MaskTree cells = cellsAround();
        tbb::enumerable_thread_specific<std::vector<std::uint32_t>> found;
        tbb::parallel_for(
            tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(surface_.points.size()), 4096),
            [&](const auto& range) {
                progress_.check();
                const openvdb::tree::ValueAccessor<const openvdb::MaskTree> accessor(cells);
                std::vector<std::uint32_t>& mine = found.local();
                for (std::uint32_t i = range.begin(); i != range.end(); ++i)
                    if (accessor.isValueOn(Coord::floor(surface_.points[i] / scale_.h))) mine.push_back(i);
            });
        std::vector<std::uint32_t> all;
        for (const auto& mine : found) all.insert(all.end(), mine.begin(), mine.end());
        tbb::parallel_sort(all.begin(), all.end());
        return all;
    }

    void chooseSurface() {
        const Vec3d size = openvdb::math::maxComponent(cell(), Vec3d(0.5));
        near_ = onePerCell(
            surfaceAround(), size, [&](std::uint32_t i) { return surface_.points[i]; },
            [](std::uint32_t) { return 0.0; });
        std::sort(near_.begin(), near_.end());
        sampleOf_.assign(near_.size(), PointGrid::kNone);
        forEach(near_.size(), progress_, [&](std::size_t i) {
            sampleOf_[i] = grid_->nearest(surface_.points[near_[i]], kSamplesReachSurface * scale_.H).index;
        });
    }

    void addHard() {
        for (const ThinSample& s : samples_) {
            const Vec3d x(s.at), step = half(s) * Vec3d(s.normal);
            hard_.push_back(row(x, 1, options_.depth * scale_.H, options_.rhoHard));
            hard_.push_back(row(x + step, 1, 0, options_.rhoHard));
            hard_.push_back(row(x - step, 1, 0, options_.rhoHard));
        }
    }

    void addBesideSurface() {
        const double margin = options_.margin * scale_.H;
        std::vector<std::array<FieldRow, 2>> rows(near_.size());
        std::vector<std::array<bool, 2>> wanted(near_.size());
        forEach(near_.size(), progress_, [&](std::size_t i) {
            if (sampleOf_[i] == PointGrid::kNone) return;
            const ThinSample& s = samples_[sampleOf_[i]];
            const Vec3d p = surface_.points[near_[i]], N(surface_.normals[near_[i]]);
            const double out = grown(s) + margin;
            const Vec3d outer = p + out * N, inner = p - margin * N;
            rows[i][0] = row(outer, -1, 0, options_.rho);
            wanted[i][0] = away_->at(outer, 2 * out) >= 0.8 * out;  // not in another wall
            rows[i][1] = row(inner, 1, 0, options_.rho);
            wanted[i][1] = s.thickness / 2 - margin > half(s) && evaluate(finest_, inner) < 0;
        });
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (int k = 0; k < 2; ++k)
                if (wanted[i][k]) soft_.push_back(rows[i][k]);
    }

    // Places of a lattice of H/2 within reach of a sample, in the order of its leaves.
    std::vector<Vec3d> placesAround(const Vec3d& step) const {
        openvdb::MaskTree mask;
        openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor(mask);
        for (const ThinSample& s : samples_) accessor.setValueOn(Coord::round(Vec3d(s.at) / step));
        const int reach =
            static_cast<int>(std::ceil(kSamplesReachOut * scale_.H / std::min({step[0], step[1], step[2]})));
        openvdb::tools::dilateActiveValues(mask, std::min(reach, 4), openvdb::tools::NN_FACE_EDGE_VERTEX,
                                           openvdb::tools::EXPAND_TILES);
        std::vector<Vec3d> places;
        mask.voxelizeActiveTiles();
        for (auto voxel = mask.cbeginValueOn(); voxel; ++voxel)
            places.push_back(voxel.getCoord().asVec3d() * step);
        return places;
    }

    void addFartherOut() {
        const Vec3d step = openvdb::math::maxComponent(scale_.h / 2, Vec3d(1));
        const std::vector<Vec3d> places = placesAround(step);
        std::vector<char> wanted(places.size());
        const double H = scale_.H, first = options_.margin + 0.15;
        forEach(places.size(), progress_, [&](std::size_t i) {
            const PointGrid::Nearest near = grid_->nearest(places[i], kSamplesReachOut * H);
            if (near.index == PointGrid::kNone) return;
            const double e = grown(samples_[near.index]), g = away_->at(places[i], kAwayReach * H);
            wanted[i] = g > 0 && g < kAwayReach * H && g > e + first * H && g < e + 0.9 * H;
        });
        for (std::size_t i = 0; i < places.size(); ++i)
            if (wanted[i]) soft_.push_back(row(places[i], -1, 0, options_.rho));
    }

    const FinestSurface& surface_;
    const BSplineField& finest_;
    double slope_;
    LevelScale scale_;
    Vec3d origin_;  // of the level's index space, in that of level 0
    int refine_;
    HoldOptions options_;
    const Progress& progress_;
    std::vector<ThinSample> samples_;
    std::vector<Vec3d> gaps_;              // to fill, their middles
    std::optional<PointGrid> grid_;        // of the samples
    std::vector<std::uint32_t> near_;      // points of the surface, one a cell
    std::vector<std::uint32_t> sampleOf_;  // of each the nearest sample
    std::optional<Away> away_;
    std::vector<FieldRow> hard_, soft_;
};

std::int64_t countInside(const BSplineField& level, const Rows& rows) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, rows.samples().size(), 1024), std::int64_t{0},
        [&](const auto& range, std::int64_t count) {
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                count += evaluate(level, rows.toLevel(Vec3d(rows.samples()[i].at))) < 0;
            return count;
        },
        std::plus<>());
}

}  // namespace

LevelHold::LevelHold(FinestSurface surface, BSplineField finest, const Progress& progress)
    : surface_(std::move(surface)),
      finest_(std::move(finest)),
      slope_(slopeOf(finest_, surface_)),
      area_(areaOf(surface_)),
      samples_(thinSamplesOf(surface_, std::numeric_limits<double>::infinity(), Side::inside, progress)) {}

int LevelHold::refineFor(const BSplineField& level, const HoldOptions& options) const {
    const Rows rows(surface_, finest_, slope_, level, 2, options, {});
    double thin = 0, thickened = 0, coarse = 0;
    for (const ThinSample& s : samples_) {
        if (rows.isCoarse(s)) coarse += s.area;
        if (!rows.isThin(s)) continue;
        thin += s.area;
        if (rows.grown(s) > 0) thickened += s.area;
    }
    if (2 * thin <= kFewThin * area_) return 2 * coarse <= kFewCoarse * area_ ? 1 : 2;
    // At level 1 four samples are four times level 0's triangles, at level 2 as many, from level 3 on few.
    const double H = rows.meanVoxel(), few = H < 3 ? kFewThickenedAtLevel1 : H < 7 ? kFewThickened : 0;
    return thickened > few * thin ? 4 : 2;
}

HoldReport LevelHold::apply(BSplineField& level, int refine, const HoldOptions& options,
                            const Progress& progress) const {
    constexpr int kRounds = 40, kInner = 12;
    HoldReport report;
    Rows rows(surface_, finest_, slope_, level, refine, options, progress);
    rows.choose(samples_);
    rows.chooseGaps();
    report.samples = static_cast<std::int64_t>(rows.samples().size());
    report.gaps = static_cast<std::int64_t>(rows.gaps().size());
    if (report.samples == 0 && report.gaps == 0) return report;
    rows.add();
    for (const ThinSample& s : rows.samples()) report.thickened += rows.grown(s) > 0;
    report.insideBefore = countInside(level, rows);
    const AscentOptions ascent{rows.tolerance(), kRounds, kInner};
    std::vector<FieldRow> all = rows.hard();
    all.insert(all.end(), rows.soft().begin(), rows.soft().end());
    report.rows = static_cast<std::int64_t>(all.size());
    level.controlPoints = level.controlPoints->deepCopy();
    const AscentReport first = ascend(level, all, ascent, progress);
    std::vector<FieldRow> hard = rows.hard();
    for (FieldRow& row : hard) row.rho = 0;
    const AscentReport last = ascend(level, hard, ascent, progress);
    report.rounds = first.rounds + last.rounds;
    report.unmet = last.unmet;
    report.settled = first.settled && last.settled;
    report.changed = std::max(first.changed, last.changed);
    report.inside = countInside(level, rows);
    return report;
}

}  // namespace isowave
