#include "volume/distance/image_samples.h"

#include <algorithm>
#include <limits>

namespace isowave {

using openvdb::Coord;

namespace {

constexpr int kSize = LeafSamples::kSize, kBefore = LeafSamples::kBefore;

}  // namespace

ImageExcess::ImageExcess(const ImageSolid& solid)
    : iso_(solid.label ? 0.5f : static_cast<float>(solid.iso)), turn_(solid.invert ? -1.0f : 1.0f) {
    if (solid.label) label_ = static_cast<float>(*solid.label);
}

ImageSamples::ImageSamples(const Image& image, const ImageSolid& solid)
    : size_(image.size), margin_(solid.openBorder ? kOpenBorder : 0), excess_(solid) {}

std::int64_t ImageSamples::nearest(std::int64_t c, std::size_t axis) const {
    return std::clamp<std::int64_t>(c, 0, size_[axis] - 1);
}

bool ImageSamples::isBeyond(const Coord& c) const {
    for (int a = 0; a < 3; ++a)
        if (c[a] < -margin_ || c[a] >= size_[static_cast<std::size_t>(a)] + margin_) return true;
    return false;
}

void ImageSamples::keep(const Slab& slab) {
    std::visit(
        [&]<class T>(std::span<const T> voxels) {
            const auto count = static_cast<std::size_t>(size_[0] * size_[1]);
            for (std::int64_t z = slab.z0; z < slab.z1; ++z) {
                const auto slice = voxels.subspan(static_cast<std::size_t>(z - slab.z0) * count, count);
                std::vector<T> copy(slice.begin(), slice.end());
                const std::lock_guard lock(mutex_);
                slices_.emplace(z, std::move(copy));
            }
        },
        slab.voxels);
}

bool ImageSamples::sufficeFor(const Coord& origin, std::int64_t z) const {
    return nearest(origin.z() + kSize - kBefore - 1, 2) < z;
}

void ImageSamples::forgetBefore(const Coord& origin) {
    slices_.erase(slices_.begin(), slices_.lower_bound(nearest(origin.z() - kBefore, 2)));
}

template <class T>
void ImageSamples::gatherSlice(const T* slice, const Coord& first, float (*rows)[kSize]) const {
    const bool whole = first.x() >= 0 && first.x() + kSize <= size_[0];
    for (int j = 0; j < kSize; ++j) {
        const T* row = slice + size_[0] * nearest(first.y() + j, 1);
        if (whole)
            for (int k = 0; k < kSize; ++k) rows[j][k] = excess_(static_cast<float>(row[first.x() + k]));
        else
            for (int k = 0; k < kSize; ++k)
                rows[j][k] = excess_(static_cast<float>(row[nearest(first.x() + k, 0)]));
    }
}

void ImageSamples::cap(const Coord& first, LeafSamples& samples) const {
    if (!isBeyond(first) && !isBeyond(first.offsetBy(kSize - 1))) return;
    for (int i = 0; i < kSize; ++i)
        for (int j = 0; j < kSize; ++j)
            for (int k = 0; k < kSize; ++k) {
                float& value = samples.values[i][j][k];
                if (value > 0 && isBeyond(first.offsetBy(k, j, i))) value = -value;
            }
}

void ImageSamples::gather(const Coord& origin, LeafSamples& samples) const {
    const Coord first = origin.offsetBy(-kBefore);
    for (int i = 0; i < kSize; ++i)
        std::visit([&](const auto& slice) { gatherSlice(slice.data(), first, samples.values[i]); },
                   slices_.at(nearest(first.z() + i, 2)));
    cap(first, samples);
}

}  // namespace isowave
