#include "subdivision/curves/curve_rebuild.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>

#include "isowave/error.h"
#include "subdivision/curves/curve.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/curves/curve_limit.h"
#include "subdivision/curves/filters_on_demand.h"
#include "subdivision/curves/space_turns.h"

namespace isowave::subdivision {
namespace {

constexpr double kSameCurve = 1e-6;  // of the extent

using Vector = std::complex<double>;

Vector tangent(const Polyline& curve, std::size_t i) {
    const std::size_t n = curve.size();
    const auto at = [&](std::size_t k) {
        return Vector(curve.coordinates[2 * k], curve.coordinates[2 * k + 1]);
    };
    const std::size_t before = i > 0 ? i - 1 : curve.closed ? n - 1 : i;
    const std::size_t behind = i + 1 < n ? i + 1 : curve.closed ? 0 : i;
    return at(behind) - at(before);
}

// A turn from one tangent to the other; none where a curve stands still.
Vector turnOf(Vector from, Vector to) {
    const double size = std::abs(from) * std::abs(to);
    return size > 0 ? to * std::conj(from) / size : Vector(1);
}

// The displacements of a curve in space, before -> original, turned as before -> after is, and added to `edited`.
void addTurned(const Polyline& original, const Polyline& before, const Polyline& after, Polyline& edited) {
    const SpaceTurns turns(before, after);
    for (std::size_t i = 0; i < after.size(); ++i) {
        const auto d = [&](std::size_t c) {
            return original.coordinates[3 * i + c] - before.coordinates[3 * i + c];
        };
        const Vec3 turned = turns.turned(i, {d(0), d(1), d(2)});
        for (int c = 0; c < 3; ++c) edited.coordinates[3 * i + static_cast<std::size_t>(c)] += turned[c];
    }
}

// One level, local frames: original and edited side by side.
void refineBoth(const CurveLevels& curve, std::size_t level, const CurveFilters& filters, Polyline& original,
                Polyline& edited) {
    CurveLevels step{curve.scheme, std::move(original), {curve.details[level]}};
    original = reconstruct(step, filters);
    const Polyline before = subdivided(step, filters, 1);
    step.coarse = std::move(edited);
    edited = subdivided(step, filters, 1);
    const Polyline after = edited;
    if (curve.coarse.dimension == 3) return addTurned(original, before, after, edited);
    for (std::size_t i = 0; i < after.size(); ++i) {
        const Vector displacement(original.coordinates[2 * i] - before.coordinates[2 * i],
                                  original.coordinates[2 * i + 1] - before.coordinates[2 * i + 1]);
        const Vector turned = turnOf(tangent(before, i), tangent(after, i)) * displacement;
        edited.coordinates[2 * i] += turned.real();
        edited.coordinates[2 * i + 1] += turned.imag();
    }
}

double extentOf(const std::vector<Polyline>& curves) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0;
    for (const Polyline& curve : curves) {
        const auto d = static_cast<std::size_t>(curve.dimension);
        for (std::size_t k = 0; k < curve.coordinates.size(); ++k) {
            low[k % d] = std::min(low[k % d], curve.coordinates[k]);
            high[k % d] = std::max(high[k % d], curve.coordinates[k]);
        }
    }
    for (int c = 0; c < 3; ++c)
        if (low[c] <= high[c]) sum += (high[c] - low[c]) * (high[c] - low[c]);
    return std::sqrt(sum);
}

std::vector<Polyline> coarseOf(const CurveSet& set) {
    std::vector<Polyline> all;
    for (const CurveLevels& curve : set.curves) all.push_back(curve.coarse);
    return all;
}

std::string formOf(const Polyline& curve) {
    return fmt::format("{}, {} points in {}D", curve.closed ? "closed" : "open", curve.size(),
                       curve.dimension);
}

// Distances between the points of two curves, gathered.
class ErrorSum {
  public:
    void add(const Polyline& a, const Polyline& b) {
        const auto d = static_cast<std::size_t>(a.dimension);
        for (std::size_t k = 0; k < a.coordinates.size(); k += d) {
            double square = 0;
            for (std::size_t c = k; c < k + d; ++c)
                square += (a.coordinates[c] - b.coordinates[c]) * (a.coordinates[c] - b.coordinates[c]);
            largest_ = std::max(largest_, square);
            sum_ += square;
            ++count_;
        }
    }
    PointError error() const {
        return {count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0, std::sqrt(largest_)};
    }

