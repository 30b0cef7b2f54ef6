#include "compress/coder/range_coder.h"

#include <utility>

namespace isowave::compress {

RangeCoder::RangeCoder(std::string_view encoded) : decodes_(true), encoded_(encoded) {
    for (int i = 0; i < 4; ++i) window_ = (window_ << 8) | next();
}

std::uint8_t RangeCoder::next() {
    return at_ < encoded_.size() ? static_cast<std::uint8_t>(encoded_[at_++]) : std::uint8_t{0};
}

void RangeCoder::shift() {
    if (decodes_)
        window_ = (window_ << 8) | next();
    else
        bytes_ += static_cast<char>(high_ >> 24);
    low_ <<= 8;
    high_ = (high_ << 8) | 255;
}

std::uint32_t RangeCoder::raw(std::uint32_t value, int count) {
    std::uint32_t result = 0;
    while (count-- > 0) result = (result << 1) | std::uint32_t{code((value >> count) & 1, 32768)};
    return result;
}

// Any number of [low, high] will do; four bytes, because the decoder begins with four.
std::string RangeCoder::finish() {
    for (int i = 0; i < 4; ++i) bytes_ += static_cast<char>(low_ >> (24 - 8 * i));
    return std::exchange(bytes_, {});
}

}  // namespace isowave::compress
