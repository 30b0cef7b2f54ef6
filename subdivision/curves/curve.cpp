#include "subdivision/curves/curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>

#include "isowave/error.h"
#include "subdivision/curves/curve_limit.h"

namespace isowave::subdivision {

namespace {

// out += sum of the row's weights times in[first ..]; around the end for a closed curve.
template <int Dim>
void addRow(const FilterRow& row, std::ptrdiff_t first, const double* in, std::ptrdiff_t inputs,
            double* out) {
    for (std::size_t k = 0; k < row.weights.size(); ++k) {
        std::ptrdiff_t i = (first + static_cast<std::ptrdiff_t>(k)) % inputs;
        if (i < 0) i += inputs;
        for (int d = 0; d < Dim; ++d) out[d] += row.weights[k] * in[i * Dim + d];
    }
}

// The same for `count` outputs, `stride` apart, whose inputs are `step` apart and do not wrap. The number of
// taps is known at compile time for the widths in use, so that the inner loop unrolls.
struct Sweep {
    std::ptrdiff_t count, stride, step;
};
template <int Dim, int Taps>
void addRows(const FilterRow& row, const Sweep& sweep, const double* in, double* out) {
    const int taps = Taps > 0 ? Taps : static_cast<int>(row.weights.size());
    const double* const weights = row.weights.data();
    for (std::ptrdiff_t k = 0; k < sweep.count; ++k, in += sweep.step * Dim, out += sweep.stride * Dim) {
        double sum[Dim] = {};
        for (int t = 0; t < taps; ++t) {
            for (int d = 0; d < Dim; ++d) sum[d] += weights[t] * in[t * Dim + d];
        }
        for (int d = 0; d < Dim; ++d) out[d] += sum[d];
    }
}

template <int Dim>
void addRows(const FilterRow& row, const Sweep& sweep, const double* in, double* out) {
    switch (row.weights.size()) {
        case 0:
            return;
        case 1:
            return addRows<Dim, 1>(row, sweep, in, out);
        case 2:
            return addRows<Dim, 2>(row, sweep, in, out);
        case 3:
            return addRows<Dim, 3>(row, sweep, in, out);
        case 4:
            return addRows<Dim, 4>(row, sweep, in, out);
        case 5:
            return addRows<Dim, 5>(row, sweep, in, out);
        case 7:
            return addRows<Dim, 7>(row, sweep, in, out);
        case 9:
            return addRows<Dim, 9>(row, sweep, in, out);
        case 11:
            return addRows<Dim, 11>(row, sweep, in, out);
        default:
            return addRows<Dim, 0>(row, sweep, in, out);
    }
}

std::ptrdiff_t ceilDivide(std::ptrdiff_t a, std::ptrdiff_t b) { return a <= 0 ? -(-a / b) : (a - 1) / b + 1; }

// The row of one output, and the input at which it begins.
std::pair<const FilterRow*, std::ptrdiff_t> rowOf(const FilterBank& bank, std::ptrdiff_t k,
                                                  std::ptrdiff_t inputs, std::ptrdiff_t outputs) {
    const auto head = static_cast<std::ptrdiff_t>(bank.head.size()),
               tail = static_cast<std::ptrdiff_t>(bank.tail.size());
    if (k < head) {
        const FilterRow& row = bank.head[static_cast<std::size_t>(k)];
        return {&row, row.first};
    }
    if (k >= outputs - tail) {
        const FilterRow& row = bank.tail[static_cast<std::size_t>(k - (outputs - tail))];
        return {&row, inputs + row.first};
    }
    const auto period = static_cast<std::ptrdiff_t>(bank.inner.size());
    const FilterRow& row = bank.inner[static_cast<std::size_t>((k - head) % period)];
    return {&row, row.first + (k - head) / period * bank.step};
}

template <int Dim>
void applyAll(const FilterBank& bank, const double* in, std::size_t inputCount, double* out,
              std::size_t outputCount) {
    const auto inputs = static_cast<std::ptrdiff_t>(inputCount),
               outputs = static_cast<std::ptrdiff_t>(outputCount);
    const auto head = std::min(outputs, static_cast<std::ptrdiff_t>(bank.head.size()));
    // The end of the inner ones.
    const auto inner = std::max(head, outputs - static_cast<std::ptrdiff_t>(bank.tail.size()));
    const auto single = [&](std::ptrdiff_t k) {
        const auto [row, first] = rowOf(bank, k, inputs, outputs);
        addRow<Dim>(*row, first, in, inputs, out + k * Dim);
    };
    for (std::ptrdiff_t k = 0; k < head; ++k) single(k);
    for (std::ptrdiff_t k = inner; k < outputs; ++k) single(k);
    const auto period = static_cast<std::ptrdiff_t>(bank.inner.size());
    for (std::ptrdiff_t phase = 0; phase < period; ++phase) {
        const FilterRow& row = bank.inner[static_cast<std::size_t>(phase)];
        const auto taps = static_cast<std::ptrdiff_t>(row.weights.size());
        // Of the outputs head + phase + q period those with 0 <= first + q step and first + q step + taps <= inputs do
        // not wrap: they are one sweep, and the few before and after it are done one by one.
        const std::ptrdiff_t count = std::max<std::ptrdiff_t>(0, ceilDivide(inner - head - phase, period));
        const std::ptrdiff_t room = inputs - taps - row.first;
        const std::ptrdiff_t end = room < 0 ? 0 : std::min(count, room / bank.step + 1);
        const std::ptrdiff_t begin =
            std::min(end, std::max<std::ptrdiff_t>(0, ceilDivide(-row.first, bank.step)));
        for (std::ptrdiff_t q = 0; q < begin; ++q) single(head + phase + q * period);
        addRows<Dim>(row, {end - begin, period, bank.step}, in + (row.first + begin * bank.step) * Dim,
                     out + (head + phase + begin * period) * Dim);
        for (std::ptrdiff_t q = end; q < count; ++q) single(head + phase + q * period);
    }
}

std::vector<double> applied(const FilterBank& bank, int dimension, const std::vector<double>& in,
                            std::size_t outputs) {
    const auto d = static_cast<std::size_t>(dimension);
    std::vector<double> out(outputs * d, 0.0);
    applyBank(bank, dimension, in.data(), in.size() / d, out.data(), outputs, true);
    return out;
}

// Inserts the point at which its detail vanishes: with 0 there the detail is d, and it is linear in the
// point with the weight w that the row has there (summed up where a short closed curve meets itself).
void insertVirtual(std::vector<double>& points, int dimension, const CurveFilters& filters, std::size_t n) {
    const auto d = static_cast<std::size_t>(dimension);
    const std::size_t place = filters.virtualPoint(n), fine = filters.fineSize(n), details = fine - n;
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(place * d), d, 0.0);
    const auto inputs = static_cast<std::ptrdiff_t>(fine);
    const auto [row, first] = rowOf(filters.maps(n).b, static_cast<std::ptrdiff_t>(filters.virtualDetail(n)),
                                    inputs, static_cast<std::ptrdiff_t>(details));
    double weight = 0;
    std::vector<double> detail(d, 0.0);
    for (std::size_t k = 0; k < row->weights.size(); ++k) {
        std::ptrdiff_t i = (first + static_cast<std::ptrdiff_t>(k)) % inputs;
        if (i < 0) i += inputs;
        if (static_cast<std::size_t>(i) == place) weight += row->weights[k];
        for (std::size_t c = 0; c < d; ++c)
            detail[c] += row->weights[k] * points[static_cast<std::size_t>(i) * d + c];
    }
    assert(weight != 0);
    for (std::size_t c = 0; c < d; ++c) points[place * d + c] = -detail[c] / weight;
}

// One level: points of size m become n points; returns the details.
std::vector<double> halve(std::vector<double>& points, int dimension, const CurveFilters& filters,
                          std::size_t n) {
    const auto d = static_cast<std::size_t>(dimension);
    const std::size_t m = points.size() / d, fine = filters.fineSize(n);
    if (fine > m) insertVirtual(points, dimension, filters, n);
    const auto& maps = filters.maps(n);
    auto details = applied(maps.b, dimension, points, fine - n);
    points = applied(maps.a, dimension, points, n);
    if (fine > m) {
        const auto withheld = details.begin() + static_cast<std::ptrdiff_t>(filters.virtualDetail(n) * d);
        details.erase(withheld, withheld + static_cast<std::ptrdiff_t>(d));
    }
    return details;
}

// The other way: n points and m - n details (none at all stand for zeros) become m points.
std::vector<double> doubled(const std::vector<double>& points, const std::vector<double>* details,
                            int dimension, const CurveFilters& filters, std::size_t m) {
    const auto d = static_cast<std::size_t>(dimension);
    const std::size_t n = points.size() / d, fine = filters.fineSize(n);
    const auto& maps = filters.maps(n);
    auto result = applied(maps.p, dimension, points, fine);
    if (details) {
        std::vector<double> all = *details;
        if (fine > m) {
            all.insert(all.begin() + static_cast<std::ptrdiff_t>(filters.virtualDetail(n) * d), d, 0.0);
        }
        applyBank(maps.q, dimension, all.data(), fine - n, result.data(), fine, true);
    }
    if (fine > m) {
        const auto place = result.begin() + static_cast<std::ptrdiff_t>(filters.virtualPoint(n) * d);
        result.erase(place, place + static_cast<std::ptrdiff_t>(d));
    }
    return result;
}

void checkCurve(const Polyline& curve, const CurveFilters& filters) {
    if (curve.dimension != 2 && curve.dimension != 3) {
        throw InputError("curve",
                         "its points have " + std::to_string(curve.dimension) + " coordinates, not 2 or 3");
    }
    if (curve.coordinates.size() % static_cast<std::size_t>(curve.dimension) != 0) {
        throw InputError("curve", std::to_string(curve.coordinates.size()) +
                                      " coordinates do not make points of " +
                                      std::to_string(curve.dimension));
    }
    if (curve.closed != filters.closed()) {
        throw InputError("curve", std::string("is ") + (curve.closed ? "closed" : "open") +
                                      " but the filters are for " + (curve.closed ? "open" : "closed") +
                                      " curves");
    }
    for (std::size_t k = 0; k < curve.coordinates.size(); ++k) {
        if (std::isfinite(curve.coordinates[k])) continue;
        const auto d = static_cast<std::size_t>(curve.dimension);
        throw InputError("curve", std::string("coordinate ") + "xyz"[k % d] + " of point " +
                                      std::to_string(k / d) +
                                      " is not a finite number; remove the point or mend it");
    }
}

// Every size follows from the coarsest: a level of n points may restore fineSize(n) of them, or one less.
void checkLevels(const CurveLevels& curve, const CurveFilters& filters) {
    checkCurve(curve.coarse, filters);
    if (curve.scheme != filters.scheme().name) {
        throw InputError("levels", "were made by the scheme '" + curve.scheme + "', not by '" +
                                       filters.scheme().name + "'");
    }
    std::size_t n = curve.coarse.size();
    for (std::size_t k = curve.details.size(); k-- > 0;) {
        const CurveDetails& details = curve.details[k];
        if (filters.coarseSize(details.points) != n) {
            throw InputError("levels", "level " + std::to_string(k) + " has " +
                                           std::to_string(details.points) +
                                           " points, which do not come from the " + std::to_string(n) +
                                           " of level " + std::to_string(k + 1));
        }
        const std::size_t needed = (details.points - n) * static_cast<std::size_t>(curve.coarse.dimension);
        if (details.coordinates.size() != needed) {
            throw InputError("levels", "details of level " + std::to_string(k) + " hold " +
                                           std::to_string(details.coordinates.size()) + " numbers, not " +
                                           std::to_string(needed));
        }
        for (const double value : details.coordinates) {
            if (!std::isfinite(value)) {
                throw InputError(
                    "levels", "details of level " + std::to_string(k) + " hold a number that is not finite");
            }
        }
        n = details.points;
    }
}

void checkLevel(const CurveLevels& curve, int level) {
    if (level < 0 || level > curve.levels()) {
        throw InputError("levels", "there is no level " + std::to_string(level) + "; they are 0 to " +
                                       std::to_string(curve.levels()));
    }
}

// From the coarsest level to `level`; details below `lastWithDetails` are taken for 0.
Polyline rebuilt(const CurveLevels& curve, const CurveFilters& filters, int level, int lastWithDetails) {
    checkLevels(curve, filters);
    Polyline result = curve.coarse;
    for (int k = curve.levels() - 1; k >= level; --k) {
        const CurveDetails& details = curve.details[static_cast<std::size_t>(k)];
        result.coordinates =
            doubled(result.coordinates, k >= lastWithDetails ? &details.coordinates : nullptr,
                    result.dimension, filters, details.points);
    }
    return result;
}

double lengthSquared(const double* v, int dimension) {
    double sum = 0;
    for (int d = 0; d < dimension; ++d) sum += v[d] * v[d];
    return sum;
}

}  // namespace

