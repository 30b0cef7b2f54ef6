#include "base/value_type.h"

#include <map>

#include "base/text.h"

namespace isowave {

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
    name = toLower(std::move(name));
    for (int i = 0; i <= static_cast<int>(ValueType::float64); ++i)
        if (name == nameOf(static_cast<ValueType>(i))) return static_cast<ValueType>(i);
    const auto found = other.find(name);
    return found == other.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace isowave
