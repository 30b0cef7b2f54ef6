#include "io/mesh/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"

namespace isowave {
namespace {

bool isBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; }

bool isLetter(char c) { return lower(c) >= 'a' && lower(c) <= 'z'; }

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    return text;
}

// Of a number in decimals, without zeros before the first other digit.
int digitsOf(std::string_view word) {
    int digits = 0;
    for (const char c : word) {
        if (c == 'e' || c == 'E') break;
        digits += c >= '0' && c <= '9' && (digits > 0 || c != '0');
    }
    return digits;
}

}  // namespace

double outOfRange(std::string_view word) {
    const std::size_t exponent = word.find_first_of("eE");
    const bool small = exponent < word.size() ? word.substr(exponent + 1).starts_with('-')
                                              : word.find('.') < word.find_first_of("123456789");
    return (small ? 0.0 : HUGE_VAL) * (word.starts_with('-') ? -1 : 1);
}

std::string shown(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 24)) text += c >= ' ' && c < 127 ? c : '?';
    return word.size() > 24 ? text + "..." : text;
}

std::string lowerCase(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), lower);
    return result;
}

bool isKeyword(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() && std::equal(word.begin(), word.end(), keyword.begin(),
                                                       [](char a, char b) { return lower(a) == b; });
}

std::string spaceIn(std::string_view text) {
    constexpr std::string_view key = "SPACE=";
    const std::size_t at = text.find(key);
    if (at == text.npos) return {};
    const auto begin = text.begin() + at + key.size();
    std::string space(begin, std::find_if_not(begin, text.end(), isLetter));
    for (char& c : space) c = lower(c) == c ? static_cast<char>(c - ('a' - 'A')) : c;
    return space;
}

Lines::Lines(std::string_view text, std::string name, Break lineBreak)
    : rest_(text), name_(std::move(name)), break_(lineBreak), goesOn_(lineBreak == Break::blank) {
    if (rest_.starts_with("\xff\xfe") || rest_.starts_with("\xfe\xff"))
        throw InputError(name_, "is text in UTF-16; save it as UTF-8 or ASCII");
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
    const std::size_t first = rest_.find_first_of("\r\n");
    if (first != rest_.npos && rest_[first] == '\r' && rest_.substr(first + 1, 1) != "\n") end_ = '\r';
}

void Lines::failAt(std::size_t line, const std::string& what) const {
    throw InputError(name_, fmt::format("line {}: {}", line, what));
}

// Where the comment of line_ begins, or its size. A comment that is a tag is kept.
std::size_t Lines::takeComment() {
    std::size_t at = line_.find('#');
    while (at != line_.npos && at > 0 && !isBlank(line_[at - 1])) at = line_.find('#', at + 1);
    if (at == line_.npos) return line_.size();
    const std::string_view comment = trimmed(line_.substr(at + 1));
    if (comment.size() > 1 && comment[0] == 't' && isBlank(comment[1]))
        tags_.push_back({std::string(trimmed(comment.substr(1))), number_});
    return at;
}

bool Lines::takeLine() {
    line_ = {};
    if (rest_.empty()) return goesOn_ = false;
    const std::size_t end = std::min(rest_.find(end_), rest_.size());
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    hasWord_ = false;
    line_ = line_.substr(0, takeComment());
    if (break_ != Break::backslash) return true;
    line_ = trimmed(line_);
    goesOn_ = line_.ends_with('\\');
    if (goesOn_) line_.remove_suffix(1);
    return true;
}

bool Lines::next() {
    while (goesOn_) takeLine();
    return takeLine();
}

bool Lines::nextFilled() {
    while (next())
        if (!isLineDone()) return true;
    return false;
}

std::string_view Lines::wordOfLine() {
    const char *begin = line_.data(), *end = begin + line_.size();
    while (begin != end && isBlank(*begin)) ++begin;
    const char* wordEnd = begin;
    while (wordEnd != end && !isBlank(*wordEnd)) ++wordEnd;
    line_ = {wordEnd, static_cast<std::size_t>(end - wordEnd)};
    return {begin, static_cast<std::size_t>(wordEnd - begin)};
}

std::string_view Lines::word() {
    std::string_view found = wordOfLine();
    while (found.empty() && goesOn_) {
        takeLine();
        found = wordOfLine();
    }
    isFirst_ = !hasWord_;
    hasWord_ = true;
    return found;
}

bool Lines::isLineDone() const { return trimmed(line_).empty(); }

std::string_view Lines::restOfLine() {
    const std::string_view rest = trimmed(line_);
    line_ = {};
    return rest;
}

Point Lines::point() {
    Point p;
    const std::size_t line = number_;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view found = word();
        const auto value = numberIn<double>(found);
        if (!value && (found.empty() || number_ != line))
            failAt(line, fmt::format("a point needs three coordinates, found {}", i));
        if (!value) fail(fmt::format("'{}' is not a number", shown(found)));
        if (!std::isfinite(*value)) fail(fmt::format("coordinate {} is not finite", shown(found)));
        p[i] = *value;
        mostDigits_ = std::max(mostDigits_, digitsOf(found));
    }
    return p;
}

}  // namespace isowave
