#include "io/vector/svg.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cctype>
#include <cmath>

#include "base/text.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using Point2 = std::array<double, 2>;

bool isBetween(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// Numbers and commands of a path's d, or of points.
struct PathReader {
    const std::string& text;
    std::size_t at, end;
    std::string where;

    void skip() {
        while (at < end && isBetween(text[at])) ++at;
    }
    bool hasNumber() {
        skip();
        return at < end && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '-' ||
                            text[at] == '+' || text[at] == '.');
    }
    double number() {
        skip();
        std::size_t next = at;
        const std::optional<double> value = takeNumber(std::string_view(text).substr(0, end), next);
        if (!value || !std::isfinite(*value))
            throw InputError(where, fmt::format("has no number at '{}'",
                                                text.substr(at, std::min<std::size_t>(12, end - at))));
        at = next;
        return *value;
    }
};

Polyline finished(Polyline line, bool closed) {
    line.closed = closed;
    dropClosingCopy(line);
    return line;
}

std::vector<Polyline> parsePath(PathReader in) {
    std::vector<Polyline> lines;
    Polyline line;
    double x = 0, y = 0, startX = 0, startY = 0;
    const auto add = [&](double u, double v) { line.coordinates.insert(line.coordinates.end(), {u, v}); };
    const auto flush = [&](bool closed) {
        if (line.coordinates.empty()) return;
        lines.push_back(finished(std::move(line), closed));
        line = {};
    };
    char command = 0;
    while (true) {
        in.skip();
        if (in.at >= in.end) break;
        if (!in.hasNumber()) {
            command = in.text[in.at++];
        } else if (command == 0 || command == 'Z' || command == 'z') {
            throw InputError(in.where, "has numbers without a command before them");
        }
        const bool relative = command >= 'a';
        switch (command) {
            case 'Z':
            case 'z':
                flush(true);
                x = startX;
                y = startY;
                continue;
            case 'H':
            case 'h':
                x = in.number() + (relative ? x : 0);
                break;
            case 'V':
            case 'v':
                y = in.number() + (relative ? y : 0);
                break;
            case 'M':
            case 'm':
            case 'L':
            case 'l': {
                const double u = in.number(), v = in.number();
                x = u + (relative ? x : 0);
                y = v + (relative ? y : 0);
                break;
            }
            default:
                throw InputError(
                    in.where, fmt::format("has the command '{}'; only straight pieces (M L H V Z) are read: "
                                          "flatten curves first (Inkscape: Flatten Beziers)",
                                          command));
        }
        if (!std::isfinite(x) || !std::isfinite(y))
            throw InputError(in.where, "has relative pieces that add up to no finite number");
        if (command == 'M' || command == 'm') {
            flush(false);
            startX = x;
            startY = y;
            command = command == 'M' ? 'L' : 'l';  // more pairs are lines
        } else if (line.coordinates.empty()) {
            add(startX, startY);  // goes on after a Z
        }
        add(x, y);
    }
    flush(false);
    return lines;
}

std::vector<Polyline> parsePoints(PathReader in, bool closed) {
    Polyline line;
    while (in.hasNumber())
        for (int c = 0; c < 2; ++c) line.coordinates.push_back(in.number());
    in.skip();
    if (in.at < in.end) throw InputError(in.where, fmt::format("has '{}' among its points", in.text[in.at]));
    if (line.coordinates.empty()) return {};
    return {finished(std::move(line), closed)};
}

// The points as they are written. A closed line that ends where it begins gets a copy of its first point: readers take one away.
std::vector<Point2> written(const Polyline& line) {
    const auto at = [&](std::size_t i) {
        return Point2{line.coordinates[2 * i], line.coordinates[2 * i + 1]};
    };
    std::vector<Point2> points;
    for (std::size_t i = 0; i < line.size(); ++i) points.push_back(at(i));
    if (line.closed && points.size() > 1 && points.front() == points.back()) points.push_back(points.front());
    return points;
}

