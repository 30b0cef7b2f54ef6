#include "io/image/reversed_axes.h"

#include <algorithm>
#include <cstring>

namespace isowave::imageio {
namespace {

// A line of the cache holds this many voxels or more, whatever their type.
constexpr std::int64_t kBlock = 16;
// Of the other source's slices, at a time.
constexpr std::int64_t kMostBytes = std::int64_t(16) << 20;

class ReversedSource : public VoxelSource {
  public:
    explicit ReversedSource(SourcePtr stored) : stored_(std::move(stored)) {
        header = stored_->header;
        std::reverse(header.size.begin(), header.size.end());
        std::reverse(header.spacing.begin(), header.spacing.end());
        std::reverse(header.axis.begin(), header.axis.end());
        slicesPerRead = header.size[2];
        native = true;
    }

    // All of it: z0 is 0 and z1 the last one.
    void readNative(std::int64_t, std::int64_t, void* out) override {
        withType(header.type, [&]<class T>(T) { readAs(static_cast<T*>(out)); });
    }

  private:
    template <class T>
    void readAs(T* out) {
        const std::int64_t nx = header.size[0], ny = header.size[1], nz = header.size[2];
        const std::int64_t slice = ny * nz,
                           most = kMostBytes / (slice * static_cast<std::int64_t>(sizeof(T)));
        const std::int64_t step = std::clamp<std::int64_t>(most, 1, std::min(kBlock, stored_->slicesPerRead));
        std::vector<T> some(static_cast<std::size_t>(std::min(step, nx) * slice));
        for (std::int64_t x = 0, end; x < nx; x = end) {
            end = std::min(x + step, nx);
            stored_->readNative(x, end, some.data());
            for (std::int64_t y = 0; y < ny; ++y)
                for (std::int64_t z = 0; z < nz; ++z)
                    for (std::int64_t i = x; i < end; ++i)
                        out[i + nx * (y + ny * z)] =
                            some[static_cast<std::size_t>((i - x) * slice + y * nz + z)];
        }
    }

    SourcePtr stored_;
};

}  // namespace

SourcePtr withAxesReversed(SourcePtr source) { return std::make_unique<ReversedSource>(std::move(source)); }

}  // namespace isowave::imageio
