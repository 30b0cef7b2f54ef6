// Inside volume/: which voxels of an image are inside.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "volume/distance.h"

namespace isowave {

// Lattice points of an image as a box; with an open border, the border's voxels continue outwards.
openvdb::CoordBBox boxOf(const Image& image, bool openBorder);  // image_nodes.cpp

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
