// A slab is gathered in blocks of 16 x 16 x 16 voxels: whichever axis is the fastest in memory, a line of the cache is read,
// and one of the slab written, once.
#include "io/image/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

constexpr std::int64_t kBlock = 16;

using Triple = std::array<std::int64_t, 3>;

ValueType typeOf(const VoxelView& view) {
    if (const auto type = valueTypeOf(view.type)) return *type;
    throw InputError(kViewName, fmt::format("voxels of type '{}' are not read; there are int8, uint8, int16, "
                                            "uint16, int32, uint32, int64, uint64, float32 and float64",
                                            view.type));
}

bool isSwapped(const VoxelView& view) { return view.bigEndian != (std::endian::native == std::endian::big); }

// The block of voxels from `low` on; `to` is where the slab's first voxel goes, x fastest.
template <int Bytes>
void gatherBlock(const char* from, const Triple& stride, const Triple& count, const Triple& low, char* to) {
    Triple high;
    for (std::size_t a = 0; a < 3; ++a) high[a] = std::min(low[a] + kBlock, count[a]);
    for (std::int64_t z = low[2]; z < high[2]; ++z)
        for (std::int64_t y = low[1]; y < high[1]; ++y) {
            const char* row = from + z * stride[2] + y * stride[1];
            char* out = to + (z * count[1] + y) * count[0] * Bytes;
            for (std::int64_t x = low[0]; x < high[0]; ++x)
                std::memcpy(out + x * Bytes, row + x * stride[0], Bytes);
        }
}

template <int Bytes>
void gather(const char* from, const Triple& stride, const Triple& count, char* to) {
    if (stride[0] == Bytes) {
        for (std::int64_t z = 0; z < count[2]; ++z)
            for (std::int64_t y = 0; y < count[1]; ++y)
                std::memcpy(to + (z * count[1] + y) * count[0] * Bytes, from + z * stride[2] + y * stride[1],
                            static_cast<std::size_t>(count[0] * Bytes));
        return;
    }
    for (std::int64_t z = 0; z < count[2]; z += kBlock)
        for (std::int64_t y = 0; y < count[1]; y += kBlock)
            for (std::int64_t x = 0; x < count[0]; x += kBlock)
                gatherBlock<Bytes>(from, stride, count, {x, y, z}, to);
}

class ViewSource : public VoxelSource {
  public:
    ViewSource(const VoxelView& view, Header h)
        : data_(static_cast<const char*>(view.data)), stride_(view.stride), swap_(isSwapped(view)) {
        header = std::move(h);
        slicesPerRead = header.size[2];
        native = !swap_;
        plain = true;
    }

    void readNative(std::int64_t z0, std::int64_t z1, void* out) override {
        const Triple count{header.size[0], header.size[1], z1 - z0};
        const char* from = data_ + z0 * stride_[2];
        const auto to = static_cast<char*>(out);
        switch (sizeOf(header.type)) {
            case 1:
                return gather<1>(from, stride_, count, to);
            case 2:
                return gather<2>(from, stride_, count, to);
            case 4:
                return gather<4>(from, stride_, count, to);
            default:
                return gather<8>(from, stride_, count, to);
        }
    }

    std::int64_t read(std::int64_t z0, std::int64_t z1, float* out) override {
        const std::int64_t voxels = (z1 - z0) * header.sliceVoxels();
        std::vector<char> stored(static_cast<std::size_t>(voxels) * sizeOf(header.type));
        readNative(z0, z1, stored.data());
        return convert(header.type, stored.data(), voxels, swap_, out);
    }

  private:
    const char* data_;
    Triple stride_;
    bool swap_;
};

// Spacing and unit directions of the axes, as headers have them.
void putGeometry(const AffineTransform& transform, Header& header) {
    for (int a = 0; a < 3; ++a) {
        const auto& [x, y, z] = transform.axis[static_cast<std::size_t>(a)];
        const auto axis = static_cast<std::size_t>(a);
        header.spacing[axis] = length(Vec3{x, y, z});
        header.axis[axis] = (1 / header.spacing[axis]) * Vec3{x, y, z};
    }
    const auto& [x, y, z] = transform.origin;
    header.origin = {x, y, z};
}

void checkSize(const Triple& size) {
    constexpr std::int64_t kMostOnAxis = (std::int64_t(1) << 31) - 1024;
    for (const std::int64_t n : size)
        if (n < 1 || n > kMostOnAxis)
            throw InputError(kViewName, fmt::format("its size is {}; expected 1 to {} voxels along each axis",
                                                    sizeText(size), kMostOnAxis));
}

}  // namespace

SourcePtr openView(const VoxelView& view) {
    checkSize(view.size);
    Header header;
    header.format = kViewName;
    header.size = view.size;
    header.type = typeOf(view);
    putGeometry(view.indexToWorld, header);
    settleGeometry(kViewName, header, {});
    return std::make_unique<ViewSource>(view, std::move(header));
}

bool liesAsRead(const VoxelView& view) {
    const auto bytes = static_cast<std::int64_t>(sizeOf(typeOf(view)));
    const bool aligned =
        reinterpret_cast<std::uintptr_t>(view.data) % static_cast<std::uintptr_t>(bytes) == 0;
    return aligned && !isSwapped(view) && view.stride[0] == bytes && view.stride[1] == bytes * view.size[0] &&
           view.stride[2] == bytes * view.size[0] * view.size[1];
}

}  // namespace isowave::imageio
