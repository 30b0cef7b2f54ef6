// Which voxels of an image are inside the solid.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "isowave/image.h"
#include "volume/vdb.h"

namespace isowave {

// With an open border the border's voxels continue this many voxels outwards before the cap; a mesh is then
// cut off at the border itself (clipToBox() in polygonize/clip.h).
inline constexpr int kOpenBorder = 16;

struct ImageSolid {
    double iso = 0.5;     // inside where value > iso
    bool invert = false;  // inside where value < iso
    // Given: inside where value == label (with invert: where it is not) and iso means nothing. For distances,
    // voxels count as 1 where they have the label, as 0 elsewhere, and the surface is at 0.5.
    std::optional<double> label = {};
    bool openBorder = false;  // true: no cap; the border's values continue outwards instead of "outside"
};

// Lattice points of an image as a box; with an open border, the border's voxels continue outwards.
inline openvdb::CoordBBox boxOf(const Image& image, bool openBorder) {
    openvdb::CoordBBox box(0, 0, 0, int(image.size[0]) - 1, int(image.size[1]) - 1, int(image.size[2]) - 1);
    if (openBorder) box.expand(kOpenBorder);
    return box;
}

// Inside is where low <= value <= high, or, flipped, where it is not; values as float32.
struct InsideTest {
    float low, high;
    bool flip = false;

    explicit InsideTest(const ImageSolid& solid) {
        constexpr float kAll = std::numeric_limits<float>::infinity();
        const auto iso = static_cast<float>(solid.iso);
        if (solid.label)
            *this = {static_cast<float>(*solid.label), static_cast<float>(*solid.label), solid.invert};
        else if (solid.invert)
            *this = {-kAll, std::nextafter(iso, -kAll), false};
        else
            *this = {std::nextafter(iso, kAll), kAll, false};
    }
    InsideTest(float l, float h, bool f) : low(l), high(h), flip(f) {}

    bool operator()(float value) const { return (low <= value && value <= high) != flip; }

    // The same range in T; empty (first > last) where T holds none of it. Exact: every value of the narrow
    // types is a float32.
    template <class T>
    std::pair<T, T> rangeIn() const {
        if constexpr (std::is_same_v<T, float>) {
            return {low, high};
        } else {
            constexpr float kLeast = std::numeric_limits<T>::min(), kMost = std::numeric_limits<T>::max();
            const float first = std::ceil(std::max(low, kLeast)), last = std::floor(std::min(high, kMost));
            if (!(first <= last)) return {T(1), T(0)};
            return {static_cast<T>(first), static_cast<T>(last)};
        }
    }
};

}  // namespace isowave
