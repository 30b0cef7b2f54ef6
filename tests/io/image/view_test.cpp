// Voxels in memory of the caller's: every layout, type and byte order gives the same slabs.
#include "io/image/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <mutex>
#include <numeric>

#include "io/image/stream.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<std::int64_t, 3> kSize{37, 19, 21};  // no multiples of a block's 16

int valueAt(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<int>((x + 7 * y + 31 * z) % 100);
}

template <class T>
T reversed(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    std::reverse(bytes.begin(), bytes.end());
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
}

// An array in memory, `order` from the fastest axis on, `step` values apart along the fastest, shifted by `shift` bytes.
template <class T>
struct Laid {
    std::vector<char> bytes;
    VoxelView view;

    Laid(const char* type, std::array<int, 3> order, bool swap = false, std::int64_t step = 1,
         std::size_t shift = 0) {
        view.type = type;
        view.size = kSize;
        view.bigEndian = swap;  // this machine is little-endian
        std::int64_t stride = step * static_cast<std::int64_t>(sizeof(T));
        for (const int axis : order) {
            view.stride[static_cast<std::size_t>(axis)] = stride;
            stride *= kSize[static_cast<std::size_t>(axis)];
        }
        bytes.assign(static_cast<std::size_t>(stride) + shift, 0);
        for (std::int64_t z = 0; z < kSize[2]; ++z)
            for (std::int64_t y = 0; y < kSize[1]; ++y)
                for (std::int64_t x = 0; x < kSize[0]; ++x) {
                    const T value =
                        swap ? reversed(static_cast<T>(valueAt(x, y, z))) : static_cast<T>(valueAt(x, y, z));
                    std::memcpy(
                        bytes.data() + shift + x * view.stride[0] + y * view.stride[1] + z * view.stride[2],
                        &value, sizeof(T));
                }
        view.data = bytes.data() + shift;
    }
};

std::vector<int> allOf(ImageStream stream) {
    std::vector<int> values(static_cast<std::size_t>(kSize[0] * kSize[1] * kSize[2]));
    stream.pass("reading", {}, [&](const Slab& slab) {
        std::visit(
            [&](auto voxels) {
                for (std::size_t i = 0; i < voxels.size(); ++i)
                    values[static_cast<std::size_t>(slab.z0 * kSize[0] * kSize[1]) + i] =
                        voxels[i] == voxels[i] ? static_cast<int>(voxels[i])
                                               : -1;  // no number is none of them
            },
            slab.voxels);
    });
    return values;
}

std::vector<int> expected() {
    std::vector<int> values;
    for (std::int64_t z = 0; z < kSize[2]; ++z)
        for (std::int64_t y = 0; y < kSize[1]; ++y)
            for (std::int64_t x = 0; x < kSize[0]; ++x) values.push_back(valueAt(x, y, z));
    return values;
}

template <class T>
void expectEveryLayout(const char* type) {
    std::array<int, 3> order{0, 1, 2};
    do
        for (const bool swap : {false, true})
            for (const std::int64_t step : {1, 3})
                for (const std::int64_t slices : {0, 1, 5}) {
                    const Laid<T> laid(type, order, swap, step);
                    EXPECT_EQ(allOf(ImageStream(laid.view, {}, slices)), expected())
                        << type << ' ' << order[0] << order[1] << order[2] << ' ' << swap << ' ' << step
                        << ' ' << slices;
                }
    while (std::next_permutation(order.begin(), order.end()));
}

TEST(VoxelView, GivesTheSameSlabsHoweverTheVoxelsLie) {
    expectEveryLayout<std::int8_t>("int8");
    expectEveryLayout<std::uint16_t>("uint16");
    expectEveryLayout<std::int64_t>("int64");
    expectEveryLayout<float>("float32");
    expectEveryLayout<double>("float64");
}

