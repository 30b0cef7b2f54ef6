#include "compress/coder/float_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "compress/coder/contexts.h"
#include "compress/coder/match_model.h"
#include "compress/coder/mixer.h"

namespace isowave::compress {
namespace {

constexpr int kRepeatModels = 5, kSizeModels = 6, kSignModels = 3;
constexpr int kCandidates = 5;
constexpr int kSizeBits = 6;       // 0 .. 33 bits
constexpr int kTopBits = 2;        // below the leading one, that have a model
constexpr double kOneK = 1 << 24;  // a value of K as predictions take it

struct Cell {
    std::int32_t ordered;
    std::int32_t value;  // in K / 2^24
    std::uint8_t size;   // bits of the residual; 0 after a repeat
    std::uint8_t hit;    // 0: no repeat; else 1 + which candidate
    std::uint8_t negative;
    std::uint8_t known;
};

// Floats as integers of the same order: -0 is -1.
std::int32_t orderedOf(float value) {
    const auto bits = std::bit_cast<std::int32_t>(value);
    return bits >= 0 ? bits
                     : static_cast<std::int32_t>(~static_cast<std::uint32_t>(bits)) ^
                           static_cast<std::int32_t>(0x80000000u);
}
float floatOf(std::int32_t ordered) {
    return std::bit_cast<float>(ordered >= 0 ? ordered
                                             : static_cast<std::int32_t>(~static_cast<std::uint32_t>(
                                                   ordered ^ static_cast<std::int32_t>(0x80000000u))));
}

// Not a number is the least of all, as machines with SSE convert it: the files of others are the same.
std::int32_t fixedOf(float value, double scale) {
    if (value != value) return std::numeric_limits<std::int32_t>::min();
    return static_cast<std::int32_t>(
        std::clamp(std::floor(static_cast<double>(value) * scale + 0.5), -1073741824.0, 1073741824.0));
}

// A value that stood beside the same three neighbours.
class Besides {
  public:
    std::int32_t& at(std::int32_t x, std::int32_t y, std::int32_t z) {
        std::uint64_t h = static_cast<std::uint32_t>(x);
        h = (h * 0x9E3779B97F4A7C15ULL) ^ (h >> 31) ^ static_cast<std::uint32_t>(y);
        h = (h * 0x9E3779B97F4A7C15ULL) ^ (h >> 31) ^ static_cast<std::uint32_t>(z);
        return values_[(h * 0x9E3779B97F4A7C15ULL) >> (64 - kBits)];
    }

  private:
    static constexpr int kBits = 18;
    std::vector<std::int32_t> values_ = std::vector<std::int32_t>(std::size_t{1} << kBits, 0);
};

class Coder {
  public:
    Coder(const FloatModel& model, std::size_t points, RangeCoder& coder)
        : model_(model),
          coder_(coder),
          scale_(kOneK / model.K),
          outside_{orderedOf(model.K), fixedOf(model.K, scale_), 24, 0, 0, 0},
          inside_{orderedOf(-model.K), fixedOf(-model.K, scale_), 24, 0, 1, 0},
          window_(model.lattice.size, outside_),
          repeatMixer_(kCandidates + 1),
          sizeMixer_(std::size_t{1} << kSizeBits),
          signMixer_(1),
          match_(6, placeBitsFor(points)) {
        const int bits = contextBitsFor(points);
        for (auto& t : repeats_) t.resize(std::size_t{1} << bits);
        for (auto& t : sizes_) t.resize(std::size_t{1} << (bits + kSizeBits - 4));
        for (auto& t : signs_) t.resize(std::size_t{1} << 12);
        tops_.resize(std::size_t{64} << kTopBits);
    }

    void code(int begin, int end, std::vector<float>& values) {
        walk(model_.lattice, begin, end, window_, [&](std::size_t i) {
            const std::int32_t wanted = coder_.decodes() ? 0 : orderedOf(values[i]);
            Cell cell = codeOne(wanted);
            const float value = floatOf(cell.ordered);
            values[i] = value;
            cell.value = fixedOf(value, scale_);
            cell.known = 1;
            beside() = cell.ordered;
            match_.add(cell.ordered);
            window_.here() = cell;
            return value < 0 ? inside_ : outside_;
        });
    }

  private:
    const Cell& at(const Back& o) const { return window_.at(o); }
    std::int32_t ordered(const Back& o) const { return at(o).ordered; }
    int same(const Back& a, const Back& b) const { return ordered(a) == ordered(b); }
    std::int32_t& beside() { return besides_.at(ordered(kX), ordered(kY), ordered(kZ)); }

