#include "tools/option_values.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

namespace isowave::tools {
namespace {

bool isUnit(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalpha(c) || c >= 0x80 || c == '%' || c == '^' || c == '\'' || c == '"';
    });
}

// The number that a unit stands behind, "3" of "3furlong" and "3 furlong"; else empty.
std::string numberBeforeUnit(const std::string& text) {
    double value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc() || !std::isfinite(value)) return {};
    const char* const unit = std::find_if(end, last, [](char c) { return c != ' '; });
    return isUnit({unit, last}) ? std::string(text.data(), end) : std::string();
}

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

Point corner(const std::string& text) {
    std::vector<double> numbers = list(text, number);
    if (numbers.size() != 3) throw UsageError("'" + text + "' is not a corner X,Y,Z of a box");
    return {numbers[0], numbers[1], numbers[2]};
}

// "1,2,3", "1,2" or "1,2,x", which was meant to be a corner; no file's name.
bool looksLikeCorner(const std::string& text) {
    return text.find(',') != std::string::npos &&
           text.find_first_not_of(" 0123456789.,+-eEnaif") == std::string::npos;
}

constexpr std::string_view kBall = "ball:", kBox = "box:";

int stepNumber(const std::string& text) { return static_cast<int>(integer(text, 0, kMostSteps)); }
int levelNumber(const std::string& text) {
    return static_cast<int>(integer(text, 0, kMostSteps / kStepsPerLevel));
}

}  // namespace

double number(const std::string& text) {
    if (const std::string alone = numberBeforeUnit(text); !alone.empty())
        throw UsageError("'" + text + "' is not a number; a unit is not taken here, write " + alone);
    const double value = parseWhole<double>(text, "a number");
    if (!std::isfinite(value)) throw UsageError("'" + text + "' is not a finite number");
    return value;
}

double positive(const std::string& text) {
    const double value = number(text);
    if (value <= 0) throw UsageError("'" + text + "' is not above 0");
    return value;
}

double lengthIn(const std::string& text, std::string_view unit) {
    if (const std::string alone = numberBeforeUnit(text); !alone.empty())
        throw UsageError("'" + text + "' is not a number; this length is in " + std::string(unit) +
                         " and is written without a unit: " + alone);
    return positive(text);
}

namespace {

constexpr const char* kUnits =
    "; the units are voxel (of level 0) and mm (the unit of the coordinates, whatever it is)";

// What stands before the unit, which is taken off; nothing for an unknown one.
std::optional<Length::Unit> takeUnit(std::string& text) {
    for (const auto& [name, unit] : {std::pair{"voxels", Length::Unit::voxels},
                                     {"voxel", Length::Unit::voxels},
                                     {"mm", Length::Unit::world}})
        if (text.ends_with(name)) {
            text.resize(text.size() - std::strlen(name));
            return unit;
        }
    return std::nullopt;
}

}  // namespace

Length length(const std::string& text) {
    std::string before = text;
    const std::optional<Length::Unit> unit = takeUnit(before);
    if (unit && !before.empty()) return {positive(before), *unit};
    const std::string alone = numberBeforeUnit(text);
    throw UsageError("'" + text + "' is no length with a unit" +
                     (alone.empty() ? "; write for example 0.1voxel or 0.05mm"
                                    : std::string(kUnits) + ", write " + alone + "voxel or " + alone + "mm"));
}

Length lengthOrNumber(const std::string& text) {
    std::string before = text;
    if (const std::optional<Length::Unit> unit = takeUnit(before); unit && !before.empty())
        return {positive(before), *unit};
    if (const std::string alone = numberBeforeUnit(text); !alone.empty())
        throw UsageError("'" + text + "' is no length" + kUnits + ", write " + alone + "voxel or " + alone +
                         "mm, or " + alone + " which is the same as " + alone + "mm");
    return {positive(text), Length::Unit::world};
}

std::int64_t integer(const std::string& text, std::int64_t low, std::int64_t high) {
    const auto value = parseWhole<std::int64_t>(text, "a whole number");
    if (value < low || value > high)
        throw UsageError("'" + text + "' is not " +
                         (high >= kHuge ? std::to_string(low) + " or more"
                                        : "between " + std::to_string(low) + " and " + std::to_string(high)));
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

FineRegion region(const std::string& text) {
    FineRegion result;
    const auto first = text.find(':');
    if (looksLikeCorner(text.substr(0, first))) {
        if (first == std::string::npos)
            throw UsageError("'" + text +
                             "' is one corner; a box is X,Y,Z:X,Y,Z, with :LEVEL behind it or not");
        const auto second = text.find(':', first + 1);
        result.where = FineRegion::Box{corner(text.substr(0, first)),
                                       corner(text.substr(first + 1, second - first - 1))};
        if (second != std::string::npos) result.level = levelNumber(text.substr(second + 1));
        return result;
    }
    const auto last = text.rfind(':');
    const bool hasLevel = last != std::string::npos && last + 1 < text.size() &&
                          text.find_first_not_of("0123456789", last + 1) == std::string::npos;
    if (hasLevel) result.level = levelNumber(text.substr(last + 1));
    result.where = place(text.substr(0, hasLevel ? last : std::string::npos));
    return result;
}

Point point(const std::string& text) {
    const std::vector<double> numbers = list(text, number);
    if (numbers.size() != 3) throw UsageError("'" + text + "' is not three numbers X,Y,Z");
    return {numbers[0], numbers[1], numbers[2]};
}

RegionBox box(const std::string& text) {
    if (text.starts_with(kBox)) {
        const std::string corners = text.substr(kBox.size());
        const UsageError noBox("'" + text + "' is not a box, box:X,Y,Z,X,Y,Z or X,Y,Z:X,Y,Z");
        if (corners.find(':') != std::string::npos) throw noBox;
        const std::vector<double> n = list(corners, number);
        if (n.size() != 6) throw noBox;
        return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    }
    const auto colon = text.find(':');
    if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos)
        throw UsageError("'" + text + "' is not a box, two opposite corners X,Y,Z:X,Y,Z");
    return {corner(text.substr(0, colon)), corner(text.substr(colon + 1))};
}

EditTool editTool(const std::string& text) {
    if (text.starts_with(kBall)) {
        const std::vector<double> n = list(text.substr(kBall.size()), number);
        if (n.size() != 4) throw UsageError("'" + text + "' is not a ball, ball:X,Y,Z,R");
        if (n[3] <= 0) throw UsageError("'" + text + "': the radius is not above 0");
        return Ball{{n[0], n[1], n[2]}, n[3]};
    }
    if (text.starts_with(kBox) || looksLikeCorner(text.substr(0, text.find(':')))) return box(text);
    return place(text);
}

std::array<double, 3> triple(const std::string& text, const char* example) {
    return tripleOf<double>(text, example, positive);
}

std::array<std::int64_t, 3> wholeTriple(const std::string& text, const char* example) {
    return tripleOf<std::int64_t>(text, example, [](const std::string& t) { return integer(t, 1, kHuge); });
}

}  // namespace isowave::tools