std::string writePath(const std::vector<Polyline>& lines, std::size_t first, std::size_t last, bool isPath) {
    std::string text;
    for (std::size_t k = first; k < last; ++k) {
        const Polyline& line = lines[k];
        const std::vector<Point2> points = written(line);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const char* before = !isPath ? (i ? " " : "") : i == 0 ? "M" : i == 1 ? "L" : " ";
            text += fmt::format("{}{},{}", before, points[i][0], points[i][1]);
        }
        if (isPath && line.closed) text += "Z";
    }
    return text;
}

// The value of an attribute of the tag [begin, end), or nothing. The name must stand alone: id="d" is not d.
bool findAttribute(const std::string& text, std::size_t begin, std::size_t end, const std::string& attribute,
                   std::size_t& valueBegin, std::size_t& valueEnd) {
    char quote = 0;
    for (std::size_t at = begin; at < end; ++at) {
        if (quote) {
            if (text[at] == quote) quote = 0;
            continue;
        }
        if (text[at] == '"' || text[at] == '\'') {
            quote = text[at];
            continue;
        }
        if (!std::isspace(static_cast<unsigned char>(text[at]))) continue;
        if (text.compare(at + 1, attribute.size(), attribute) != 0) continue;
        std::size_t next = at + 1 + attribute.size();
        while (next < end && std::isspace(static_cast<unsigned char>(text[next]))) ++next;
        if (next >= end || text[next] != '=') continue;
        ++next;
        while (next < end && std::isspace(static_cast<unsigned char>(text[next]))) ++next;
        if (next >= end || (text[next] != '"' && text[next] != '\'')) continue;
        const std::size_t close = text.find(text[next], next + 1);
        if (close == std::string::npos || close > end) continue;
        valueBegin = next + 1;
        valueEnd = close;
        return true;
    }
    return false;
}

// A tag's end: the '>' outside quotes.
std::size_t tagEnd(const std::string& text, std::size_t at) {
    char quote = 0;
    for (; at < text.size(); ++at) {
        if (quote) {
            if (text[at] == quote) quote = 0;
        } else if (text[at] == '"' || text[at] == '\'') {
            quote = text[at];
        } else if (text[at] == '>') {
            return at;
        }
    }
    return std::string::npos;
}

}  // namespace

SvgLines::SvgLines(std::string text, const std::string& name) : text_(std::move(text)) {
    for (std::size_t at = text_.find('<'); at != std::string::npos; at = text_.find('<', at + 1)) {
        if (text_.compare(at, 4, "<!--") == 0)
            at = text_.find("-->", at);
        else
            at = readTag(at, name);
        if (at == std::string::npos) break;
    }
}

std::size_t SvgLines::readTag(std::size_t at, const std::string& name) {
    const auto is = [&](std::string_view tag) {
        const std::size_t behind = at + 1 + tag.size();
        return text_.compare(at + 1, tag.size(), tag) == 0 && behind < text_.size() &&
               (std::isspace(static_cast<unsigned char>(text_[behind])) || text_[behind] == '/');
    };
    const char* const kind = is("path")       ? "path"
                             : is("polyline") ? "polyline"
                             : is("polygon")  ? "polygon"
                                              : nullptr;
    if (!kind) return at;
    const std::size_t end = tagEnd(text_, at);
    if (end == std::string::npos) throw InputError(name, "ends inside a tag; it is truncated");
    ++tags_;
    const bool isPath = is("path");
    Value value{0, 0, lines_.size(), 0, isPath};
    if (!findAttribute(text_, at, end, isPath ? "d" : "points", value.begin, value.end)) return end;
    const PathReader in{text_, value.begin, value.end, fmt::format("{}: {} {}", name, kind, tags_)};
    const std::vector<Polyline> found = isPath ? parsePath(in) : parsePoints(in, is("polygon"));
    lines_.insert(lines_.end(), found.begin(), found.end());
    value.last = lines_.size();
    values_.push_back(value);
    return end;
}

std::string SvgLines::with(const std::vector<Polyline>& lines) const {
    assert(lines.size() == lines_.size());
    std::string result;
    std::size_t at = 0;
    for (const Value& value : values_) {
        result += text_.substr(at, value.begin - at);
        result += writePath(lines, value.first, value.last, value.isPath);
        at = value.end;
    }
    return result + text_.substr(at);
}

}  // namespace isowave
