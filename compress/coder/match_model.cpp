#include "compress/coder/match_model.h"

#include <algorithm>
#include <bit>

namespace isowave::compress {
namespace {

constexpr int kHashBits = 20;
constexpr int kLongest = 1 << 20;
constexpr std::size_t kCheckedBack = 32;

}  // namespace

MatchModel::MatchModel(int least) : least_(least), latest_(std::size_t{1} << kHashBits, 0) {}

std::optional<std::int32_t> MatchModel::predicted() const {
    if (length_ == 0) return std::nullopt;
    return symbols_[place_];
}

std::size_t MatchModel::hashOfLast() const {
    std::uint32_t h = 0;
    for (int j = 1; j <= least_; ++j)
        h = (h + static_cast<std::uint32_t>(symbols_[symbols_.size() - static_cast<std::size_t>(j)]) + 77777) *
            2654435761u;
    return h >> (32 - kHashBits);
}

void MatchModel::add(std::int32_t symbol) {
    if (length_ > 0) {
        length_ = symbols_[place_] == symbol ? std::min(length_ + 1, kLongest) : 0;
        ++place_;
    }
    symbols_.push_back(symbol);
    if (symbols_.size() >= static_cast<std::size_t>(least_)) look();
}

// The table is read before this place is entered: a place that finds itself would predict what is not there yet.
void MatchModel::look() {
    std::uint32_t& latest = latest_[hashOfLast()];
    if (length_ == 0 && latest > 0) {
        const std::size_t here = symbols_.size(), there = latest;
        std::size_t agree = 0;
        while (agree < kCheckedBack && agree < there && symbols_[there - 1 - agree] == symbols_[here - 1 - agree]) ++agree;
        if (agree >= static_cast<std::size_t>(least_)) {
            place_ = there;
            length_ = static_cast<int>(agree);
        }
    }
    latest = static_cast<std::uint32_t>(symbols_.size());
}

int matchBucket(int length) {
    return length == 0 ? 0 : std::min<int>(std::bit_width(static_cast<unsigned>(length)), 8);
}

}  // namespace isowave::compress
