#include "subdivision/lattice/relief_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "isowave/error.h"
#include "subdivision/lattice/relief.h"
#include "subdivision/lattice/relief_details.h"
#include "subdivision/lattice/surface_limit.h"

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
double rmsStep(const Grid& heights) {
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

// What the values are like: for pictures.
void measureHeights(const Grid& heights, ReliefReport& report) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double v : heights.values) {
        if (std::isnan(v)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    report.range[0] = low;
    report.range[1] = high;
    report.rmsStep = rmsStep(heights);
}

// A field at the positions that were asked for.
class Places {
  public:
    Places(const SurfaceScheme& scheme, Positions positions) {
        if (positions == Positions::limit) limit_.emplace(scheme);
    }
    SurfaceField of(const SurfaceField& field) const { return limit_ ? limit_->of(field) : field; }

  private:
    std::optional<SurfaceLimit> limit_;
};

// A field as a picture of the grid's size at that level: without what pads it.
class Pictures {
  public:
    Pictures(const Grid& grid, ReliefLayout layout) : grid_(grid), layout_(layout) {}
    Grid of(const SurfaceField& field, int level = 0) const {
        Grid picture = reliefPicture(field, layout_);
        return layout_ == ReliefLayout::Rows ? withoutPadding(std::move(picture), grid_, level) : picture;
    }
    // Of the samples of both fields that a picture has.
    std::vector<double> difference(SurfaceField a, const SurfaceField& b) const {
        a.values = subdivision::difference(a.values, b.values);
        return layout_ == ReliefLayout::Rows ? of(a).values : std::move(a.values);
    }

  private:
    const Grid& grid_;
    ReliefLayout layout_;
};

ReliefReport::Level levelOf(const SurfaceLevels& parts, SurfaceFilters& filters, const SurfaceField& field,
                            const Pictures& pictures, const Places& places, int k) {
    const SurfaceField level = reconstruct(parts, filters, k);
    ReliefReport::Level row;
    row.patch = level.patch.name();
    row.nodes = level.patch.size();
    row.suppressedRms = rms(pictures.difference(subdivided(parts, filters, k), field));
    row.heights = pictures.of(places.of(level), k);
    if (k == parts.levels()) return row;
    const auto& details = parts.details[static_cast<std::size_t>(k)];
    row.detailRms = rms(details);
    row.detailLargest = largest(details);
    const SurfaceField lengths = detailField(parts, k);
    row.detailPercentile99 = percentile99(lengths.values);
    row.detailLengths = pictures.of(lengths, k);
    return row;
}

}  // namespace

ReliefReport reportRelief(const Grid& grid, const ReliefReportOptions& options) {
    SurfaceFilters filters(surfaceScheme(options.scheme));
    const SurfaceField field = reliefField(grid, options.layout, options.levels);
    const SurfaceLevels parts = decompose(field, filters, options.levels);
    const Pictures pictures(grid, options.layout);
    const Places places(filters.scheme(), options.positions);
    ReliefReport report;
    report.scheme = filters.scheme().name;
    report.positions = options.positions;
    measureHeights(lastChannel(pictures.of(field)), report);
    for (int k = 0; k <= options.levels; ++k)
        report.levels.push_back(levelOf(parts, filters, field, pictures, places, k));
    const SurfaceField restored = reconstruct(parts, filters, 0);
    report.roundTrip = largest(difference(restored.values, field.values));
    report.reconstructed = pictures.of(restored);
    report.suppressed = pictures.of(places.of(subdivided(parts, filters, options.levels)));
    if (options.details)
        report.details = reliefDetailsBytes({grid.rows, grid.columns, parts, options.layout});
    if (!options.compare) return report;
    for (const auto& name : surfaceSchemeNames()) {
        SurfaceFilters others(surfaceScheme(name));
        const SurfaceLevels levels = decompose(field, others, options.levels);
        report.compared[name] = rms(pictures.difference(subdivided(levels, others, options.levels), field));
    }
    return report;
}

void forEachPicture(const ReliefReport& report, const PictureVisitor& visit) {
    const double low = report.range[0], high = report.range[1];
    const double slope = 2 * report.rmsStep;
    const auto draw = [&](const std::string& name, const std::string& shade, const Grid& picture,
                          double step) {
        const Grid shown = lastChannel(picture);
        visit(name, shown, low, high);
        visit(shade, shaded(shown, step), 0, 1);
    };
    for (std::size_t k = 0; k < report.levels.size(); ++k) {
        const std::string number = std::to_string(k);
        // A sample of level k is 2^k samples wide: the same slope is 2^k times the step.
        draw("level_" + number, "shade_" + number, report.levels[k].heights,
             slope * std::ldexp(1.0, static_cast<int>(k)));
        const Grid& lengths = report.levels[k].detailLengths;
        if (lengths.values.empty()) continue;
        const double dark = report.levels[k].detailPercentile99;
        visit("details_" + number, lengths, dark > 0 ? dark : 1, dark > 0 ? 0 : 2);
    }
    draw("suppressed", "suppressed_shade", report.suppressed, slope);
}

}  // namespace isowave::subdivision