    Cell codeOne(std::int32_t wanted) {
        Cell cell{};
        std::array<std::int32_t, kCandidates> candidates;
        const int count = collect(candidates);
        lookForRepeats();
        const bool repeated = repeatBit(0, std::find(candidates.begin(), candidates.begin() + count,
                                                     wanted) != candidates.begin() + count);
        if (repeated) cell.hit = static_cast<std::uint8_t>(1 + codeWhich(candidates, count, wanted));
        if (repeated)
            cell.ordered = candidates[static_cast<std::size_t>(cell.hit - 1)];
        else
            codeDifference(cell, wanted);
        return cell;
    }

    // Different ones, the likeliest first.
    int collect(std::array<std::int32_t, kCandidates>& candidates) {
        int count = 0;
        const auto add = [&](std::int32_t value) {
            if (std::find(candidates.begin(), candidates.begin() + count, value) ==
                candidates.begin() + count)
                candidates[static_cast<std::size_t>(count++)] = value;
        };
        if (const auto predicted = match_.predicted()) add(*predicted);
        add(beside());
        for (const Back& o : {kZ, kY, kX}) add(ordered(o));
        return count;
    }
    std::int32_t codeWhich(const std::array<std::int32_t, kCandidates>& candidates, int count,
                           std::int32_t wanted) {
        for (int j = 0; j + 1 < count; ++j)
            if (repeatBit(j + 1, candidates[static_cast<std::size_t>(j)] == wanted)) return j;
        return count - 1;
    }

    void lookForRepeats() {
        const int hits = at(kZ).hit + 6 * at(kY).hit + 36 * at(kX).hit;
        const int known = at(kX).known + 2 * at(kY).known + 4 * at(kZ).known;
        const int copies = same(kZ, {0, 0, -2}) + 2 * same(kY, {0, -1, -1}) + 4 * same(kX, {-1, 0, -1}) +
                           8 * same(kX, {-1, -1, 0}) + 16 * same(kY, {0, -2, 0}) + 32 * same(kX, {-2, 0, 0});
        const int match = matchBucket(match_.length());
        repeatContexts_ = {hashed({match, at(kZ).hit, 0}), hashed({hits, match > 0, 1}),
                           hashed({copies, known, 2}), hashed({match, copies, hits, 3}),
                           hashed({at(kZ).hit, at({0, 0, -2}).hit, at({0, 0, -3}).hit, at({0, -1, 1}).hit,
                                   at({-1, 0, 1}).hit, at({-1, 1, 0}).hit})};
    }
    bool repeatBit(int which, bool bit) {
        Mixer<kRepeatModels>::Slots slots;
        for (std::size_t m = 0; m < kRepeatModels; ++m)
            slots[m] = &repeats_[m][(repeatContexts_[m] + static_cast<std::uint32_t>(which) * 0x9E37u) &
                                    (repeats_[m].size() - 1)];
        return repeatMixer_.code(coder_, slots, static_cast<std::size_t>(which), bit);
    }

    void codeDifference(Cell& cell, std::int32_t wanted) {
        const int kind = at(kX).known + 2 * at(kY).known + 4 * at(kZ).known;
        Neighbours neighbours;
        for (std::size_t k = 0; k < kBefore.size(); ++k) neighbours[k] = at(kBefore[k]).value;
        const float guess = static_cast<float>(model_.weights.guess(kind, neighbours) / scale_);
        const std::int32_t from = orderedOf(guess);
        const std::int64_t difference = static_cast<std::int64_t>(wanted) - from;
        const auto magnitude = static_cast<std::uint64_t>(difference < 0 ? -difference : difference);
        const int exponent = static_cast<int>((std::bit_cast<std::uint32_t>(guess) >> 23) & 255);
        const int size = codeSize(static_cast<int>(std::bit_width(magnitude)), exponent, kind);
        cell.size = static_cast<std::uint8_t>(size);
        if (size > 0) cell.negative = codeSign(difference < 0, exponent);
        const std::uint64_t coded = size > 0 ? codeBits(magnitude, size) : 0;
        const std::int64_t value =
            cell.negative ? from - static_cast<std::int64_t>(coded) : from + static_cast<std::int64_t>(coded);
        if (value < INT32_MIN || value > INT32_MAX) throw std::runtime_error("a value out of range");
        cell.ordered = static_cast<std::int32_t>(value);
    }

