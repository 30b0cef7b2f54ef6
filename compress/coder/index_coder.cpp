#include "compress/coder/index_coder.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

#include "compress/coder/contexts.h"
#include "compress/coder/match_model.h"
#include "compress/coder/mixer.h"

namespace isowave::compress {
namespace {

constexpr int kModels = 11;
constexpr int kSlots = 16;     // counters of a context: a cache line of 64 bytes
constexpr int kUnaryEnd = 15;  // residuals from here on are escaped
constexpr int kZero = 0, kSign = kUnaryEnd;
constexpr int kClip = 20;
constexpr int kErrorLevels = 24;
constexpr std::int32_t kLargestError = 16 * 60;  // of a position, in 1/16

struct Cell {
    std::int32_t q, value;
    std::int32_t error;  // |position - predicted position|, in 1/16
    std::int32_t known;
};

// What is told of a point before it is coded.
struct Guess {
    std::int32_t base;  // the index guessed
    std::int32_t position;
    std::array<std::uint32_t, kModels> contexts;
    std::size_t set;
};

int levelOf(std::uint64_t error16) {  // 2 log2(4 e + 1/4) + 4, e = error16 / 16
    return std::min(twiceLog(error16 * 16 + 16) - 8, kErrorLevels - 1);
}

class Coder {
  public:
    Coder(const IndexModel& model, std::size_t points, RangeCoder& coder)
        : model_(model),
          coder_(coder),
          outside_{model.outside, model.quantiser.value(model.outside), 0, 0},
          inside_{-model.outside, model.quantiser.value(-model.outside), 0, 0},
          window_(model.lattice.size, outside_),
          mixer_(std::size_t{kErrorLevels} * 9 * kSlots),
          contextMask_((1u << contextBitsFor(points)) - 1),
          matches_{MatchModel(5, placeBitsFor(points)), MatchModel(12, placeBitsFor(points))} {
        for (auto& table : tables_) table.resize(std::size_t{kSlots} * (contextMask_ + 1));
    }

    void code(int begin, int end, std::vector<std::int32_t>& indices) {
        walk(model_.lattice, begin, end, window_, [&](std::size_t i) {
            const Guess guess = look();
            const std::int32_t q = guess.base + codeResidual(guess, indices[i] - guess.base);
            if (std::abs(q) > model_.quantiser.most()) throw std::runtime_error("an index out of range");
            indices[i] = q;
            const std::int32_t error = std::abs(16 * q - guess.position);
            window_.here() = {q, model_.quantiser.value(q), std::min(error, kLargestError), 1};
            for (MatchModel& match : matches_) match.add(q);
            return q < 0 ? inside_ : outside_;
        });
    }

  private:
    std::int32_t q(const Back& o) const { return window_.at(o).q; }
    int same(const Back& a, const Back& b) const { return q(a) == q(b); }

    // Was copying along an axis right at the neighbour on that axis, 1, and at the other two, 2 each?
    int copiesX() const { return same(kX, {-2, 0, 0}) + 2 * (same(kY, {-1, -1, 0}) + same(kZ, {-1, 0, -1})); }
    int copiesY() const { return same(kY, {0, -2, 0}) + 2 * (same(kX, {-1, -1, 0}) + same(kZ, {0, -1, -1})); }
    int copiesZ() const { return same(kZ, {0, 0, -2}) + 2 * (same(kX, {-1, 0, -1}) + same(kY, {0, -1, -1})); }

    Guess look() {
        const int kind = window_.at(kX).known + 2 * window_.at(kY).known + 4 * window_.at(kZ).known;
        Neighbours neighbours;
        std::uint64_t errors = 0;
        for (std::size_t k = 0; k < kBefore.size(); ++k) {
            const Cell& cell = window_.at(kBefore[k]);
            neighbours[k] = cell.value;
            errors += kErrorWeights[k] * static_cast<std::uint64_t>(cell.error);
        }
        const std::int32_t value = model_.weights.guess(kind, neighbours);
        Guess g;
        g.position = model_.quantiser.position(value);
        g.base = (g.position + 8) >> 4;
        const int e = levelOf(errors / kErrorWeightSum);
        const int e3 = levelOf(
            static_cast<std::uint64_t>(window_.at(kX).error + window_.at(kY).error + window_.at(kZ).error) /
            3);
        const int height = std::min(std::abs(value) / (kOneVoxel / 2), 9);
        const int part = ((g.position + 8) & 15) * 3 >> 4;
        g.contexts[0] = static_cast<std::uint32_t>(8 * e + kind);
        g.contexts[1] = static_cast<std::uint32_t>((e3 * 10 + height) * 3 + part);
        copies(g);
        columns(g);
        const int longest = matches(g);
        fetch(g);
        g.set = static_cast<std::size_t>((e * 3 + (copiesZ() >= 5) + (copiesY() >= 5)) * 3 + longest);
        return g;
    }