void applyBank(const FilterBank& bank, int dimension, const double* in, std::size_t inputs, double* out,
               std::size_t outputs, bool accumulate) {
    if (!accumulate) std::fill_n(out, outputs * static_cast<std::size_t>(dimension), 0.0);
    switch (dimension) {
        case 1:
            return applyAll<1>(bank, in, inputs, out, outputs);
        case 2:
            return applyAll<2>(bank, in, inputs, out, outputs);
        case 3:
            return applyAll<3>(bank, in, inputs, out, outputs);
        default:
            assert(false && "dimension is 1, 2 or 3");
    }
}

CurveLevels decompose(const Polyline& curve, const CurveFilters& filters, int levels) {
    checkCurve(curve, filters);
    if (levels < 0)
        throw InputError("levels", std::to_string(levels) + " levels are asked for; there may be 0 or more");
    const std::size_t m = curve.size();
    if (filters.mostLevels(m) < levels) {
        const std::string most = std::to_string(filters.mostLevels(m));
        // Beyond 40 levels the number needed is of no use to anybody.
        const std::string needed =
            levels > 40 ? "far more" : "at least " + std::to_string(filters.fewestPoints(levels));
        throw InputError("curve", "has " + std::to_string(m) + " points; " + std::to_string(levels) +
                                      " levels of " + (filters.closed() ? "a closed " : "an open ") +
                                      filters.scheme().name + " curve need " + needed +
                                      "; these points allow " + most +
                                      "; ask for fewer with --depth, or resample with --points");
    }
    CurveLevels result{filters.scheme().name, curve, {}};
    for (int k = 0; k < levels; ++k) {
        const std::size_t points = result.coarse.size();
        const std::size_t n = *filters.coarseSize(points);
        result.details.push_back({points, halve(result.coarse.coordinates, curve.dimension, filters, n)});
    }
    return result;
}