    int codeSize(int size, int exponent, int kind) {
        const int x = at(kX).size, y = at(kY).size, z = at(kZ).size;
        const int mean =
            (2 * (x + y + z) + at({0, -1, -1}).size + at({-1, 0, -1}).size + at({-1, -1, 0}).size) * 2 / 9;
        const std::array<std::uint32_t, kSizeModels> contexts{
            hashed({mean, exponent, 0}), hashed({z, y, exponent, 1}),
            hashed({x, y, z, 2}),        hashed({exponent, kind, 3}),
            hashed({mean, z, kind, 4}),  hashed({z, at({0, 0, -2}).size, at({0, 0, -3}).size, 5})};
        int node = 1;
        for (int b = kSizeBits - 1; b >= 0; --b) {
            Mixer<kSizeModels>::Slots slots;
            for (std::size_t m = 0; m < kSizeModels; ++m)
                slots[m] = &sizes_[m][(contexts[m] * 4u + static_cast<std::uint32_t>(node) * 0x9E3779u) &
                                      (sizes_[m].size() - 1)];
            node = 2 * node + sizeMixer_.code(coder_, slots, static_cast<std::size_t>(node), (size >> b) & 1);
        }
        const int coded = node - (1 << kSizeBits);
        if (coded > 33) throw std::runtime_error("a value out of range");
        return coded;
    }
    std::uint8_t codeSign(bool negative, int exponent) {
        const int near = at(kX).negative + 2 * at(kY).negative + 4 * at(kZ).negative;
        const std::array<std::size_t, kSignModels> contexts{
            static_cast<std::size_t>(near), static_cast<std::size_t>(8 * exponent + near),
            static_cast<std::size_t>(near + 8 * at({0, -1, -1}).negative + 16 * at({-1, 0, -1}).negative +
                                     32 * at({-1, -1, 0}).negative)};
        Mixer<kSignModels>::Slots slots;
        for (std::size_t m = 0; m < kSignModels; ++m) slots[m] = &signs_[m][contexts[m]];
        return signMixer_.code(coder_, slots, 0, negative);
    }
    // The bits below the leading one.
    std::uint64_t codeBits(std::uint64_t magnitude, int size) {
        int left = size - 1;
        std::uint64_t result = 1, node = 1;
        for (int t = 0; t < kTopBits && left > 0; ++t) {
            const bool bit = codeAlone(coder_, tops_[(static_cast<std::size_t>(size) << kTopBits) + node],
                                       (magnitude >> --left) & 1);
            node = 2 * node + bit;
            result = 2 * result + bit;
        }
        return (result << left) | coder_.raw(static_cast<std::uint32_t>(magnitude), left);
    }

    const FloatModel& model_;
    RangeCoder& coder_;
    double scale_;
    Cell outside_, inside_;
    Window<Cell> window_;
    Mixer<kRepeatModels> repeatMixer_;
    Mixer<kSizeModels> sizeMixer_;
    Mixer<kSignModels> signMixer_;
    std::array<std::vector<Counter>, kRepeatModels> repeats_;
    std::array<std::vector<Counter>, kSizeModels> sizes_;
    std::array<std::vector<Counter>, kSignModels> signs_;
    std::vector<Counter> tops_;
    std::array<std::uint32_t, kRepeatModels> repeatContexts_{};
    MatchModel match_;
    Besides besides_;
};

}  // namespace

Weights fitFloatWeights(const Lattice& lattice, const std::vector<float>& values, float K) {
    std::vector<std::int32_t> fixed(values.size());
    std::vector<float> importance(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        fixed[i] = fixedOf(values[i], kOneK / K);
        importance[i] = 1 / (0.05f + std::abs(values[i] / K));  // floats are finer near zero
    }
    return fitWeights(lattice, fixed, fixedOf(K, kOneK / K), importance);
}

std::string encodeFloats(const FloatModel& model, int begin, int end, std::vector<float>& values) {
    RangeCoder coder;
    Coder(model, model.lattice.firstOf(end) - model.lattice.firstOf(begin), coder).code(begin, end, values);
    return coder.finish();
}

void decodeFloats(const FloatModel& model, int begin, int end, std::string_view bytes,
                  std::vector<float>& values) {
    RangeCoder coder(bytes);
    Coder(model, model.lattice.firstOf(end) - model.lattice.firstOf(begin), coder).code(begin, end, values);
    if (!coder.atEnd()) throw std::runtime_error("the values end before their bytes do");
}

}  // namespace isowave::compress
