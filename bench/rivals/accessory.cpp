#include "accessory.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "wavelets/interval/interval.h"
#include "wavelets/interval/matrices.h"

namespace isowave::bench {
namespace {

using namespace wavelets;
using openvdb::Coord;

// Known positions of every line along an axis, ascending; a line by its two other coordinates.
std::map<Coord, std::vector<int>> linesAlong(const openvdb::FloatGrid& grid, int axis) {
    std::map<Coord, std::vector<int>> lines;
    for (auto c = grid.cbeginValueOn(); c; ++c) {
        Coord line = c.getCoord();
        const int position = line[axis];
        line[axis] = 0;
        lines[line].push_back(position);
    }
    for (auto& [line, positions] : lines) std::sort(positions.begin(), positions.end());
    return lines;
}

std::vector<Run> runsOf(const std::vector<int>& positions) {
    std::vector<Run> runs;
    for (const int p : positions) {
        if (runs.empty() || runs.back().last != p - 1) runs.push_back({p, p});
        runs.back().last = p;
    }
    return runs;
}

// The interval's control points with the accessory ones, and what lies beyond either end.
struct Filled {
    std::vector<double> fine;
    double left, right;
};

template <class ValueAt, class IsKnown>
Filled fill(AccessoryRule rule, const Interval& interval, const ValueAt& valueAt, const IsKnown& isKnown) {
    Filled filled{std::vector<double>(static_cast<std::size_t>(interval.fineSize())),
                  valueAt(interval.first - 1), valueAt(interval.last + 1)};
    std::vector<std::int64_t> known;
    double sum = 0;
    for (std::int64_t p = interval.first; p <= interval.last; ++p) {
        filled.fine[static_cast<std::size_t>(p - interval.first)] = valueAt(p);
        if (!isKnown(p)) continue;
        known.push_back(p);
        sum += valueAt(p);
    }
    if (rule == AccessoryRule::sign) return filled;  // unknown control points of a field are ±K by sign
    const double mean = sum / double(known.size());
    const auto ruled = [&](std::int64_t p) {
        if (rule == AccessoryRule::average) return mean;
        const auto after = std::lower_bound(known.begin(), known.end(), p);
        if (after == known.end()) return valueAt(known.back());
        if (after == known.begin()) return valueAt(known.front());
        return valueAt(p - after[-1] <= *after - p ? after[-1] : *after);
    };
    for (std::int64_t p = interval.first; p <= interval.last; ++p)
        if (!isKnown(p)) filled.fine[static_cast<std::size_t>(p - interval.first)] = ruled(p);
    filled.left = ruled(interval.first - 1);
    filled.right = ruled(interval.last + 1);
    return filled;
}

}  // namespace

std::string nameOf(AccessoryRule rule) {
    return rule == AccessoryRule::sign ? "±K by sign" : rule == AccessoryRule::end ? "end value" : "average";
}

DirectionResult analyseWith(AccessoryRule rule, const BSplineField& fine, int axis) {
    DirectionResult result = analyseDirection(fine, axis);  // the shapes, and room for the coefficients
    auto coarse = result.coarse.controlPoints->getAccessor();
    auto details = result.details->getAccessor();
    const auto values = fine.controlPoints->getConstAccessor();
    IntervalTransform transform;
    std::vector<Interval> intervals;
    for (const auto& [line, positions] : linesAlong(*fine.controlPoints, axis)) {
        const auto at = [&line = line, axis](std::int64_t p) {
            Coord c = line;
            c[axis] = static_cast<int>(p);
            return c;
        };
        joinRuns(runsOf(positions), intervals);
        for (const Interval& i : intervals) {
            const Filled filled = fill(
                rule, i, [&](std::int64_t p) { return double(values.getValue(at(p))); },
                [&](std::int64_t p) { return values.isValueOn(at(p)); });
            std::vector<double> c(static_cast<std::size_t>(i.coarseSize())),
                d(static_cast<std::size_t>(i.detailSize()));
            transform.analyse(filled.fine, filled.left, filled.right, c, d);
            for (std::size_t j = 0; j < c.size(); ++j)
                coarse.setValueOn(at(i.firstCoarse() + std::int64_t(j)), static_cast<float>(c[j]));
            for (std::size_t k = 0; k < d.size(); ++k)
                details.setValueOn(at(i.firstDetail() + std::int64_t(k)), static_cast<float>(d[k]));
        }
    }
    return result;
}

Recovery recoveryOf(AccessoryRule rule, int n) {
    // With y the coefficients that are kept, z the rejected ones, a the accessory values and T split by rows into
    // accessory (A) and inner (F) ones and by columns into kept (k) and rejected (r) ones:
    //   A_k y + A_r z = a,   f = F_k y + F_r z,   a given, or a = W f.
    const int ne = n + kAccessory, size = 2 * n + 3, ends = 2 * kAccessory;
    const Matrix t = interleavedMatrix(ne);
    const std::array<int, 8> lost = {coarseColumn(ne, 0),      coarseColumn(ne, 1),     detailColumn(0),
                                     detailColumn(1),          detailColumn(ne - 2),    detailColumn(ne - 1),
                                     coarseColumn(ne, ne + 1), coarseColumn(ne, ne + 2)};
    Matrix rejected(t.rows(), ends), kept(t.rows(), size);
    for (int j = 0; j < ends; ++j) rejected.col(j) = t.col(lost[j]);
    for (int column = 0, j = 0; column < t.cols(); ++column)
        if (std::find(lost.begin(), lost.end(), column) == lost.end()) kept.col(j++) = t.col(column);
    const auto outer = [&](const Matrix& m) {
        Matrix rows(ends, m.cols());
        rows << m.topRows(kAccessory), m.bottomRows(kAccessory);
        return rows;
    };
    Matrix weights = Matrix::Zero(ends, size);
    if (rule == AccessoryRule::average) weights.setConstant(Real(1) / size);
    if (rule == AccessoryRule::end) {
        weights.topLeftCorner(kAccessory, 1).setOnes();
        weights.bottomRightCorner(kAccessory, 1).setOnes();
    }
    const Matrix innerRejected = rejected.middleRows(kAccessory, size),
                 innerKept = kept.middleRows(kAccessory, size);
    const Matrix system = outer(rejected) - weights * innerRejected;
    const Matrix inverse = system.fullPivLu().inverse();
    const Matrix back = innerKept + innerRejected * inverse * (weights * innerKept - outer(kept));
    const auto norm = [](const Matrix& m) {
        return static_cast<double>(m.cwiseAbs().rowwise().sum().maxCoeff());
    };
    return {norm(system) * norm(inverse), norm(back)};
}

}  // namespace isowave::bench
