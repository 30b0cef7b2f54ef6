#include "tools/subdivision/filter_options.h"

#include "tools/option_values.h"

namespace isowave::tools {

void declareMask(OptionList& options, std::optional<std::string>& mask) {
    options.value("--mask", "TAPS", "",
                  "a subdivision of your own: \"1/8 1/2 3/4 1/2 1/8\"; in spiral order on a lattice",
                  [&](const std::string& v) { mask = v; });
}

void declareWidth(OptionList& options, std::optional<int>& width) {
    options.value("--width", "W", "the usual one, or the smallest there is",
                  "of A: taps on the line, rings on a lattice",
                  [&](const std::string& v) { width = static_cast<int>(integer(v, 0, 1000)); });
}

}  // namespace isowave::tools
