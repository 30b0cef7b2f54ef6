// A quantiser whose step grows away from the surface, where an error of F does no harm.
//
//   t = T tan(u / T),  u = q delta:   a step of delta at t = 0 and of delta (1 + (t / T)^2) at t, T = 2.5 voxels
//
// Values are t in voxels, as whole multiples of 2^-16: 65536 is a distance of one voxel. tan() is Padé's
// x (15 - x^2) / (15 - 6 x^2), of basic operations on doubles only, and a straight line beyond x = 1.2, so the table is the
// same on every machine and every value has an index.
#pragma once

#include <cstdint>
#include <vector>

namespace isowave::compress {

inline constexpr std::int32_t kOneVoxel = 65536;

class Quantiser {
  public:
    // delta: voxels, kLeastDelta <= delta <= kMostDelta. reach: values up to so many voxels have an index, 0 < reach <= kMostReach.
    Quantiser(double delta, double reach);
    static constexpr double kLeastDelta = 1e-4, kMostDelta = 64, kMostReach = 1024;

    std::int32_t most() const { return most_; }  // indices are -most() .. most()
    std::int32_t value(std::int32_t q) const { return values_[static_cast<std::size_t>(q + most_)]; }
    // 16 times the real-valued index of `value`, clamped to the indices' range: 16 q at value(q), linear between two.
    std::int32_t position(std::int32_t value) const;
    // The nearest in u, which is where position() rounds to.
    std::int32_t index(std::int32_t value) const { return (position(value) + 8) >> 4; }

  private:
    std::int32_t most_;
    std::vector<std::int32_t> values_;
    std::vector<std::int32_t> starts_;  // an index at or below each value's, by 1/64 voxel
};

}  // namespace isowave::compress
