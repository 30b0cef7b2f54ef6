// The bytes of an input as a supply of small numbers, for targets that make shapes of them. A supply that has run out gives 0, so
// that shorter inputs are simpler shapes.
#pragma once

#include <cstdint>
#include <string_view>

namespace isowave::fuzz {

class Bytes {
  public:
    explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

    bool empty() const { return at_ >= bytes_.size(); }
    int next() { return empty() ? 0 : static_cast<unsigned char>(bytes_[at_++]); }
    // low <= value <= high. REQUIRES: high - low < 256.
    int between(int low, int high) { return low + next() % (high - low + 1); }
    bool flag() { return (next() & 1) != 0; }
    double unit() { return next() / 255.0; }  // [0, 1]

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

}  // namespace isowave::fuzz
