#include "tools/option_values.h"

#include <charconv>
#include <cmath>

namespace isowave::tools {
namespace {

template <class Number>
Number parseWhole(const std::string& text, const char* expected) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty())
        throw UsageError("'" + text + "' is not " + expected);
    return value;
}

template <class Number, class Parse>
std::array<Number, 3> tripleOf(const std::string& text, const char* example, Parse parse) {
    std::array<Number, 3> result{};
    std::size_t begin = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t end = text.find_first_of("x,", begin);
        if ((end == std::string::npos) != (axis == 2))
            throw UsageError("'" + text + "' is not three numbers such as " + example);
        result[axis] = parse(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return result;
}

int stepNumber(const std::string& text) { return static_cast<int>(integer(text, 0, kMostSteps)); }

}  // namespace

double number(const std::string& text) {
    const double value = parseWhole<double>(text, "a number");
    if (!std::isfinite(value)) throw UsageError("'" + text + "' is not a finite number");
    return value;
}

double positive(const std::string& text) {
    const double value = number(text);
    if (value <= 0) throw UsageError("'" + text + "' is not above 0");
    return value;
}

std::int64_t integer(const std::string& text, std::int64_t low, std::int64_t high) {
    const auto value = parseWhole<std::int64_t>(text, "a whole number");
    if (value < low || value > high)
        throw UsageError("'" + text + "' is not between " + std::to_string(low) + " and " +
                         std::to_string(high));
    return value;
}

std::filesystem::path place(const std::string& text) {
    if (text.empty()) throw UsageError("the name is empty");
    if (text.front() == '-')
        throw UsageError("'" + text + "' is no name of a file here; put ./ in front if it is one");
    return text;
}

StepRange range(const std::string& text) {
    const auto dots = text.find("..");
    StepRange result;
    if (dots == std::string::npos) {
        result.first = stepNumber(text);
        result.last = result.first;
        return result;
    }
    const std::string first = text.substr(0, dots), last = text.substr(dots + 2);
    if (first.empty() && last.empty()) throw UsageError("'..' names no number; write for example 0..3");
    if (!first.empty()) result.first = stepNumber(first);
    if (!last.empty()) result.last = stepNumber(last);
    if (result.last && *result.last < result.first)
        throw UsageError("'" + text + "' runs backwards; write the smaller number first");
    return result;
}

std::array<double, 3> triple(const std::string& text, const char* example) {
    return tripleOf<double>(text, example, positive);
}

std::array<std::int64_t, 3> wholeTriple(const std::string& text, const char* example) {
    return tripleOf<std::int64_t>(text, example, [](const std::string& t) { return integer(t, 1, kHuge); });
}

}  // namespace isowave::tools