Polyline reconstruct(const CurveLevels& curve, const CurveFilters& filters, int level) {
    checkLevel(curve, level);
    return rebuilt(curve, filters, level, 0);
}

Polyline subdivided(const CurveLevels& curve, const CurveFilters& filters, int from) {
    checkLevel(curve, from);
    return rebuilt(curve, filters, 0, from);
}

std::size_t detailCount(const CurveLevels& curve) {
    std::size_t count = 0;
    for (const auto& details : curve.details) {
        count += details.coordinates.size() / static_cast<std::size_t>(curve.coarse.dimension);
    }
    return count;
}

std::size_t nonzeroDetailCount(const CurveLevels& curve) {
    const auto d = static_cast<std::ptrdiff_t>(curve.coarse.dimension);
    std::size_t count = 0;
    for (const auto& details : curve.details) {
        for (auto at = details.coordinates.begin(); at != details.coordinates.end(); at += d) {
            count += std::any_of(at, at + d, [](double v) { return v != 0; });
        }
    }
    return count;
}

std::size_t threshold(CurveLevels& curve, double length) {
    const int dimension = curve.coarse.dimension;
    const auto d = static_cast<std::size_t>(dimension);
    std::size_t left = 0;
    for (auto& details : curve.details) {
        for (std::size_t k = 0; k + d <= details.coordinates.size(); k += d) {
            double* const detail = details.coordinates.data() + k;
            if (lengthSquared(detail, dimension) < length * length) {
                std::fill_n(detail, d, 0.0);
            } else {
                ++left;
            }
        }
    }
    return left;
}

