#include "compress/coder/logistic.h"

namespace isowave::compress {
namespace {

constexpr double kExpStep = 1.00391388933834757;  // exp(1 / 256)

}  // namespace

Logistic::Logistic() {
    double e = 1;  // exp(x / 256)
    for (int x = 0; x <= kStretchLimit; ++x, e *= kExpStep) {
        squash_[static_cast<std::size_t>(kStretchLimit - x)] =
            static_cast<std::uint16_t>(65536 / (1 + e) + 0.5);
        squash_[static_cast<std::size_t>(kStretchLimit + x)] =
            static_cast<std::uint16_t>(65536 * e / (1 + e) + 0.5);
    }
    int x = -kStretchLimit;
    for (std::uint32_t p = 0; p < 4096; ++p) {
        while (x < kStretchLimit && squash(x) < 16 * p + 8) ++x;
        for (int n = 0; n < 4; ++n)
            stretch_[static_cast<std::size_t>(n)][p] = static_cast<std::int16_t>(x * (2 * n + 1) / 8);
        stretch_[4][p] = static_cast<std::int16_t>(x);
    }
}

const Logistic& Logistic::tables() {
    static const Logistic made;
    return made;
}

}  // namespace isowave::compress
