// Where the last few symbols occurred before, and what followed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace isowave::compress {

class MatchModel {
  public:
    // least: symbols that have to agree before anything is predicted.
    explicit MatchModel(int least);

    // The symbol that followed the latest occurrence of the last `least` ones; nothing where there was none.
    std::optional<std::int32_t> predicted() const;
    // For how many symbols it has been right, at most 2^20; 0: nothing is predicted.
    int length() const { return length_; }
    // The next symbol.
    void add(std::int32_t symbol);

  private:
    std::size_t hashOfLast() const;
    void look();

    int least_;
    std::vector<std::int32_t> symbols_;
    std::vector<std::uint32_t> latest_;  // by hash: 1 + the place that follows; 0: none
    std::size_t place_ = 0;              // in symbols_, of the prediction
    int length_ = 0;
};

// 0: nothing predicted; 1 + log2 of the length, at most 8
int matchBucket(int length);

}  // namespace isowave::compress
