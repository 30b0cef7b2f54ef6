// The numbers that files of samples hold: voxels, pixels, elements of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace isowave {

enum class ValueType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

const char* nameOf(ValueType type);  // "int16"
std::size_t sizeOf(ValueType type);  // bytes
inline bool isIntegral(ValueType type) { return type < ValueType::float32; }
// By the name that nameOf() gives; also char, short, int, float, double with and without "unsigned".
std::optional<ValueType> valueTypeOf(std::string name);

// Calls f with a value of the C++ type, for code that is written once for all types.
template <class F>
decltype(auto) withType(ValueType type, F&& f) {
    switch (type) {
        case ValueType::int8:
            return f(std::int8_t());
        case ValueType::uint8:
            return f(std::uint8_t());
        case ValueType::int16:
            return f(std::int16_t());
        case ValueType::uint16:
            return f(std::uint16_t());
        case ValueType::int32:
            return f(std::int32_t());
        case ValueType::uint32:
            return f(std::uint32_t());
        case ValueType::int64:
            return f(std::int64_t());
        case ValueType::uint64:
            return f(std::uint64_t());
        case ValueType::float32:
            return f(float());
        case ValueType::float64:
            break;
    }
    return f(double());
}

}  // namespace isowave
