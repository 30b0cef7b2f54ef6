#include "chui.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "wavelets/interval/matrices.h"

namespace isowave::bench {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

// Values on a box, continued beyond it by those of its faces: ±K in all directions.
struct Dense {
    CoordBBox box;
    std::vector<double> values;

    explicit Dense(const CoordBBox& b) : box(b), values(b.volume()) {}
    double& at(Coord c) {
        c = Coord::maxComponent(box.min(), Coord::minComponent(box.max(), c));
        const Coord d = c - box.min(), n = box.dim();
        return values[(std::size_t(d.x()) * n.y() + d.y()) * n.z() + d.z()];
    }
};

Coord along(Coord c, int axis, int position) {
    c[axis] = position;
    return c;
}

struct Step {
    int axis;
    CoordBBox fine;
    Dense details;
};

CoordBBox resized(CoordBBox box, int axis, int low, int high) {
    box.min()[axis] = low;
    box.max()[axis] = high;
    return box;
}

// REQUIRES: filters.reach > 5, the reach of the wavelet itself, or the cut is less than the synthesis needs.
Dense analysed(Dense& fine, int axis, const AnalysisFilters& filters, Dense& details) {
    const int margin = filters.reach / 2 + 4;
    const CoordBBox box =
        resized(fine.box, axis, (fine.box.min()[axis] >> 1) - margin, (fine.box.max()[axis] >> 1) + margin);
    Dense coarse(box);
    details = Dense(box);
    std::size_t i = 0;
    for (auto c = box.begin(); c; ++c, ++i) {
        const int j = (*c)[axis];
        for (int s = -filters.reach; s <= filters.reach; ++s) {
            coarse.values[i] += filters.a[s + filters.reach] * fine.at(along(*c, axis, 2 * j + s));
            details.values[i] += filters.b[s + filters.reach] * fine.at(along(*c, axis, 2 * j + 1 + s));
        }
    }
    return coarse;
}

constexpr std::array<double, 5> kP = {1. / 8, 4. / 8, 6. / 8, 4. / 8, 1. / 8};
constexpr double kLargest = -24264;  // waveletMatrix() scales the wavelet so that this entry is 1
constexpr std::array<double, 11> kQ = {1, -124, 1677, -7904, 18482, -24264, 18482, -7904, 1677, -124, 1};

Dense synthesised(Dense& coarse, Dense& details, int axis, const CoordBBox& box) {
    Dense fine(box);
    std::size_t n = 0;
    for (auto c = box.begin(); c; ++c, ++n) {
        const int i = (*c)[axis];
        double sum = 0;
        for (int j = (i - 2) >> 1; j <= (i + 2) >> 1; ++j)
            if (std::abs(i - 2 * j) <= 2) sum += kP[i - 2 * j + 2] * coarse.at(along(*c, axis, j));
        for (int j = (i - 6) >> 1; j <= (i + 5) >> 1; ++j)
            if (std::abs(i - 2 * j - 1) <= 5)
                sum += kQ[i - 2 * j - 1 + 5] / kLargest * details.at(along(*c, axis, j));
        fine.values[n] = sum;
    }
    return fine;
}

}  // namespace

AnalysisFilters cutFilters(int reach) {
    // Far from both ends the rows of the bounded analysis are the infinite filters: they fall by 1.8x every two
    // taps. c_j lies at the interval's fine point 2j - 1, d_k at 2k + 2 (interval/matrices.h); `left` is column 0.
    constexpr int kLong = 80, kMiddle = kLong / 2;
    const wavelets::Matrix map = wavelets::analysisMap(kLong);
    AnalysisFilters filters{reach, {}, {}};
    for (int s = -reach; s <= reach; ++s) {
        filters.a.push_back(static_cast<double>(map(kMiddle, 1 + 2 * kMiddle - 1 + s)));
        filters.b.push_back(static_cast<double>(map(kLong + 3 + kMiddle, 1 + 2 * kMiddle + 2 + s)));
    }
    return filters;
}

RoundTripError cutRoundTrip(const BSplineField& field, int steps, const AnalysisFilters& filters) {
    CoordBBox box = field.controlPoints->evalActiveVoxelBoundingBox();
    box.expand(1);
    Dense current(box);
    const auto values = field.controlPoints->getConstAccessor();
    std::size_t i = 0;
    for (auto c = box.begin(); c; ++c) current.values[i++] = values.getValue(*c);
    std::vector<Step> taken;
    for (int step = 0; step < steps; ++step) {
        taken.push_back({step % 3, current.box, Dense(current.box)});
        current = analysed(current, step % 3, filters, taken.back().details);
    }
    for (auto step = taken.rbegin(); step != taken.rend(); ++step)
        current = synthesised(current, step->details, step->axis, step->fine);
    RoundTripError error;
    double sum = 0;
    for (auto c = field.controlPoints->cbeginValueOn(); c; ++c) {
        const double e = std::abs(current.at(c.getCoord()) - *c) / field.K;
        error.max = std::max(error.max, e);
        sum += e * e;
    }
    error.rms = std::sqrt(sum / double(field.controlPointCount()));
    return error;
}

}  // namespace isowave::bench
