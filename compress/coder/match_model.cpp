#include "compress/coder/match_model.h"

namespace isowave::compress {

void MatchModel::look(std::size_t there) {
    const std::size_t here = symbols_.size(), most = std::min(std::max(least_, std::size_t{32}), there);
    std::size_t agree = 0;
    while (agree < most && symbols_[there - 1 - agree] == symbols_[here - 1 - agree]) ++agree;
    if (agree < least_) return;
    place_ = there;
    length_ = static_cast<int>(agree);
}

}  // namespace isowave::compress
