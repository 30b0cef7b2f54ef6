// What an image's voxels are less the iso value, around one leaf after another, of slices that are kept no longer than
// needed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "io/image/stream.h"
#include "volume/distance/crossings.h"
#include "volume/image_solid.h"

namespace isowave {

// value - iso in float32, positive inside, whose sign is InsideTest's. A voxel on the iso value is outside: the smallest number
// below zero, so that it lies on the surface where an inside voxel is beside it and is nothing otherwise.
class ImageExcess {
  public:
    explicit ImageExcess(const ImageSolid& solid);

    float operator()(float value) const {
        const float excess = turn_ * ((label_ ? float(value == *label_) : value) - iso_);
        return excess == 0 ? -std::numeric_limits<float>::min() : excess;
    }

  private:
    float iso_, turn_;
    std::optional<float> label_;
};

class ImageSamples {
  public:
    ImageSamples(const Image& image, const ImageSolid& solid);

    // Copies a slab's slices. Several threads may do that at once.
    void keep(const Slab& slab);
    // Whether slices [0, z) suffice for the leaf there.
    bool sufficeFor(const openvdb::Coord& origin, std::int64_t z) const;
    // Forgets what no leaf from this one on, by z, needs.
    void forgetBefore(const openvdb::Coord& origin);

    // The samples around a leaf, x fastest. Beyond the border: the nearest voxel's, mirrored at 0 where it is inside (the cap:
    // a solid that touches the border ends half a voxel outside it), or with an open border kOpenBorder voxels later.
    void gather(const openvdb::Coord& origin, LeafSamples& samples) const;

  private:
    using Slice = std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                               std::vector<std::uint16_t>, std::vector<float>>;
    std::int64_t nearest(std::int64_t c, std::size_t axis) const;
    bool isBeyond(const openvdb::Coord& c) const;
    template <class T>
    void gatherSlice(const T* slice, const openvdb::Coord& first, float (*rows)[LeafSamples::kSize]) const;
    void cap(const openvdb::Coord& first, LeafSamples& samples) const;

    std::array<std::int64_t, 3> size_;
    std::int64_t margin_;
    ImageExcess excess_;
    std::mutex mutex_;
    std::map<std::int64_t, Slice> slices_;
};

}  // namespace isowave
