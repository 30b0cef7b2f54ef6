// Exact numbers. Filters are derived in rationals and become doubles at the very end: the least-norm rows of
// a triangular lattice near a boundary have denominators of 5e17 and more, which no float would carry.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace isowave::subdivision {

// Expression templates are off, so that `auto x = a + b` is a number and not a reference to two dead ones.
using Integer = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;
using Rational =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

// "23/196", "-4", "0.0625" and "1.5/2" exactly; nothing is rounded. Throws InputError naming `text`.
Rational parseRational(std::string_view text);

// Numbers separated by spaces or commas: "1/8 1/2 3/4 1/2 1/8". Throws InputError with the place of a bad
// one.
std::vector<Rational> parseRationals(std::string_view text);

// "23/196"; "-4" when the denominator is 1.
std::string toString(const Rational& value);

// The double nearest to `value` (GMP's own conversion truncates, which would bias every filter towards zero).
double toDouble(const Rational& value);

}  // namespace isowave::subdivision
