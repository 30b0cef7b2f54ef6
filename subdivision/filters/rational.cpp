#include "subdivision/filters/rational.h"

#include <cctype>
#include <cmath>
#include <limits>

#include "isowave/error.h"

namespace isowave::subdivision {

namespace {

// [+-]digits[.digits], exactly. Consumes what it reads.
Rational parseDecimal(std::string_view& rest, std::string_view whole) {
    const auto fail = [&](const char* why) -> InputError {
        return {"'" + std::string(whole) + "'", std::string(why) + "; write numbers as 3/4, -2 or 0.125"};
    };
    bool negative = false;
    if (!rest.empty() && (rest[0] == '-' || rest[0] == '+')) {
        negative = rest[0] == '-';
        rest.remove_prefix(1);
    }
    Integer digits = 0, scale = 1;
    int count = 0;
    bool point = false;
    while (!rest.empty() &&
           (std::isdigit(static_cast<unsigned char>(rest[0])) || (rest[0] == '.' && !point))) {
        if (rest[0] == '.') {
            point = true;
        } else {
            digits = digits * 10 + (rest[0] - '0');
            if (point) scale *= 10;
            ++count;
        }
        rest.remove_prefix(1);
    }
    if (count == 0) throw fail("is not a number");
    if (count > 1000) throw fail("has more than 1000 digits");
    return Rational(negative ? Integer(-digits) : digits, scale);
}

}  // namespace

Rational parseRational(std::string_view text) {
    std::string_view rest = text;
    Rational value = parseDecimal(rest, text);
    if (!rest.empty() && rest[0] == '/') {
        rest.remove_prefix(1);
        const Rational below = parseDecimal(rest, text);
        if (below == 0) throw InputError("'" + std::string(text) + "'", "divides by zero");
        value /= below;
    }
    if (!rest.empty()) {
        throw InputError("'" + std::string(text) + "'",
                         "is not a number; write numbers as 3/4, -2 or 0.125, with spaces or commas between");
    }
    return value;
}

std::vector<Rational> parseRationals(std::string_view text) {
    std::vector<Rational> values;
    std::size_t at = 0;
    const auto isSeparator = [](char c) { return c == ',' || std::isspace(static_cast<unsigned char>(c)); };
    while (at < text.size()) {
        if (isSeparator(text[at])) {
            ++at;
            continue;
        }
        std::size_t end = at;
        while (end < text.size() && !isSeparator(text[end])) ++end;
        try {
            values.push_back(parseRational(text.substr(at, end - at)));
        } catch (const InputError& error) {
            throw InputError("number " + std::to_string(values.size() + 1), error.what());
        }
        at = end;
    }
    return values;
}

std::string toString(const Rational& value) { return value.str(); }

double toDouble(const Rational& value) {
    const double towardsZero = value.convert_to<double>();
    const double away = std::nextafter(towardsZero, value < 0 ? -std::numeric_limits<double>::infinity()
                                                              : std::numeric_limits<double>::infinity());
    if (!std::isfinite(away)) return towardsZero;
    const Rational below = abs(Rational(value - Rational(towardsZero)));
    const Rational above = abs(Rational(Rational(away) - value));
    return above < below ? away : towardsZero;
}

}  // namespace isowave::subdivision
