#include "base/text.h"

#include <charconv>
#include <cmath>

namespace isowave {

std::string toLower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

std::optional<double> takeNumber(std::string_view text, std::size_t& at) {
    const char* begin = text.data() + at;
    const char* const end = text.data() + text.size();
    if (begin != end && *begin == '+' && begin + 1 != end && begin[1] != '-') ++begin;
    double value = 0;
    const auto [behind, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        // Its mantissa alone is in range, unless it is hundreds of digits: the exponent's sign tells which end it left.
        const std::string_view number(begin, static_cast<std::size_t>(behind - begin));
        const std::size_t exponent = number.find_first_of("eE");
        const bool small = exponent != number.npos ? number.find('-', exponent) != number.npos
                                                   : number.find_first_not_of("-0.") > number.find('.');
        value = std::copysign(small ? 0.0 : HUGE_VAL, *begin == '-' ? -1.0 : 1.0);
    }
    at = static_cast<std::size_t>(behind - text.data());
    return value;
}

std::string_view withoutByteOrderMark(std::string_view text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    return text;
}

}  // namespace isowave
