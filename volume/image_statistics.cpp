#include "volume/image_statistics.h"

#include <algorithm>
#include <cmath>

namespace isowave {
namespace {

// 4 M voxels give every percentile to a small fraction of a percent.
constexpr std::int64_t kSampleLog2 = 22;

// Voxels that are compared at once: most chunks hold one value, the last one seen, and need no more.
constexpr std::size_t kChunk = 64;

// Up to kMostDistinct + 1 values, ascending.
class DistinctValues {
  public:
    bool full() const { return values_.size() > ImageStatistics::kMostDistinct; }
    void add(float value) {
        if (full()) return;
        const auto at = std::lower_bound(values_.begin(), values_.end(), value);
        if (at == values_.end() || *at != value) values_.insert(at, value);
    }
    void add(const DistinctValues& other) {
        for (const float value : other.values_) add(value);
    }
    const std::vector<float>& values() const { return values_; }

  private:
    std::vector<float> values_;
};

// Of one slab.
struct Part {
    float low = INFINITY, high = -INFINITY;
    DistinctValues distinct;
    std::vector<float> sample;
    bool found = false;
};

template <class T>
void scan(std::span<const T> values, std::optional<float> wanted, Part& part) {
    T last = values.front();
    part.distinct.add(static_cast<float>(last));
    T low = last, high = last;
    bool found = wanted && static_cast<float>(last) == *wanted;
    for (std::size_t from = 0; from < values.size(); from += kChunk) {
        const auto chunk = values.subspan(from, std::min(kChunk, values.size() - from));
        T least = chunk[0], most = chunk[0];
        for (const T v : chunk) {
            least = std::min(least, v);
            most = std::max(most, v);
        }
        if (least == last && most == last) continue;
        low = std::min(low, least);
        high = std::max(high, most);
        if (wanted && !found)
            for (const T v : chunk) found |= static_cast<float>(v) == *wanted;
        if (part.distinct.full()) continue;
        for (const T v : chunk) {
            if (v == last) continue;
            last = v;
            part.distinct.add(static_cast<float>(v));
        }
    }
    part.low = static_cast<float>(low);
    part.high = static_cast<float>(high);
    part.found = found;
}

// Every stride-th voxel of the image; the slab's first voxel is number `from`.
template <class T>
void sample(std::span<const T> values, std::int64_t from, std::int64_t stride, std::vector<float>& out) {
    const auto count = static_cast<std::int64_t>(values.size());
    for (std::int64_t i = (stride - from % stride) % stride; i < count; i += stride)
        out.push_back(static_cast<float>(values[static_cast<std::size_t>(i)]));
}

std::vector<std::pair<int, float>> percentilesOf(std::vector<float>& sample) {
    std::vector<std::pair<int, float>> result;
    for (const int percent : {1, 5, 25, 50, 75, 95, 99}) {
        const auto nth = sample.begin() + static_cast<std::ptrdiff_t>((sample.size() - 1) * percent / 100);
        std::nth_element(sample.begin(), nth, sample.end());
        result.emplace_back(percent, *nth);
    }
    return result;
}

}  // namespace

ImageStatistics statisticsOf(ImageStream& stream, std::optional<float> wanted, const Progress& progress) {
    const Image& header = stream.header();
    const std::int64_t voxels = header.voxelCount(), slice = header.size[0] * header.size[1];
    if (voxels == 0) return {};
    const std::int64_t stride = std::max<std::int64_t>(1, voxels >> kSampleLog2);
    std::vector<Part> parts(
        static_cast<std::size_t>((header.size[2] + stream.slabSlices() - 1) / stream.slabSlices()));
    stream.pass("reading", progress, [&](const Slab& slab) {
        Part& part = parts[static_cast<std::size_t>(slab.z0 / stream.slabSlices())];
        std::visit(
            [&](auto values) {
                // Of voxels known to be 0, one says all.
                scan(slab.zero ? values.subspan(0, 1) : values, wanted, part);
                sample(values, slab.z0 * slice, stride, part.sample);
            },
            slab.voxels);
    });

    Part all;
    for (const Part& part : parts) {
        all.low = std::min(all.low, part.low);
        all.high = std::max(all.high, part.high);
        all.distinct.add(part.distinct);
        all.sample.insert(all.sample.end(), part.sample.begin(), part.sample.end());
        all.found |= part.found;
    }
    ImageStatistics result{all.low, all.high, percentilesOf(all.sample), {}, all.found};
    if (!all.distinct.full()) result.distinct = all.distinct.values();
    return result;
}

}  // namespace isowave
