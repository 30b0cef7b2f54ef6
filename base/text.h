// Letters and numbers in text, where <string> has nothing.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace isowave {

// A to Z become a to z; other bytes stay.
std::string toLower(std::string text);

// The number that begins at text[at], which moves behind it; nothing, and `at` stays, where there is none. Decimal, as
// strtod() in the C locale reads it, whatever the program's locale is: a sign, digits, an exponent, inf, nan; what is
// too large becomes infinite, what is too small becomes 0.
std::optional<double> takeNumber(std::string_view text, std::size_t& at);

// Without the three bytes that editors on Windows put before UTF-8.
std::string_view withoutByteOrderMark(std::string_view text);

}  // namespace isowave
