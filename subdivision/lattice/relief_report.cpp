#include "subdivision/lattice/relief_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "subdivision/lattice/picture_files.h"

namespace isowave::subdivision {

namespace {

Grid lastChannel(const Grid& grid) {
    if (grid.channels == 1) return grid;
    Grid one{grid.rows, grid.columns, 1, {}};
    for (std::size_t k = grid.channels - 1; k < grid.values.size(); k += grid.channels)
        one.values.push_back(grid.values[k]);
    return one;
}

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double v : values) most = std::max(most, std::abs(v));
    return most;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> d(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) d[k] = a[k] - b[k];
    return d;
}

double percentile99(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

// The rms step between neighbours in a row: a slope that shades well at this level.
double typicalStep(const Grid& heights) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t r = 0; r < heights.rows; ++r) {
        for (std::size_t c = 1; c < heights.columns; ++c) {
            const double step = heights.at(r, c) - heights.at(r, c - 1);
            if (std::isnan(step)) continue;
            sum += step * step;
            ++count;
        }
    }
    return count == 0 || sum == 0 ? 1 : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

ReliefReport reportRelief(const Grid& grid, const ReliefReportOptions& options) {
    SurfaceFilters filters(surfaceScheme(options.scheme));
    const SurfaceField field = reliefField(grid, options.layout, options.levels);
    const SurfaceLevels made = decompose(field, filters, options.levels);

    ReliefReport report;
    report.scheme = filters.scheme().name;
    const Grid heights = lastChannel(reliefPicture(field, options.layout));
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double v : heights.values) {
        if (std::isnan(v)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    report.range[0] = low;
    report.range[1] = high;

    const double slope = 2 * typicalStep(heights);
    const auto draw = [&](const std::string& name, const std::string& shade, const Grid& picture,
                          double step) {
        const Grid shown = lastChannel(picture);
        report.files[name] = pngBytes(shown, low, high);
        report.files[shade] = pngBytes(shaded(shown, step), 0, 1);
    };
    for (int k = 0; k <= options.levels; ++k) {
        const SurfaceField level = reconstruct(made, filters, k);
        const Grid picture = reliefPicture(level, options.layout);
        ReliefReport::Level row;
        row.patch = level.patch.name();
        row.nodes = level.patch.size();
        row.suppressedRms = rms(difference(subdivided(made, filters, k).values, field.values));
        report.files[fmt::format("level_{}.npy", k)] = npyBytes(picture);
        // A sample of level k is 2^k samples wide: the same slope is 2^k times the step.
        draw(fmt::format("level_{}.png", k), fmt::format("shade_{}.png", k), picture,
             slope * std::ldexp(1.0, k));
        if (k < options.levels) {
            const auto& details = made.details[static_cast<std::size_t>(k)];
            row.detailRms = rms(details);
            row.detailLargest = largest(details);
            const SurfaceField lengths = detailField(made, k);
            const double dark = percentile99(lengths.values);
            report.files[fmt::format("details_{}.png", k)] =
                pngBytes(reliefPicture(lengths, options.layout), dark > 0 ? dark : 1, dark > 0 ? 0 : 2);
        }
        if (k == 0) {
            report.roundTrip = largest(difference(level.values, field.values));
            report.files["reconstructed.npy"] = npyBytes(picture);
        }
        report.levels.push_back(row);
    }
    const Grid without = reliefPicture(subdivided(made, filters, options.levels), options.layout);
    report.files["suppressed.npy"] = npyBytes(without);
    draw("suppressed.png", "suppressed_shade.png", without, slope);

    if (options.compare) {
        for (const auto& name : surfaceSchemeNames()) {
            SurfaceFilters others(surfaceScheme(name));
            const SurfaceLevels levels = decompose(field, others, options.levels);
            report.compared[name] =
                rms(difference(subdivided(levels, others, options.levels).values, field.values));
        }
    }
    return report;
}

std::string text(const ReliefReport& report) {
    std::string out = fmt::format("{}, values {:.6g} to {:.6g}, round trip {:.1e}\n\n", report.scheme,
                                  report.range[0], report.range[1], report.roundTrip);
    out += "level      nodes   details: rms    largest   without finer details: rms   patch\n";
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const auto& level = report.levels[k];
        const bool coarsest = k + 1 == report.levels.size();
        out += fmt::format("{:5} {:10}   {:>12} {:>10}   {:26.6g}   {}\n", k, level.nodes,
                           coarsest ? "" : fmt::format("{:.4g}", level.detailRms),
                           coarsest ? "" : fmt::format("{:.4g}", level.detailLargest), level.suppressedRms,
                           level.patch);
    }
    if (!report.compared.empty()) {
        out += "\nwithout any details, rms by scheme\n";
        for (const auto& [name, error] : report.compared)
            out += fmt::format("  {:<20} {:.6g}\n", name, error);
    }
    return out;
}

std::string json(const ReliefReport& report) {
    nlohmann::ordered_json j = {{"version", 1},
                                {"scheme", report.scheme},
                                {"range", {report.range[0], report.range[1]}},
                                {"round_trip", report.roundTrip}};
    auto levels = nlohmann::ordered_json::array();
    for (const auto& level : report.levels) {
        levels.push_back({{"patch", level.patch},
                          {"nodes", level.nodes},
                          {"detail_rms", level.detailRms},
                          {"detail_largest", level.detailLargest},
                          {"suppressed_rms", level.suppressedRms}});
    }
    j["levels"] = levels;
    if (!report.compared.empty()) j["compared"] = report.compared;
    return j.dump(1) + "\n";
}

}  // namespace isowave::subdivision
