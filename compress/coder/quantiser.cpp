#include "compress/coder/quantiser.h"

#include <algorithm>
#include <cassert>

namespace isowave::compress {
namespace {

constexpr double kT = 2.5;         // voxels
constexpr double kStraight = 1.2;  // u / T
constexpr int kStartShift = 10;    // 65536 / 64

double tangent(double x) { return x * (15 - x * x) / (15 - 6 * x * x); }

// d/dx: (225 - 45 x^2 + ...) taken as a difference, which is as good for a straight line that only has to be monotone
double growth(double u) {
    const double x = u / kT;
    if (x <= kStraight) return kT * tangent(x);
    const double slope = (tangent(kStraight) - tangent(kStraight - 0.01)) / 0.01;
    return kT * (tangent(kStraight) + slope * (x - kStraight));
}

}  // namespace

Quantiser::Quantiser(double delta, double reach) {
    assert(delta >= kLeastDelta && delta <= kMostDelta && reach > 0 && reach <= kMostReach);
    std::vector<std::int32_t> up{0};
    const double limit = reach * kOneVoxel;
    while (up.back() < limit)
        up.push_back(
            static_cast<std::int32_t>(growth(static_cast<double>(up.size()) * delta) * kOneVoxel + 0.5));
    most_ = static_cast<std::int32_t>(up.size()) - 1;
    for (std::size_t i = up.size(); i-- > 1;) values_.push_back(-up[i]);
    values_.insert(values_.end(), up.begin(), up.end());
    std::int32_t at = 0;
    for (std::int32_t v = values_.front(); v <= values_.back(); v += 1 << kStartShift) {
        while (at + 1 < static_cast<std::int32_t>(values_.size()) && values_[at + 1] <= v) ++at;
        starts_.push_back(at);
    }
}

std::int32_t Quantiser::position(std::int32_t v) const {
    if (v >= values_.back()) return 16 * most_;
    if (v <= values_.front()) return -16 * most_;
    auto at =
        static_cast<std::size_t>(starts_[static_cast<std::size_t>((v - values_.front()) >> kStartShift)]);
    while (values_[at + 1] <= v) ++at;
    const std::int64_t gap = values_[at + 1] - values_[at];
    const auto part = static_cast<std::int32_t>(16 * (static_cast<std::int64_t>(v) - values_[at]) / gap);
    return 16 * (static_cast<std::int32_t>(at) - most_) + part;
}

}  // namespace isowave::compress
