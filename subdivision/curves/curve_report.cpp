#include "subdivision/curves/curve_report.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "isowave/error.h"
#include "subdivision/curves/curve.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/curves/curve_limit.h"
#include "subdivision/curves/filters_on_demand.h"

namespace isowave::subdivision {

namespace {

CurveScheme schemeOf(const CurveReportOptions& options) {
    return options.mask.empty() ? curveScheme(options.scheme) : maskScheme(options.mask, options.width);
}

double errorOf(const Polyline& curve, const CurveFilters& filters, int levels) {
    const CurveLevels parts = decompose(curve, filters, levels);
    return l2Distance(subdivided(parts, filters, levels), curve);
}

double largestDifference(const Polyline& a, const Polyline& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.coordinates.size(); ++i)
        most = std::max(most, std::abs(a.coordinates[i] - b.coordinates[i]));
    return most;
}

// Curves without a length stay as they are.
void resampleAll(std::vector<Polyline>& curves, std::size_t count) {
    if (count < 2) throw InputError("curve", "cannot be resampled to fewer than 2 points");
    for (Polyline& curve : curves) {
        const bool hasLength = std::adjacent_find(curve.coordinates.begin(), curve.coordinates.end(),
                                                  std::not_equal_to<>()) != curve.coordinates.end();
        if (curve.size() >= 2 && hasLength) curve = resampled(curve, count);
    }
}

// Every level of one curve, into the report.
CurveReport::Curve levelsOf(const Polyline& curve, const CurveLevels& parts, const CurveFilters& filters,
                            CurveReport& report) {
    CurveReport::Curve row;
    row.dimension = curve.dimension;
    row.closed = curve.closed;
    for (int k = 0; k <= report.levels; ++k) {
        const Polyline points = reconstruct(parts, filters, std::min(k, parts.levels()));
        report.atLevel[static_cast<std::size_t>(k)].push_back(points);
        if (k > parts.levels()) continue;
        row.points.push_back(points.size());
        row.error.push_back(l2Distance(subdivided(parts, filters, k), curve));
        if (k == 0) row.roundTrip = largestDifference(points, curve);
    }
    report.smooth.push_back(subdivided(parts, filters, parts.levels()));
    row.details = row.detailsLeft = detailCount(parts);
    return row;
}

void dropDetails(const Polyline& curve, CurveLevels& parts, const CurveFilters& filters,
                 const CurveReportOptions& options, CurveReport::Curve& row, CurveReport& report) {
    if (options.keep) keepLongest(parts, *options.keep);
    if (options.threshold) threshold(parts, *options.threshold);
    row.detailsLeft = nonzeroDetailCount(parts);
    report.thresholded.push_back(reconstruct(parts, filters));
    row.thresholdError = l2Distance(report.thresholded.back(), curve);
}

// All curves of the report at their limits. Those that have none stay, and are counted once.
void moveToLimit(const CurveLimit& limit, CurveReport& report) {
    const auto move = [&](std::vector<Polyline>& curves) {
        for (Polyline& curve : curves)
            if (limit.takes(curve)) curve = limit.of(curve);
    };
    const auto& coarsest = report.atLevel.back();
    report.withoutLimit = static_cast<std::size_t>(std::count_if(
        coarsest.begin(), coarsest.end(), [&](const Polyline& curve) { return !limit.takes(curve); }));
    for (auto& curves : report.atLevel) move(curves);
    move(report.smooth);
    move(report.thresholded);
}

const Polyline& longest(const std::vector<Polyline>& curves) {
    return *std::max_element(curves.begin(), curves.end(),
                             [](const auto& a, const auto& b) { return a.size() < b.size(); });
}

}  // namespace

CurveReport reportCurves(std::vector<Polyline> curves, const CurveReportOptions& options) {
    FiltersOnDemand filtersFor(schemeOf(options));
    std::map<std::string, FiltersOnDemand> compared;
    if (options.compare)
        for (const char* name : kComparedSchemes) compared.emplace(name, FiltersOnDemand(curveScheme(name)));
    CurveReport report;
    report.scheme = schemeOf(options).name;
    report.levels = options.levels;
    report.atLevel.resize(static_cast<std::size_t>(std::max(0, options.levels)) + 1);
    report.positions = options.positions;
    std::optional<CurveLimit> limit;
    if (options.positions == Positions::limit) limit.emplace(schemeOf(options));
    if (options.resample) resampleAll(curves, *options.resample);
    CurveSet set{options.mask.empty() ? report.scheme : "", options.mask, options.width, 0, {}};
    for (const Polyline& curve : curves) {
        const CurveFilters& filters = filtersFor(curve.closed);
        const int levels = std::min(options.levels, filters.mostLevels(curve.size()));
        report.tooShort += levels < options.levels;
        CurveLevels parts = decompose(curve, filters, levels);
        CurveReport::Curve row = levelsOf(curve, parts, filters, report);
        for (auto& [name, other] : compared)
            row.compared[name] = errorOf(curve, other(curve.closed),
                                         std::min(levels, other(curve.closed).mostLevels(curve.size())));
        if (options.threshold || options.keep) dropDetails(curve, parts, filters, options, row, report);
        report.curves.push_back(std::move(row));
        set.levels = std::max(set.levels, levels);
        if (options.details) set.curves.push_back(std::move(parts));
    }
    if (report.tooShort == curves.size() && options.levels > 0) {
        // Says how many points the longest one lacks.
        const Polyline& most = longest(curves);
        decompose(most, filtersFor(most.closed), options.levels);
    }
    if (options.details) report.details = curveDetailsBytes(set);
    if (limit) moveToLimit(*limit, report);
    return report;
}

}  // namespace isowave::subdivision