void keepLongest(CurveLevels& curve, std::size_t count) {
    const int dimension = curve.coarse.dimension;
    const auto d = static_cast<std::size_t>(dimension);
    std::vector<std::pair<double, double*>> all;
    for (std::size_t level = curve.details.size(); level-- > 0;) {
        auto& values = curve.details[level].coordinates;
        for (std::size_t k = 0; k + d <= values.size(); k += d) {
            all.emplace_back(lengthSquared(values.data() + k, dimension), values.data() + k);
        }
    }
    // Stable: of equal lengths the coarser level stands first, and in a level the earlier.
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t k = std::min(count, all.size()); k < all.size(); ++k) std::fill_n(all[k].second, d, 0.0);
}

void edit(CurveLevels& curve, const CurveFilters& filters, int level, const Polyline& points) {
    checkLevel(curve, level);
    checkLevels(curve, filters);
    const std::size_t expected =
        level == curve.levels() ? curve.coarse.size() : curve.details[static_cast<std::size_t>(level)].points;
    if (points.size() != expected || points.dimension != curve.coarse.dimension) {
        throw InputError("curve", "level " + std::to_string(level) + " has " + std::to_string(expected) +
                                      " points in " + std::to_string(curve.coarse.dimension) + "D; " +
                                      std::to_string(points.size()) + " in " +
                                      std::to_string(points.dimension) + "D were given");
    }
    CurveLevels below = decompose(points, filters, curve.levels() - level);
    curve.coarse = std::move(below.coarse);
    std::move(below.details.begin(), below.details.end(), curve.details.begin() + level);
}

