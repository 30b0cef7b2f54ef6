// Points as text, one a line, as GMT and many others write them: "12.5 -3" or "12.5, -3, 7". '>' begins another line of
// points, and so does a blank line for those who say so; what follows a '#' is a comment.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/polyline.h"

namespace isowave {

struct PointRow {
    enum class Kind { point, separator, blank, comment };
    Kind kind = Kind::point;
    std::size_t number = 0;     // from 1
    std::string_view text;      // without its end
    int columns = 0;            // numbers in it, counted up to 4
    double values[4] = {};      // they
    std::string_view noNumber;  // from the first word among the first four that is none
};

// Row by row; nothing is refused here.
void eachPointRow(std::string_view text, const std::function<void(const PointRow&)>& take);

// Every number to its last bit; a closed line repeats its first point; '>' before each line where there are several.
std::string pointText(const std::vector<Polyline>& lines);

}  // namespace isowave
