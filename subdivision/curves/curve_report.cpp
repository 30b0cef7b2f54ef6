#include "subdivision/curves/curve_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

constexpr const char* kCompared[] = {"dlg-trial", "dlg-refined", "dlg-optimal"};
// O-T1, row "Coast": 4096 points, 6 levels.
constexpr double kPublishedCoast[] = {382.8, 327.9, 326.0};

CurveScheme schemeOf(const CurveReportOptions& options) {
    if (options.mask.empty()) return curveScheme(options.scheme);
    const Mask mask = customMask(Lattice::Line, parseRationals(options.mask));
    const int width = options.width ? options.width : smallestWidth(mask, 41).value_or(1);
    construct(mask, width);  // says what is wrong
    return ownScheme(mask, width);
}

// Filters for open and for closed curves, made when the first such curve comes.
class FiltersOnDemand {
  public:
    explicit FiltersOnDemand(CurveScheme scheme) : scheme_(std::move(scheme)) {}
    const CurveFilters& operator()(bool closed) {
        auto& filters = closed ? closed_ : open_;
        if (!filters) filters.emplace(scheme_, closed);
        return *filters;
    }

  private:
    CurveScheme scheme_;
    std::optional<CurveFilters> open_, closed_;
};

double errorOf(const Polyline& curve, const CurveFilters& filters, int levels) {
    const CurveLevels made = decompose(curve, filters, levels);
    return l2Distance(subdivided(made, filters, levels), curve);
}

}  // namespace

