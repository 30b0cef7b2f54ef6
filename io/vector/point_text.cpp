#include "io/vector/point_text.h"

#include <fmt/format.h>

#include <cctype>

#include "base/text.h"

namespace isowave {
namespace {

bool isBetween(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0 || c == ','; }

void takeColumns(std::string_view text, PointRow& row) {
    for (std::size_t at = 0; row.columns < 4;) {
        while (at < text.size() && isBetween(text[at])) ++at;
        if (at == text.size()) return;
        std::size_t behind = at;
        const std::optional<double> value = takeNumber(text, behind);
        if (!value || (behind < text.size() && !isBetween(text[behind]))) {
            row.noNumber = text.substr(at);
            return;
        }
        row.values[row.columns++] = *value;
        at = behind;
    }
}

PointRow rowOf(std::string_view text, std::size_t number) {
    PointRow row;
    row.number = number;
    if (text.ends_with('\r')) text.remove_suffix(1);
    row.text = text;
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == text.npos)
        row.kind = PointRow::Kind::blank;
    else if (text[first] == '>')
        row.kind = PointRow::Kind::separator;
    else if (text[first] == '#')
        row.kind = PointRow::Kind::comment;
    else
        takeColumns(text.substr(0, text.find('#')), row);
    return row;
}

}  // namespace

void eachPointRow(std::string_view text, const std::function<void(const PointRow&)>& take) {
    text = withoutByteOrderMark(text);
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        take(rowOf(text.substr(0, end), number));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

std::string pointText(const std::vector<Polyline>& lines) {
    std::string text;
    for (const Polyline& line : lines) {
        if (lines.size() > 1) text += ">\n";
        const auto d = static_cast<std::size_t>(line.dimension);
        for (std::size_t k = 0; k < line.size() + (line.closed ? 1 : 0); ++k) {
            const double* point = line.coordinates.data() + (k % line.size()) * d;
            for (std::size_t c = 0; c < d; ++c) text += fmt::format("{}{}", c ? " " : "", point[c]);
            text += "\n";
        }
    }
    return text;
}

}  // namespace isowave
