#include "io/mesh/distance/distance_colours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace isowave {
namespace {

struct Stop {
    double share;
    std::array<double, 3> colour;
};
constexpr std::array<Stop, 6> kStops{{{0, {226, 222, 211}},
                                      {0.18, {240, 205, 120}},
                                      {0.42, {232, 138, 62}},
                                      {0.68, {196, 62, 56}},
                                      {0.88, {122, 24, 72}},
                                      {1, {66, 10, 62}}}};

}  // namespace

std::array<double, 3> distanceColour(double share) {
    const double at = std::clamp(share, 0.0, 1.0);
    std::size_t next = 1;
    while (kStops[next].share < at) ++next;
    const Stop &low = kStops[next - 1], &high = kStops[next];
    const double part = (at - low.share) / (high.share - low.share);
    std::array<double, 3> colour;
    for (std::size_t k = 0; k < 3; ++k) colour[k] = low.colour[k] + part * (high.colour[k] - low.colour[k]);
    return colour;
}

std::array<double, 3> linearDistanceColour(double share) {
    std::array<double, 3> colour = distanceColour(share);
    for (double& c : colour) {
        c /= 255;
        c = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return colour;
}

StoredColour storedDistanceColour(float distance, double range) {
    constexpr std::uint16_t kOne = 65'535;
    StoredColour stored{0, 0, 0, kOne};
    const std::array<double, 3> colour = linearDistanceColour(range > 0 ? distance / range : 0);
    for (std::size_t k = 0; k < 3; ++k) stored[k] = static_cast<std::uint16_t>(std::lround(kOne * colour[k]));
    return stored;
}

}  // namespace isowave