CurveReport reportCurves(const CurveFile& file, const std::string& extension,
                         const CurveReportOptions& options) {
    FiltersOnDemand filtersFor(schemeOf(options));
    std::map<std::string, FiltersOnDemand> compared;
    if (options.compare) {
        for (const char* name : kCompared) compared.emplace(name, FiltersOnDemand(curveScheme(name)));
    }
    CurveReport report;
    report.scheme = schemeOf(options).name;
    report.levels = options.levels;

    std::vector<Polyline> curves = file.curves();
    if (options.resample) {
        if (*options.resample < 2) throw InputError("curve", "cannot be resampled to fewer than 2 points");
        for (Polyline& curve : curves) {
            const bool hasLength = std::adjacent_find(curve.coordinates.begin(), curve.coordinates.end(),
                                                      std::not_equal_to<>()) != curve.coordinates.end();
            if (curve.size() >= 2 && hasLength) curve = resampled(curve, *options.resample);
        }
    }
    std::size_t shorter = 0;
    std::vector<std::vector<Polyline>> at(static_cast<std::size_t>(std::max(0, options.levels)) + 1);
    std::vector<Polyline> smooth, thresholded;
    for (const Polyline& curve : curves) {
        const CurveFilters& filters = filtersFor(curve.closed);
        const int levels = std::min(options.levels, filters.mostLevels(curve.size()));
        shorter += levels < options.levels;
        CurveLevels made = decompose(curve, filters, levels);

        CurveReport::Curve row;
        row.dimension = curve.dimension;
        row.closed = curve.closed;
        for (int k = 0; k <= options.levels; ++k) {
            const Polyline points = reconstruct(made, filters, std::min(k, levels));
            at[static_cast<std::size_t>(k)].push_back(points);
            if (k > levels) continue;
            row.points.push_back(points.size());
            row.error.push_back(l2Distance(subdivided(made, filters, k), curve));
            if (k > 0) continue;
            for (std::size_t i = 0; i < points.coordinates.size(); ++i) {
                row.roundTrip =
                    std::max(row.roundTrip, std::abs(points.coordinates[i] - curve.coordinates[i]));
            }
        }
        smooth.push_back(subdivided(made, filters, levels));
        for (auto& [name, other] : compared)
            row.compared[name] = errorOf(curve, other(curve.closed),
                                         std::min(levels, other(curve.closed).mostLevels(curve.size())));
        row.details = row.detailsLeft = detailCount(made);
        if (options.threshold || options.keep) {
            if (options.keep) keepLongest(made, *options.keep);
            if (options.threshold) threshold(made, *options.threshold);
            row.detailsLeft = nonzeroDetailCount(made);
            thresholded.push_back(reconstruct(made, filters));
            row.thresholdError = l2Distance(thresholded.back(), curve);
        }
        report.curves.push_back(std::move(row));
    }
    if (shorter == curves.size() && options.levels > 0) {
        // Says how many points the longest one lacks.
        const auto longest = std::max_element(
            curves.begin(), curves.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
        decompose(*longest, filtersFor(longest->closed), options.levels);
    }
    if (shorter > 0) {
        report.remarks.push_back(
            fmt::format("{} of {} curves are too short for {} levels and stay at the coarsest they have",
                        shorter, curves.size(), options.levels));
    }
    for (std::size_t k = 0; k < at.size(); ++k)
        report.files[fmt::format("level_{}{}", k, extension)] = file.with(at[k]);
    report.files["smooth" + extension] = file.with(smooth);
    if (!thresholded.empty()) report.files["thresholded" + extension] = file.with(thresholded);
    return report;
}

std::string text(const CurveReport& report) {
    std::string out = fmt::format("{}, {} levels, {} curve{}\n", report.scheme, report.levels,
                                  report.curves.size(), report.curves.size() == 1 ? "" : "s");
    const std::size_t shown = std::min<std::size_t>(report.curves.size(), 20);
    for (std::size_t c = 0; c < shown; ++c) {
        const auto& curve = report.curves[c];
        out +=
            fmt::format("\ncurve {}: {}, {}D, round trip {:.1e}\n  level   points    L2 error of P alone\n",
                        c + 1, curve.closed ? "closed" : "open", curve.dimension, curve.roundTrip);
        for (std::size_t k = 0; k < curve.points.size(); ++k) {
            out += fmt::format("  {:5} {:8}    {:.6g}\n", k, curve.points[k], curve.error[k]);
        }
        if (curve.detailsLeft != curve.details) {
            out += fmt::format("  {} of {} details left, L2 error {:.6g}\n", curve.detailsLeft, curve.details,
                               curve.thresholdError);
        }
    }
    if (shown < report.curves.size())
        out += fmt::format("\n.. and {} more (--json has all)\n", report.curves.size() - shown);

    if (!report.curves.empty() && !report.curves[0].compared.empty()) {
        out +=
            "\nL2 error of the coarsest level     trial   refined   optimal   refined/trial  optimal/trial\n";
        double refined = 0, optimal = 0;
        std::size_t counted = 0;
        for (std::size_t c = 0; c < report.curves.size(); ++c) {
            const auto& e = report.curves[c].compared;
            const double trial = e.at(kCompared[0]);
            if (trial <= 0) continue;
            refined += e.at(kCompared[1]) / trial;
            optimal += e.at(kCompared[2]) / trial;
            ++counted;
            if (c >= shown) continue;
            out +=
                fmt::format("curve {:<4} ({:7} points)       {:9.5g} {:9.5g} {:9.5g}   {:13.3f}  {:13.3f}\n",
                            c + 1, report.curves[c].points[0], trial, e.at(kCompared[1]), e.at(kCompared[2]),
                            e.at(kCompared[1]) / trial, e.at(kCompared[2]) / trial);
        }
        if (counted > 1) {
            const double n = static_cast<double>(counted);
            out += fmt::format("{:<61}   {:13.3f}  {:13.3f}\n", fmt::format("mean of {} curves", counted),
                               refined / n, optimal / n);
        }
        out += fmt::format("{:<30} {:9.5g} {:9.5g} {:9.5g}   {:13.3f}  {:13.3f}\n",
                           "published: Coast (4096, 6 levels)", kPublishedCoast[0], kPublishedCoast[1],
                           kPublishedCoast[2], kPublishedCoast[1] / kPublishedCoast[0],
                           kPublishedCoast[2] / kPublishedCoast[0]);
    }
    return out;
}

std::string json(const CurveReport& report) {
    nlohmann::ordered_json j = {{"version", 1}, {"scheme", report.scheme}, {"levels", report.levels}};
    auto curves = nlohmann::ordered_json::array();
    for (const auto& curve : report.curves) {
        nlohmann::ordered_json one = {{"dimension", curve.dimension},     {"closed", curve.closed},
                                      {"points", curve.points},           {"l2_error", curve.error},
                                      {"round_trip", curve.roundTrip},    {"details", curve.details},
                                      {"details_left", curve.detailsLeft}};
        if (curve.detailsLeft != curve.details) one["threshold_l2_error"] = curve.thresholdError;
        if (!curve.compared.empty()) one["compared"] = curve.compared;
        curves.push_back(one);
    }
    j["curves"] = curves;
    return j.dump(1) + "\n";
}

}  // namespace isowave::subdivision
