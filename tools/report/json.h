// JSON as all reports write it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace isowave::tools {

// Keys keep the order in which they were put in.
using Json = nlohmann::ordered_json;

// null when not finite: JSON knows no infinity.
Json finite(double value);

// Indented by so many spaces, one trailing newline; file names that are not UTF-8 get replacement characters.
std::string dumped(const Json& json, int indent = 2);

// A report, as dumped() gives an object with members, with one member more at its end: `remarks`, unless it has that.
std::string withRemarks(const std::string& report, const std::vector<std::string>& remarks);

}  // namespace isowave::tools
