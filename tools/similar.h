// "did you mean": the word that a mistyped one was to be.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace isowave::tools {

// How many letters have to be put in, left out, changed or swapped with their neighbour to make b of a (optimal string
// alignment: no place is edited twice).
std::size_t editDistance(std::string_view a, std::string_view b);

// The candidate that takes the fewest edits, at most a third of the word's letters and at least one, or the one candidate that
// begins with it; the first of several. Empty where none does.
std::string_view similarTo(std::string_view word, const std::vector<std::string_view>& candidates);

// "; did you mean lod? See isowave --help", or only "; see isowave --help". help: "isowave --help".
std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates,
                       const std::string& help);

}  // namespace isowave::tools
