#include "io/picture/asc.h"

#include <fmt/format.h>

#include <cctype>
#include <cstring>
#include <optional>

#include "base/text.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// Words and numbers between white space.
class Words {
  public:
    explicit Words(std::string_view text) : text_(text) {}
    bool beginsWithLetter() {
        skipBlanks();
        return at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_]));
    }
    std::string word() {
        skipBlanks();
        const std::size_t begin = at_;
        while (at_ < text_.size() && !isBlank(text_[at_])) ++at_;
        return std::string(text_.substr(begin, at_ - begin));
    }
    std::optional<double> number() {
        skipBlanks();
        return takeNumber(text_, at_);
    }

  private:
    static bool isBlank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
    void skipBlanks() {
        while (at_ < text_.size() && isBlank(text_[at_])) ++at_;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

Picture readAsc(std::string_view text, const std::string& name) {
    Words in(text);
    Picture picture;
    picture.type = ValueType::float64;
    picture.bits = 64;
    double noData = -9999;
    // Header lines begin with a letter; the first number ends them.
    while (in.beginsWithLetter()) {
        std::string word = in.word();
        const std::optional<double> value = in.number();
        if (!value) throw InputError(name, "its header line '" + word + "' has no number");
        word = toLower(std::move(word));
        if (word == "ncols" || word == "nrows") {
            if (!(*value >= 2 && *value <= 1 << 20))
                throw InputError(name, fmt::format("'{}' says {}; from 2 to 2^20 are read", word, *value));
            (word == "ncols" ? picture.width : picture.height) = static_cast<std::int64_t>(*value);
        }
        if (word == "nodata_value") noData = *value;
    }
    if (picture.width == 0 || picture.height == 0)
        throw InputError(name, "has no 'ncols' or no 'nrows'; it is not an ESRI ASCII grid");
    const auto width = static_cast<std::size_t>(picture.width),
               count = width * static_cast<std::size_t>(picture.height);
    std::vector<double> values;  // grows with what is there, not with what is promised
    std::size_t missing = 0, first = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const std::optional<double> value = in.number();
        if (!value)
            throw InputError(
                name,
                fmt::format(
                    "'ncols' and 'nrows' say {} samples but {} can be read; it is truncated or holds text",
                    count, k));
        if (*value == noData && missing++ == 0) first = k;
        values.push_back(*value);
    }
    if (missing > 0)
        throw InputError(
            name, fmt::format(
                      "{} of {} samples are without data, the first at row {}, column {}; fill them or crop",
                      missing, count, first / width, first % width));
    picture.samples.resize(count * sizeof(double));
    std::memcpy(picture.samples.data(), values.data(), picture.samples.size());
    return picture;
}

}  // namespace isowave
