#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>
#include <type_traits>

#include "io/image/source.h"

namespace isowave::imageio {

const char* nameOf(ValueType type) {
    static constexpr const char* kNames[] = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                             "uint32", "int64", "uint64", "float32", "float64"};
    return kNames[static_cast<int>(type)];
}

std::size_t sizeOf(ValueType type) {
    static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kSizes[static_cast<int>(type)];
}

std::optional<ValueType> valueTypeOf(std::string name) {
    static const std::map<std::string, ValueType> other = {
        {"char", ValueType::int8},          {"unsigned char", ValueType::uint8},
        {"signed char", ValueType::int8},   {"uchar", ValueType::uint8},
        {"short", ValueType::int16},        {"unsigned short", ValueType::uint16},
        {"signed short", ValueType::int16}, {"ushort", ValueType::uint16},
        {"int", ValueType::int32},          {"unsigned int", ValueType::uint32},
        {"signed int", ValueType::int32},   {"uint", ValueType::uint32},
        {"float", ValueType::float32},      {"double", ValueType::float64}};
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (int i = 0; i <= static_cast<int>(ValueType::float64); ++i)
        if (name == nameOf(static_cast<ValueType>(i))) return static_cast<ValueType>(i);
    const auto found = other.find(name);
    return found == other.end() ? std::nullopt : std::optional(found->second);
}

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

}  // namespace isowave::imageio
