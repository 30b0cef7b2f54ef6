#include "compress/coder/mixer.h"

#include <algorithm>
#include <cassert>

namespace isowave::compress {
namespace {

constexpr std::uint32_t kMostCount = 250;  // beyond it a counter forgets
constexpr int kWeightBits = 22;  // fine enough that the small errors of bits that are nearly certain still move a weight
constexpr std::int32_t kWeightLimit = 1 << 29;
constexpr Probability kLeast = 6, kMost = 65536 - kLeast;

// 2^16 / (n + 1.5)
const std::array<std::uint32_t, 256>& rates() {
    static const auto made = [] {
        std::array<std::uint32_t, 256> rates{};
        for (std::uint32_t n = 0; n < 256; ++n) rates[n] = 131072 / (2 * n + 3);
        return rates;
    }();
    return made;
}

// A model that has seen fewer than four bits counts for less: (n + 1/2) / 4.
int confident(const Counter& counter) {
    const int s = Logistic::tables().stretch(counter.probability());
    const auto n = static_cast<int>(counter.count());
    return n < 4 ? s * (2 * n + 1) / 8 : s;
}

Probability clamped(Probability p) { return std::clamp(p, kLeast, kMost); }

}  // namespace

void Counter::update(bool bit) {
    const std::uint32_t n = count();
    const auto p = static_cast<std::int64_t>(state_ >> 8);
    const std::int64_t target = bit ? 0xFFFFFF : 0;
    const std::int64_t moved = p + (target - p) * static_cast<std::int64_t>(rates()[n]) / 65536;
    state_ = (static_cast<std::uint32_t>(moved) << 8) | std::min(n + 1, kMostCount);
}

Mixer::Mixer(int models, std::size_t sets)
    : models_(models), weights_(sets * static_cast<std::size_t>(models), 6710886 / models) {  // 1.6 together
    assert(models <= kMostModels);
}

bool Mixer::code(RangeCoder& coder, Counter* const* slots, std::size_t set, bool bit) {
    std::int32_t* const w = weights_.data() + set * static_cast<std::size_t>(models_);
    std::array<int, kMostModels> s;
    std::int64_t sum = 0;
    for (int i = 0; i < models_; ++i) {
        s[i] = confident(*slots[i]);
        sum += static_cast<std::int64_t>(w[i]) * s[i];
    }
    const Probability p = clamped(Logistic::tables().squash(static_cast<int>(
        std::clamp<std::int64_t>(sum >> kWeightBits, -kStretchLimit, kStretchLimit))));
    bit = coder.code(bit, p);
    const std::int32_t error = (bit ? 65536 : 0) - static_cast<std::int32_t>(p);
    for (int i = 0; i < models_; ++i) {
        // 0.02 (y - p) s in the units of w, p and s: 0.02 2^22 / (2^16 2^8) = 1 / 200
        w[i] = std::clamp(w[i] + error * s[i] / 200, -kWeightLimit, kWeightLimit);
        slots[i]->update(bit);
    }
    return bit;
}

bool codeAlone(RangeCoder& coder, Counter& counter, bool bit) {
    bit = coder.code(bit, clamped(16 * counter.probability() + 8));
    counter.update(bit);
    return bit;
}

}  // namespace isowave::compress