double l2Distance(const Polyline& a, const Polyline& b) {
    assert(a.dimension == b.dimension && a.coordinates.size() == b.coordinates.size());
    double sum = 0;
    for (std::size_t k = 0; k < a.coordinates.size(); ++k) {
        const double d = a.coordinates[k] - b.coordinates[k];
        sum += d * d;
    }
    return std::sqrt(sum);
}

Polyline resampled(const Polyline& curve, std::size_t count) {
    const auto d = static_cast<std::size_t>(curve.dimension);
    const std::size_t size = curve.size(), edges = curve.closed ? size : size - 1;
    const auto point = [&](std::size_t k) { return curve.coordinates.data() + (k % size) * d; };
    std::vector<double> along{0.0};  // arc length at each point
    for (std::size_t k = 0; k < edges; ++k) {
        double sum = 0;
        for (std::size_t c = 0; c < d; ++c) sum += std::pow(point(k + 1)[c] - point(k)[c], 2);
        along.push_back(along.back() + std::sqrt(sum));
    }
    assert(count >= 2 && along.back() > 0);
    Polyline result{curve.dimension, curve.closed, {}};
    result.coordinates.reserve(count * d);
    std::size_t edge = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double parts = static_cast<double>(curve.closed ? count : count - 1);
        const double target = along.back() * static_cast<double>(k) / parts;
        while (edge + 1 < edges && along[edge + 1] <= target) ++edge;
        const double length = along[edge + 1] - along[edge];
        const double t = length > 0 ? std::clamp((target - along[edge]) / length, 0.0, 1.0) : 0.0;
        for (std::size_t c = 0; c < d; ++c) {
            result.coordinates.push_back((1 - t) * point(edge)[c] + t * point(edge + 1)[c]);
        }
    }
    return result;
}

// ---- the public face: filters by the name of their scheme ----

CurveTransform::CurveTransform(std::string_view scheme, bool closed)
    : filters_(std::make_shared<const CurveFilters>(curveScheme(scheme), closed)) {}

CurveTransform CurveTransform::ofMask(std::string_view mask, int width) {
    return CurveTransform(std::make_shared<const CurveFilters>(maskScheme(mask, width), true));
}

int CurveTransform::mostLevels(std::size_t points) const { return filters_->mostLevels(points); }

CurveLevels CurveTransform::decompose(const Polyline& curve, int levels) const {
    return subdivision::decompose(curve, *filters_, levels);
}

Polyline CurveTransform::reconstruct(const CurveLevels& curve, int level) const {
    return subdivision::reconstruct(curve, *filters_, level);
}

Polyline CurveTransform::subdivided(const CurveLevels& curve, int from) const {
    return subdivision::subdivided(curve, *filters_, from);
}

Polyline CurveTransform::limit(const Polyline& curve) const {
    checkCurve(curve, *filters_);
    return CurveLimit(filters_->scheme()).of(curve);
}

}  // namespace isowave::subdivision
