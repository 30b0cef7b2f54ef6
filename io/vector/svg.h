// Lines in SVG drawings: every <path> of straight pieces (M L H V Z and lower case), <polyline> and <polygon>. Points
// are the file's own numbers; transformations of the drawing are left to the drawing.
#pragma once

#include <string>
#include <vector>

#include "base/polyline.h"

namespace isowave {

class SvgLines {
  public:
    // `name` stands in messages. Throws InputError naming the element: a curved piece, a coordinate that is no number,
    // a tag without an end.
    SvgLines(std::string text, const std::string& name);

    const std::vector<Polyline>& lines() const { return lines_; }
    // The drawing with other points in its lines. REQUIRES: as many as lines().
    std::string with(const std::vector<Polyline>& lines) const;

  private:
    // The value of an attribute: text_[begin, end) holds the lines [first, last).
    struct Value {
        std::size_t begin, end, first, last;
        bool isPath;
    };
    // The tag that begins at `at`. Returns from where to look for the next one: what is written in a tag is no other one.
    std::size_t readTag(std::size_t at, const std::string& name);

    std::string text_;
    std::vector<Polyline> lines_;
    std::vector<Value> values_;
    int tags_ = 0;
};

}  // namespace isowave
