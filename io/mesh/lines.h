// The words of a text file, and complaints that name their line: what the readers of OBJ, OFF, PLY and ASCII STL share.
//
// Lines end in \n, \r\n, or \r alone where the first one does. A byte order mark of UTF-8 is passed over. A word that begins
// with # starts a comment, which lasts to the end of its line.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/mesh/soup.h"

namespace isowave {

// What a number that is out of range stands for: 0 or infinity, with its sign.
double outOfRange(std::string_view word);

// The number that a word is, as a whole, or nothing. Real numbers out of range become 0 or infinite.
template <class Number>
std::optional<Number> numberIn(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || word.empty()) return std::nullopt;
    if (error == std::errc()) return value;
    if constexpr (std::is_floating_point_v<Number>) return static_cast<Number>(outOfRange(word));
    return std::nullopt;
}

// A word as a message shows it: its first 24 characters, printable.
std::string shown(std::string_view word);

std::string lowerCase(std::string_view text);

// Whether two words are the same but for the case of their letters; `keyword` is in lower case.
bool isKeyword(std::string_view word, std::string_view keyword);

// The word after SPACE= as 3D Slicer writes it into comments, in upper case: "LPS". Empty without one.
std::string spaceIn(std::string_view text);

class Lines {
  public:
    enum class Break {
        statement,  // a line is a statement
        backslash,  // the same, but a \ at the end of a line joins it with the next one
        blank       // a line break is a blank like any other
    };
    // Throws InputError for UTF-16. REQUIRES: text outlives the object.
    Lines(std::string_view text, std::string name, Break lineBreak);

    // Goes to the next statement; false at the end of the file.
    bool next();
    // The same, but statements without a word are passed over.
    bool nextFilled();
    // The next word of this statement; empty at its end.
    std::string_view word();
    // What is left of this line, without blanks around it. With word(), it is all there is.
    std::string_view restOfLine();
    // Three coordinates, of the next three words. Throws InputError for anything else.
    Point point();

    // The most significant digits of a coordinate so far: 4 of "-0.01250e3".
    int mostDigits() const { return mostDigits_; }
    bool isLineDone() const;                          // whether no word is left on this line
    std::size_t number() const { return number_; }    // of this line, counted from 1
    bool isFirstWord() const { return isFirst_; }     // whether the last word() was the first of its line
    std::string_view after() const { return rest_; }  // the text behind this line
    const std::string& name() const { return name_; }
    // The comments so far that are tags.
    std::vector<MeshTag> takeTags() { return std::move(tags_); }

    // Throws InputError: "NAME: line N: what".
    [[noreturn]] void fail(const std::string& what) const { failAt(number_, what); }
    [[noreturn]] void failAt(std::size_t line, const std::string& what) const;

  private:
    bool takeLine();
    std::size_t takeComment();
    std::string_view wordOfLine();

    std::string_view rest_, line_;
    std::string name_;
    Break break_;
    char end_ = '\n';      // of a line
    bool goesOn_ = false;  // the statement, on the next line
    bool isFirst_ = false, hasWord_ = false;
    std::size_t number_ = 0;
    int mostDigits_ = 0;
    std::vector<MeshTag> tags_;
};

}  // namespace isowave
