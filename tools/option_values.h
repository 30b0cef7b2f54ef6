// Texts of the command line -> values. Each function throws UsageError in words ("'x' is not a number") without naming
// the option; the parser (cli.h) puts its name in front.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isowave/error.h"
#include "isowave/ladder.h"
#include "isowave/pyramid.h"

namespace isowave::tools {

double number(const std::string& text);    // finite; what has a unit is told to be written alone
double positive(const std::string& text);  // above 0
// A length without a unit, above 0. unit: what it is in, for complaints.
double lengthIn(const std::string& text, std::string_view unit);
inline constexpr std::string_view kWorldUnits = "the units of the coordinates (mm for images)";
inline constexpr std::string_view kInputUnits = "the units of the input";
inline constexpr std::string_view kVoxels = "voxels";
inline constexpr std::string_view kPixels = "pixels of level 0";
// 0.1voxel, 0.05mm (mm: world units), above 0.
Length length(const std::string& text);
// The same; a number alone is in world units.
Length lengthOrNumber(const std::string& text);
// low <= value <= high
std::int64_t integer(const std::string& text, std::int64_t low, std::int64_t high);
// A file's or folder's name: not empty, and nothing that looks like an option ("--quiet" where a name was left out).
std::filesystem::path place(const std::string& text);
// A..B, A.., ..B or A: both ends included.
StepRange range(const std::string& text);
// BOX or MESH, then :LEVEL where it is not 0. BOX is X,Y,Z:X,Y,Z; all else is the name of a file, to which the last ":N" does not
// belong.
FineRegion region(const std::string& text);
// X,Y,Z, any finite numbers.
Point point(const std::string& text);
// X,Y,Z:X,Y,Z or box:X,Y,Z,X,Y,Z.
RegionBox box(const std::string& text);
// ball:X,Y,Z,R, a box, or else the name of a mesh's file.
EditTool editTool(const std::string& text);
// AxBxC; commas will do too.
std::array<double, 3> triple(const std::string& text, const char* example);
std::array<std::int64_t, 3> wholeTriple(const std::string& text, const char* example);

// Coordinates have 32 bits, so there are not more halvings; a larger number is a slip of the keyboard.
inline constexpr int kMostSteps = 10'000;
inline constexpr double kBytesPerGigabyte = 1e9;
inline constexpr std::int64_t kHuge = std::int64_t{1} << 40;

// A,B,C
template <class Parse>
auto list(const std::string& text, Parse parse) {
    std::vector<decltype(parse(text))> result;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        result.push_back(parse(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return result;
}

template <class Value, std::size_t N>
Value choice(const std::string& text, const std::pair<std::string_view, Value> (&choices)[N]) {
    std::string names;
    for (const auto& [name, value] : choices) {
        if (text == name) return value;
        names += (names.empty() ? "" : ", ") + std::string(name);
    }
    throw UsageError("'" + text + "' is not one of " + names);
}

}  // namespace isowave::tools
