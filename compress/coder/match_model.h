// Where the last few symbols occurred before, and what followed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace isowave::compress {

class MatchModel {
  public:
    // least: symbols that have to agree before anything is predicted, at least 3. tableBits: of the table of places.
    explicit MatchModel(int least, int tableBits = 20)
        : least_(static_cast<std::size_t>(least)),
          factor_(kOdd << ((64 + least - 1) / least)),
          shift_(64 - tableBits),
          latest_(std::size_t{1} << tableBits, 0) {}

    // The symbol that followed the latest occurrence of the last `least` ones; nothing where there was none.
    std::optional<std::int32_t> predicted() const {
        if (length_ == 0) return std::nullopt;
        return symbols_[place_];
    }
    // For how many symbols it has been right, at most 2^20; 0: nothing is predicted.
    int length() const { return length_; }

    // The next symbol.
    void add(std::int32_t symbol) {
        if (length_ > 0) {
            length_ = symbols_[place_] == symbol ? std::min(length_ + 1, kLongest) : 0;
            ++place_;
        }
        symbols_.push_back(symbol);
        hash_ = hash_ * factor_ + (static_cast<std::uint32_t>(symbol) + std::uint64_t{1}) * kOdd;
        std::uint32_t& latest = latest_[(hash_ * kOdd) >> shift_];
        // Before this place is entered: a place that finds itself would predict what is not there yet.
        if (length_ == 0 && latest > 0) look(latest);
        latest = static_cast<std::uint32_t>(symbols_.size());
    }

  private:
    static constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15ULL;
    static constexpr int kLongest = 1 << 20;

    void look(std::size_t there);

    std::size_t least_;
    // Each symbol multiplies what came before it by an odd number and a power of two, so that a symbol has left the hash after
    // `least` others.
    std::uint64_t factor_, hash_ = 0;
    int shift_;
    std::vector<std::int32_t> symbols_;
    std::vector<std::uint32_t> latest_;  // by hash: 1 + the place that follows; 0: none
    std::size_t place_ = 0;              // in symbols_, of the prediction
    int length_ = 0;
};

// 0: nothing predicted; 1 + log2 of the length, at most 8
inline int matchBucket(int length) {
    return length == 0 ? 0 : std::min<int>(std::bit_width(static_cast<unsigned>(length)), 8);
}

}  // namespace isowave::compress
