// How much of a whole run is done, from what its stages report; what is left, and the line that shows it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace isowave::tools {

// Stages know only their own share (progress.h). Those of a solid's way from file to levels come in a fixed order and take
// about the same shares of the time, which a table has; the sum never falls.
class Overall {
  public:
    // From now on the job is number `index` (from 0 on) of `count` equal ones.
    void startPart(std::size_t index, std::size_t count);
    // done: 0..1 of the stage. Returns 0..1 of the whole; nothing before the first stage that the table has, where the stage's
    // own share is all that is known.
    std::optional<double> at(std::string_view stage, double done);

  private:
    std::size_t index_ = 0, count_ = 1;
    std::optional<double> ofPart_;
};

// What a line of progress shows. share: 0..1, of the whole run or else of the stage; seconds: since the run began.
struct ProgressFacts {
    std::string_view stage;
    double share = 0;
    bool ofWhole = false;
    double seconds = 0;
};

// "[#######-------------]  34 %  measuring distances  2.1 %/s  0:31 left", at most `width` columns; time is told once 2 s and
// 2 % of the whole are behind.
std::string barText(const ProgressFacts& facts, std::size_t width);
// "34 %, measuring distances, 0:31 left"
std::string plainText(const ProgressFacts& facts);

}  // namespace isowave::tools