  private:
    double sum_ = 0, largest_ = 0;
    std::size_t count_ = 0;
};

// Levels below this one are not wanted: without their details.
void cutOff(CurveLevels& curve, int level) {
    curve.details.erase(curve.details.begin(), curve.details.begin() + level);
}

}  // namespace

Polyline reconstructEdited(const CurveLevels& curve, const CurveFilters& filters, const Polyline& moved,
                           int level, Frames frames) {
    assert(moved.coordinates.size() == curve.coarse.coordinates.size());
    if (frames == Frames::global) {
        CurveLevels edited = curve;
        edited.coarse = moved;
        return reconstruct(edited, filters, level);
    }
    reconstruct(curve, filters, curve.levels());  // refuses parts that do not belong together
    Polyline original = curve.coarse, edited = moved;
    for (int k = curve.levels() - 1; k >= level; --k)
        refineBoth(curve, static_cast<std::size_t>(k), filters, original, edited);
    return edited;
}

void requireLikeCoarse(const CurveSet& set, const std::vector<Polyline>& curves) {
    if (curves.size() != set.curves.size())
        throw InputError(
            fmt::format("holds {} curves; the details are of {}", curves.size(), set.curves.size()));
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Polyline &found = curves[i], &expected = set.curves[i].coarse;
        if (found.size() != expected.size() || found.dimension != expected.dimension ||
            found.closed != expected.closed)
            throw InputError(fmt::format("curve {} is {}; the coarse curve of the details is {}", i,
                                         formOf(found), formOf(expected)));
    }
}

std::optional<MovedPoint> firstMovedPoint(const CurveSet& set, const std::vector<Polyline>& base) {
    const double allowed = kSameCurve * extentOf(coarseOf(set));
    for (std::size_t i = 0; i < base.size(); ++i) {
        const auto d = static_cast<std::size_t>(base[i].dimension);
        for (std::size_t p = 0; p < base[i].size(); ++p) {
            double square = 0;
            for (std::size_t c = p * d; c < (p + 1) * d; ++c)
                square += std::pow(base[i].coordinates[c] - set.curves[i].coarse.coordinates[c], 2);
            if (std::sqrt(square) > allowed) return MovedPoint{i, p, std::sqrt(square)};
        }
    }
    return std::nullopt;
}

RebuiltCurves rebuild(CurveSet set, const CurveRebuildOptions& options) {
    const std::vector<Polyline> moved = options.moved.empty() ? coarseOf(set) : options.moved;
    requireLikeCoarse(set, moved);
    const CurveScheme scheme = schemeOf(set);
    FiltersOnDemand filtersFor(scheme);
    const int depth = options.depth == kAllLevels ? set.levels : options.depth;
    if (depth > set.levels)
        throw InputError(
            fmt::format("holds details for {} levels, but {} were asked for", set.levels, depth));
    RebuiltCurves result;
    LevelsRebuildReport& report = result.report;
    ErrorSum error;
    for (std::size_t i = 0; i < set.curves.size(); ++i) {
        CurveLevels& curve = set.curves[i];
        const CurveFilters& filters = filtersFor(curve.coarse.closed);
        cutOff(curve, std::min(set.levels - depth, curve.levels()));
        report.details += detailCount(curve);
        Polyline points = reconstructEdited(curve, filters, moved[i], 0, options.frames);
        if (options.threshold || options.keep) {
            if (options.threshold) threshold(curve, *options.threshold);
            if (options.keep) keepLongest(curve, *options.keep);
            const Polyline part = reconstructEdited(curve, filters, moved[i], 0, options.frames);
            error.add(part, points);
            points = part;
        }
        report.kept += nonzeroDetailCount(curve);
        report.points += points.size();
        result.curves.push_back(std::move(points));
    }
    report.levels = depth;
    report.pieces = set.curves.size();
    report.extent = extentOf(result.curves);
    report.error = error.error();
    report.positions = options.positions;
    if (options.positions == Positions::limit) {
        const CurveLimit limit(scheme);
        for (Polyline& curve : result.curves)
            if (limit.takes(curve)) curve = limit.of(curve);
    }
    return result;
}

}  // namespace isowave::subdivision
