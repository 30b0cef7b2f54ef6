#include "io/image/source.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/text.h"

namespace isowave::imageio {

std::int64_t VoxelSource::read(std::int64_t z0, std::int64_t z1, float* out) {
    if (header.type == ValueType::float32) return readNative(z0, z1, out), 0;
    const std::int64_t count = (z1 - z0) * header.sliceVoxels();
    // zeros, should a library leave some unread
    std::vector<char> stored(static_cast<std::size_t>(count) * sizeOf(header.type));
    readNative(z0, z1, stored.data());
    return convert(header.type, stored.data(), count, false, out);
}

void VoxelSource::readNative(std::int64_t, std::int64_t, void*) { assert(native); }

namespace {

template <class T>
T loadSwapped(const char* bytes) {
    char reversed[sizeof(T)];
    std::reverse_copy(bytes, bytes + sizeof(T), reversed);
    T value;
    std::memcpy(&value, reversed, sizeof(T));
    return value;
}

// float32 holds every integer up to 2^24, so narrower types need no check. Beyond, v is held exactly when its
// value survives the way there; long double has 64 bits of mantissa, enough for both sides of the comparison.
template <class T>
bool exactAsFloat(T value, float f) {
    if constexpr (std::is_integral_v<T> && sizeof(T) >= 4)
        return static_cast<long double>(f) == static_cast<long double>(value);
    return true;
}
static_assert(std::numeric_limits<long double>::digits >= 64, "exactAsFloat compares 64-bit integers");

template <class T>
std::int64_t convertAs(const char* in, std::int64_t count, bool swap, float* out) {
    std::int64_t inexact = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        T value;
        if (swap)
            value = loadSwapped<T>(in + i * static_cast<std::int64_t>(sizeof(T)));
        else
            std::memcpy(&value, in + i * static_cast<std::int64_t>(sizeof(T)), sizeof(T));
        out[i] = static_cast<float>(value);
        inexact += !exactAsFloat(value, out[i]);
    }
    return inexact;
}

}  // namespace

std::int64_t convert(ValueType type, const void* in, std::int64_t count, bool swap, float* out) {
    const auto* bytes = static_cast<const char*>(in);
    switch (type) {
        case ValueType::int8:
            return convertAs<std::int8_t>(bytes, count, swap, out);
        case ValueType::uint8:
            return convertAs<std::uint8_t>(bytes, count, swap, out);
        case ValueType::int16:
            return convertAs<std::int16_t>(bytes, count, swap, out);
        case ValueType::uint16:
            return convertAs<std::uint16_t>(bytes, count, swap, out);
        case ValueType::int32:
            return convertAs<std::int32_t>(bytes, count, swap, out);
        case ValueType::uint32:
            return convertAs<std::uint32_t>(bytes, count, swap, out);
        case ValueType::int64:
            return convertAs<std::int64_t>(bytes, count, swap, out);
        case ValueType::uint64:
            return convertAs<std::uint64_t>(bytes, count, swap, out);
        case ValueType::float32:
            return convertAs<float>(bytes, count, swap, out);
        case ValueType::float64:
            return convertAs<double>(bytes, count, swap, out);
    }
    return 0;
}

Image imageOf(const Header& header) {
    Image image;
    image.size = header.size;
    for (int a = 0; a < 3; ++a) {
        const Vec3 step = header.axis[a] * header.spacing[a] + Vec3{};  // -0 + 0 = 0
        image.indexToWorld.axis[a] = {step.x, step.y, step.z};
    }
    image.indexToWorld.origin = {header.origin.x, header.origin.y, header.origin.z};
    const ValueType stored = header.storedType.value_or(header.type);
    image.componentType = nameOf(stored);
    image.integral = header.integral.value_or(isIntegral(stored));
    image.slope = header.slope;
    image.intercept = header.intercept;
    image.format = header.format;
    image.space = header.space;
    image.unit = header.unit;
    image.warnings = header.warnings;
    return image;
}

}  // namespace isowave::imageio
