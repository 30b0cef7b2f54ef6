#include "io/image/half.h"

#include <cmath>
#include <limits>

namespace isowave::imageio {

float floatOfHalf(std::uint16_t bits) {
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    const float sign = bits >> 15 ? -1.0f : 1.0f;
    if (exponent == 31)
        return fraction ? std::numeric_limits<float>::quiet_NaN()
                        : sign * std::numeric_limits<float>::infinity();
    if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
    return sign * std::ldexp(static_cast<float>(fraction + 1024), exponent - 25);
}

namespace {

class HalfSource : public VoxelSource {
  public:
    explicit HalfSource(SourcePtr bits) : bits_(std::move(bits)) {
        header = bits_->header;
        header.type = ValueType::float32;
        slicesPerRead = bits_->slicesPerRead;
        plain = bits_->plain;
    }

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        std::vector<std::uint16_t> bits(static_cast<std::size_t>((z1 - z0) * header.sliceVoxels()));
        bits_->readNative(z0, z1, bits.data());
        for (const std::uint16_t b : bits) *out++ = floatOfHalf(b);
        return 0;
    }

    bool isZero(std::int64_t z0, std::int64_t z1) override { return bits_->isZero(z0, z1); }

  private:
    SourcePtr bits_;
};

}  // namespace

SourcePtr halvesAsFloats(SourcePtr source) { return std::make_unique<HalfSource>(std::move(source)); }

}  // namespace isowave::imageio
