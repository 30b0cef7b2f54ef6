#include "compress/coder/range_coder.h"

#include <stdexcept>

namespace isowave::compress {
namespace {

constexpr std::size_t kLengthBytes = 4;  // of the first stream, at the very beginning

}  // namespace

RangeCoder::RangeCoder(std::string_view encoded) : decodes_(true) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < kLengthBytes && i < encoded.size(); ++i)
        length |= static_cast<std::size_t>(static_cast<std::uint8_t>(encoded[i])) << (8 * i);
    if (encoded.size() < kLengthBytes || length > encoded.size() - kLengthBytes)
        throw std::runtime_error("coded values are shorter than they say");
    encoded_ = encoded.substr(kLengthBytes, length);
    raw_ = encoded.substr(kLengthBytes + length);
    for (int i = 0; i < 4; ++i) window_ = (window_ << 8) | next();
}

// Any number of [low, high] will do; four bytes, because the decoder begins with four.
std::string RangeCoder::finish() {
    for (int i = 0; i < 4; ++i) bytes_ += static_cast<char>(low_ >> (24 - 8 * i));
    if (held_ > 0) rawBytes_ += static_cast<char>(reservoir_);
    std::string all;
    for (std::size_t i = 0; i < kLengthBytes; ++i) all += static_cast<char>(bytes_.size() >> (8 * i));
    return all + bytes_ + rawBytes_;
}

}  // namespace isowave::compress