TEST(VoxelView, GoesBackwardsAlongNegativeStrides) {
    Laid<std::int16_t> laid("int16", {2, 0, 1});
    VoxelView back = laid.view;
    auto first = static_cast<const char*>(back.data);
    for (std::size_t a = 0; a < 3; ++a) {
        first += (kSize[a] - 1) * back.stride[a];
        back.stride[a] = -back.stride[a];
    }
    back.data = first;
    std::vector<int> turned = allOf(ImageStream(back));
    std::reverse(turned.begin(), turned.end());
    EXPECT_EQ(turned, expected());
}

// The first voxel of what the first slab holds.
const void* firstVoxel(const VoxelView& view, const ImageReadOptions& options = {}) {
    const void* first = nullptr;
    std::mutex mutex;
    ImageStream(view, options, kSize[2]).pass("reading", {}, [&](const Slab& slab) {
        const std::lock_guard lock(mutex);
        std::visit([&](auto voxels) { first = voxels.data(); }, slab.voxels);
    });
    return first;
}

TEST(VoxelView, ThatLiesAsItIsReadIsNotCopied) {
    const Laid<float> plain("float32", {0, 1, 2});
    EXPECT_EQ(firstVoxel(plain.view), plain.view.data);
    const Laid<std::uint8_t> bytes("uint8", {0, 1, 2});
    EXPECT_EQ(firstVoxel(bytes.view), bytes.view.data);
    EXPECT_NE(firstVoxel(Laid<float>("float32", {2, 1, 0}).view), nullptr);
    const Laid<float> other("float32", {2, 1, 0}), big("float32", {0, 1, 2}, true),
        shifted("float32", {0, 1, 2}, false, 1, 1);
    for (const VoxelView& view : {other.view, big.view, shifted.view}) EXPECT_NE(firstVoxel(view), view.data);
    EXPECT_NE(firstVoxel(plain.view, {.nan = 0.0f}), plain.view.data);
}

TEST(VoxelView, RefusesWhatIsNotFiniteAndSaysWhere) {
    Laid<double> laid("float64", {2, 1, 0});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(laid.bytes.data() + 3 * laid.view.stride[0] + 2 * laid.view.stride[1] + laid.view.stride[2],
                &nan, 8);
    EXPECT_THAT([&] { allOf(ImageStream(laid.view)); },
                testing::ThrowsMessage<InputError>(HasSubstr("voxel (3, 2, 1) is nan")));
    EXPECT_EQ(allOf(ImageStream(laid.view,
                                {.nan = 55.0f}))[static_cast<std::size_t>((kSize[1] + 2) * kSize[0] + 3)],
              55);
}

TEST(VoxelView, SaysThatLargeIntegersWereRounded) {
    Laid<std::int64_t> laid("int64", {0, 1, 2});
    const std::int64_t large = (std::int64_t(1) << 24) + 1;
    std::memcpy(laid.bytes.data(), &large, 8);
    ImageStream stream(laid.view);
    stream.pass("reading", {}, [](const Slab&) {});
    EXPECT_THAT(stream.header().warnings, ElementsAre(HasSubstr("1 of 14763 int64 voxels")));
}

TEST(VoxelView, RefusesATypeASizeAndAPlaceThatCannotBe) {
    const auto refused = [](auto&& change, const char* words) {
        Laid<float> laid("float32", {0, 1, 2});
        change(laid.view);
        EXPECT_THAT([&] { ImageStream stream(laid.view); },
                    testing::ThrowsMessage<InputError>(HasSubstr(words)));
    };
    refused([](VoxelView& v) { v.type = "complex64"; }, "array: voxels of type 'complex64' are not read");
    refused([](VoxelView& v) { v.size[1] = 0; }, "array: its size is 37 x 0 x 21");
    refused([](VoxelView& v) { v.indexToWorld.axis[1] = {0, 0, 0}; }, "expected positive numbers");
    refused([](VoxelView& v) { v.indexToWorld.axis[1] = v.indexToWorld.axis[0]; }, "cannot be inverted");
    refused([](VoxelView& v) { v.indexToWorld.origin[2] = INFINITY; }, "is not finite");
}

}  // namespace
}  // namespace isowave