    // Counters lie all over the tables: all of them are asked for at once, before the first is needed.
    void fetch(Guess& g) const {
        for (std::size_t m = 0; m < kModels; ++m) {
            g.contexts[m] &= contextMask_;
            __builtin_prefetch(&tables_[m][static_cast<std::size_t>(g.contexts[m]) * kSlots], 1);
        }
    }

    void copies(Guess& g) const {
        const auto from = [&](const Back& o) { return std::clamp(q(o) - g.base, -kClip, kClip); };
        const std::int32_t x = from(kX), y = from(kY), z = from(kZ);
        g.contexts[2] = hashed({z, copiesZ()});
        g.contexts[3] = hashed({y, copiesY(), 0});
        g.contexts[4] = hashed({x, copiesX(), 1});
        g.contexts[5] = hashed({z, y, x});
        g.contexts[6] =
            hashed({z, y, x, q({0, -1, -1}) - g.base, q({-1, 0, -1}) - g.base, q({-1, -1, 0}) - g.base});
    }
    void columns(Guess& g) const {
        const std::int32_t z1 = q(kZ), z2 = q({0, 0, -2}), z3 = q({0, 0, -3});
        const std::int32_t near = std::clamp(z1 - g.base, -kClip, kClip);
        g.contexts[7] = hashed({near, z1, z1 - z2, z2 - z3});
        g.contexts[8] = hashed({near, z1, z1 - z2, q(kY) - q({0, -1, -1}), q(kX) - q({-1, 0, -1})});
    }
    // 0, 1, 2: neither predicts; one does; one does and was right for long
    int matches(Guess& g) const {
        int longest = 0;
        for (std::size_t m = 0; m < 2; ++m) {
            const MatchModel& match = matches_[m];
            const auto symbol = match.predicted();
            g.contexts[9 + m] = hashed(
                {symbol ? std::clamp(*symbol - g.base, -kClip, kClip) : 0, matchBucket(match.length())});
            longest = match.length();
        }
        return longest == 0 ? 0 : longest < 32 ? 1 : 2;
    }

    bool bit(const Guess& g, int slot, bool value) {
        Mixer<kModels>::Slots slots;
        for (std::size_t m = 0; m < kModels; ++m)
            slots[m] = &tables_[m][static_cast<std::size_t>(g.contexts[m]) * kSlots +
                                   static_cast<std::size_t>(slot)];
        return mixer_.code(coder_, slots, g.set * kSlots + static_cast<std::size_t>(slot), value);
    }
    std::int32_t codeResidual(const Guess& g, std::int32_t residual) {
        const std::int32_t size = std::abs(residual);
        if (!bit(g, kZero, size > 0)) return 0;
        const bool negative = bit(g, kSign, residual < 0);
        std::int32_t k = 1;
        while (k < kUnaryEnd && bit(g, k, size > k)) ++k;
        if (k == kUnaryEnd) k += escape(size - k);
        return negative ? -k : k;
    }
    // Exp-Golomb: how many bits n + 1 has, then the bits below its leading one
    std::int32_t escape(std::int32_t n) {
        const int wanted = coder_.decodes() ? 0 : std::bit_width(static_cast<std::uint32_t>(n + 1)) - 1;
        int bits = 0;
        while (codeAlone(coder_, escapes_[static_cast<std::size_t>(bits)], bits < wanted))
            if (++bits > 28) throw std::runtime_error("an index out of range");
        const std::uint32_t low = coder_.raw(static_cast<std::uint32_t>(n + 1), bits);
        return static_cast<std::int32_t>((1u << bits) + low) - 1;
    }

    const IndexModel& model_;
    RangeCoder& coder_;
    Cell outside_, inside_;
    Window<Cell> window_;
    Mixer<kModels> mixer_;
    std::uint32_t contextMask_;
    std::array<std::vector<Counter>, kModels> tables_;
    std::array<Counter, 32> escapes_;
    std::array<MatchModel, 2> matches_;
};

}  // namespace

std::string encodeIndices(const IndexModel& model, int begin, int end, std::vector<std::int32_t>& indices) {
    RangeCoder coder;
    Coder(model, model.lattice.firstOf(end) - model.lattice.firstOf(begin), coder).code(begin, end, indices);
    return coder.finish();
}

void decodeIndices(const IndexModel& model, int begin, int end, std::string_view bytes,
                   std::vector<std::int32_t>& indices) {
    RangeCoder coder(bytes);
    Coder(model, model.lattice.firstOf(end) - model.lattice.firstOf(begin), coder).code(begin, end, indices);
    if (!coder.atEnd()) throw std::runtime_error("the values end before their bytes do");
}

}  // namespace isowave::compress
