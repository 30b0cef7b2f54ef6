// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace isowave {

// 1234567 -> "1,234,567"
std::string grouped(std::int64_t value);
// "1 triangle", "1,234 triangles"; many: the plural where it is not one + "s" ("vertices").
std::string counted(std::int64_t value, std::string_view one, std::string_view many = {});
// Four significant digits; thousands grouped; "-" where it is not finite.
std::string shortNumber(double value);
// "1.2 GB"
std::string bytesText(double bytes);

}  // namespace isowave
