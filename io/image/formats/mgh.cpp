#include "io/image/formats/mgh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>

#include "io/image/check.h"
#include "io/image/header.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHeaderBytes = 284, kFieldBytes = 90;

// Big-endian throughout.
class MghBytes {
  public:
    explicit MghBytes(const fs::path& path) {
        const std::string held = firstBytes(path, kFieldBytes);
        if (held.size() < kFieldBytes)
            throw InputError(path.string(), "is shorter than an MGH header; it is truncated or no MGH image");
        std::copy(held.begin(), held.end(), bytes_.begin());
    }
    template <class T>
    T at(std::size_t offset) const {
        std::array<char, sizeof(T)> value;
        std::copy_n(bytes_.data() + offset, sizeof(T), value.data());
        if (std::endian::native == std::endian::little) std::reverse(value.begin(), value.end());
        return std::bit_cast<T>(value);
    }
    Vec3 vectorAt(std::size_t offset) const {
        return {double{at<float>(offset)}, double{at<float>(offset + 4)}, double{at<float>(offset + 8)}};
    }

  private:
    std::array<char, kFieldBytes> bytes_{};
};

// At 28: goodRASFlag; 30: voxel sizes; 42: the directions of the three axes, RAS; 78: the world position of the middle,
// which is voxel size/2.
void placeMgh(const MghBytes& bytes, Header& header) {
    Vec3 size{1, 1, 1}, middle;
    std::array<Vec3, 3> axis{Vec3{-1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 1, 0}};
    if (bytes.at<std::int16_t>(28) > 0) {
        size = bytes.vectorAt(30);
        axis = {bytes.vectorAt(42), bytes.vectorAt(54), bytes.vectorAt(66)};
        middle = bytes.vectorAt(78);
    } else {
        header.warnings.push_back(
            "says nothing of its orientation (goodRASFlag is 0); coronal slices of 1 mm are assumed, as "
            "FreeSurfer does");
    }
    const auto lps = [](const Vec3& v) { return Vec3{-v.x, -v.y, v.z}; };
    Vec3 origin = middle;
    std::array<Vec3, 3> step;
    for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 along = axis[a] * size[static_cast<int>(a)];
        origin -= along * (static_cast<double>(header.size[a]) / 2);
        step[a] = lps(along);
    }
    place(header, step, lps(origin));
}

}  // namespace

StoredVolume readMghHeader(const fs::path& path) {
    const std::string name = path.string();
    const MghBytes bytes(path);
    if (bytes.at<std::int32_t>(0) != 1)
        throw InputError(name, fmt::format("is not an MGH image: its header begins with {}; expected 1",
                                           bytes.at<std::int32_t>(0)));
    static const std::map<std::int32_t, ValueType> types = {{0, ValueType::uint8},
                                                            {1, ValueType::int32},
                                                            {3, ValueType::float32},
                                                            {4, ValueType::int16},
                                                            {10, ValueType::uint16}};
    const auto type = types.find(bytes.at<std::int32_t>(20));
    if (type == types.end())
        throw InputError(name,
                         fmt::format("its header says data type {}; expected an integer or floating-point "
                                     "type",
                                     bytes.at<std::int32_t>(20)));
    StoredVolume volume;
    Header& header = volume.header;
    header.format = "MGH";
    header.type = type->second;
    std::vector<std::int64_t> size;
    for (std::size_t a = 0; a < 4; ++a) size.push_back(bytes.at<std::int32_t>(4 + 4 * a));
    byteCount(name, size, 4);
    header.size = {size[0], size[1], size[2]};
    placeMgh(bytes, header);
    volume.voxels.outer = size[3];
    volume.voxels.bigEndian = true;
    putBehindHeader(volume.voxels, path, kHeaderBytes);
    volume.promise = fmt::format("its header says {}", sizesText(size));
    return volume;
}

}  // namespace isowave::imageio
