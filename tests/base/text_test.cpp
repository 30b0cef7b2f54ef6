// The promises of base/text.h and base/value_type.h.
#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/value_type.h"

namespace isowave {
namespace {

double numberOf(const std::string& text) {
    std::size_t at = 0;
    return takeNumber(text, at).value_or(-1);
}

TEST(Text, LowerCaseIsAsciiAlone) { EXPECT_EQ(toLower("ABZ-\xc4 \x5b@.png"), "abz-\xc4 \x5b@.png"); }

TEST(Text, ANumberIsWhatStrtodReads) {
    std::mt19937_64 random(1);
    for (int n = 0; n < 10000; ++n) {
        const double mantissa = std::ldexp(static_cast<double>(random()), -60);
        const std::string text = std::to_string(mantissa) + (n % 2 ? "e" : "E-") + std::to_string(n % 340);
        EXPECT_EQ(numberOf(text), std::strtod(text.c_str(), nullptr)) << text;
    }
    EXPECT_EQ(numberOf("+7"), 7);
    EXPECT_EQ(numberOf("1e999"), HUGE_VAL);
    EXPECT_EQ(numberOf("-1e999"), -HUGE_VAL);
    EXPECT_EQ(numberOf("1e-999"), 0);
    EXPECT_EQ(numberOf(std::string(400, '9')), HUGE_VAL);
    EXPECT_EQ(numberOf("0." + std::string(400, '0') + "1"), 0);
}

TEST(Text, ANumberEndsWhereItEnds) {
    std::size_t at = 1;
    EXPECT_EQ(takeNumber("x2.5,3", at), 2.5);
    EXPECT_EQ(at, 4u);
    EXPECT_FALSE(takeNumber("x2.5,3", at));
    EXPECT_EQ(at, 4u);
    at = 0;
    for (const char* none : {"", "+", "-", "+-1", "e5", ".", ",1"})
        EXPECT_FALSE(takeNumber(none, at)) << none;
}

TEST(ValueType, IsFoundByItsNames) {
    EXPECT_EQ(valueTypeOf("Int16"), ValueType::int16);
    EXPECT_EQ(valueTypeOf("unsigned char"), ValueType::uint8);
    EXPECT_FALSE(valueTypeOf("int24"));
    for (int i = 0; i <= static_cast<int>(ValueType::float64); ++i) {
        const auto type = static_cast<ValueType>(i);
        EXPECT_EQ(valueTypeOf(nameOf(type)), type);
        EXPECT_EQ(withType(type, []<class T>(T) { return sizeof(T); }), sizeOf(type));
        EXPECT_EQ(withType(type, []<class T>(T) { return std::is_integral_v<T>; }), isIntegral(type));
    }
}

}  // namespace
}  // namespace isowave
