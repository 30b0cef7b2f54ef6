#include "io/mesh/read_problems.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace isowave {
namespace {

using Words = std::vector<std::string_view>;

Words wordsOf(std::string_view line) {
    constexpr std::string_view blank = " \t\r\f\v";
    Words words;
    for (std::size_t at = line.find_first_not_of(blank); at != line.npos;) {
        const std::size_t end = std::min(line.find_first_of(blank, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(blank, end);
    }
    return words;
}

// Walks the lines of a text; number() counts from 1, as editors do.
class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {}

    // The next line's words, or nothing at the end.
    std::optional<Words> next() {
        if (rest_.empty()) return std::nullopt;
        const std::size_t end = rest_.find('\n');
        const std::string_view line = rest_.substr(0, end);
        rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
        ++number_;
        return wordsOf(line);
    }
    // The same, but lines that are empty or hold only a #-comment are passed over, and comments are cut off.
    std::optional<Words> nextFilled() {
        while (auto words = next()) {
            for (std::size_t i = 0; i < words->size(); ++i) {
                if ((*words)[i].starts_with('#')) words->resize(i);
            }
            if (!words->empty()) return words;
        }
        return std::nullopt;
    }
    std::size_t number() const { return number_; }

  private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

std::string shown(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 24)) text += c >= ' ' && c < 127 ? c : '?';
    return word.size() > 24 ? text + "..." : text;
}

template <class Number>
std::optional<Number> numberOf(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

// Three coordinates from words[first] on.
std::optional<std::string> coordinateProblem(const Words& words, std::size_t first, std::size_t line) {
    if (words.size() < first + 3) {
        return fmt::format("line {}: a point needs three coordinates, found {}", line,
                           words.size() < first ? 0 : words.size() - first);
    }
    for (std::size_t i = first; i < first + 3; ++i) {
        const auto value = numberOf<double>(words[i]);
        if (!value) return fmt::format("line {}: '{}' is not a number", line, shown(words[i]));
        if (!std::isfinite(*value)) {
            return fmt::format("line {}: coordinate {} is not finite", line, shown(words[i]));
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> asciiStlProblem(std::string_view text) {
    Lines lines(text);
    bool inSolid = false, inFacet = false;
    std::size_t facets = 0, facetLine = 0;
    int corners = 0;
    while (const auto words = lines.next()) {
        if (words->empty()) continue;
        const std::string_view word = words->front();
        if (word == "solid") {
            inSolid = true;
        } else if (word == "endsolid") {
            if (inFacet) return fmt::format("line {}: 'endsolid' inside a facet", lines.number());
            inSolid = false;
        } else if (word == "facet") {
            if (inFacet) {
                return fmt::format("line {}: the facet of line {} has no 'endfacet'", lines.number(),
                                   facetLine);
            }
            inFacet = true;
            facetLine = lines.number();
            corners = 0;
        } else if (word == "vertex") {
            if (!inFacet) return fmt::format("line {}: a vertex outside a facet", lines.number());
            if (auto problem = coordinateProblem(*words, 1, lines.number())) return problem;
            ++corners;
        } else if (word == "endfacet") {
            if (corners != 3) {
                return fmt::format("line {}: the facet has {} vertices; STL holds triangles only", facetLine,
                                   corners);
            }
            inFacet = false;
            ++facets;
        } else if (word != "outer" && word != "endloop" && word != "color") {
            return fmt::format("line {}: '{}' is no STL keyword", lines.number(), shown(word));
        }
    }
    if (inFacet) {
        return fmt::format("the file ends inside facet {} (line {}); it is truncated", facets + 1, facetLine);
    }
    if (inSolid) {
        return fmt::format(
            "the file ends after {} facets without 'endsolid'; it is truncated, or append that line", facets);
    }
    if (facets == 0) return "no facets";
    return std::nullopt;
}

std::optional<std::string> objProblem(std::string_view text) {
    Lines lines(text);
    std::int64_t points = 0, faces = 0;
    std::vector<std::pair<std::int64_t, std::size_t>> positive;  // largest references and their lines
    while (const auto words = lines.nextFilled()) {
        const std::string_view word = words->front();
        if (word == "v") {
            if (auto problem = coordinateProblem(*words, 1, lines.number())) return problem;
            ++points;
        } else if (word == "f") {
            ++faces;
            if (words->size() < 4) {
                return fmt::format("line {}: a face needs three corners, found {}", lines.number(),
                                   words->size() - 1);
            }
            for (std::size_t i = 1; i < words->size(); ++i) {
                const std::string_view corner = (*words)[i].substr(0, (*words)[i].find('/'));
                const auto index = numberOf<std::int64_t>(corner);
                if (!index) {
                    return fmt::format("line {}: corner '{}' is not a point's number", lines.number(),
                                       shown((*words)[i]));
                }
                if (*index == 0) {
                    return fmt::format("line {}: a face refers to point 0; OBJ counts from 1",
                                       lines.number());
                }
                if (*index < -points) {
                    return fmt::format("line {}: a face refers to point {}, but only {} points come before",
                                       lines.number(), *index, points);
                }
                if (*index > 0 && (positive.empty() || *index > positive.back().first)) {
                    positive.emplace_back(*index, lines.number());
                }
            }
        }
    }
    for (const auto& [index, line] : positive) {
        if (index > points) {
            return fmt::format(
                "line {}: a face refers to point {}, but the file has only {} points; it is truncated or "
                "damaged",
                line, index, points);
        }
    }
    if (points == 0) return "no points ('v' lines)";
    if (faces == 0) return fmt::format("{} points but no faces ('f' lines); it is a point cloud", points);
    return std::nullopt;
}

std::optional<std::string> offProblem(std::string_view text) {
    Lines lines(text);
    auto words = lines.nextFilled();
    if (!words || words->front().find("OFF") == std::string_view::npos) {
        return "line 1: an OFF file starts with 'OFF'";
    }
    if (words->size() > 1 && words->at(1) == "BINARY") {
        return "binary OFF is not read; save it as PLY or as ASCII OFF";
    }
    Words counts(words->begin() + 1, words->end());
    if (counts.empty()) {
        words = lines.nextFilled();
        if (words) counts = *words;
    }
    const auto points = counts.size() > 1 ? numberOf<std::int64_t>(counts[0]) : std::nullopt;
    const auto faces = counts.size() > 1 ? numberOf<std::int64_t>(counts[1]) : std::nullopt;
    if (!points || !faces || *points < 0 || *faces < 0) {
        return fmt::format("line {}: expected the numbers of points, faces and edges", lines.number());
    }
    if (*points == 0 || *faces == 0) return fmt::format("{} points and {} faces", *points, *faces);
    for (std::int64_t i = 0; i < *points; ++i) {
        words = lines.nextFilled();
        if (!words) {
            return fmt::format("the header promises {} points but the file ends after {}; it is truncated",
                               *points, i);
        }
        if (auto problem = coordinateProblem(*words, 0, lines.number())) return problem;
    }
    for (std::int64_t i = 0; i < *faces; ++i) {
        words = lines.nextFilled();
        if (!words) {
            return fmt::format("the header promises {} faces but the file ends after {}; it is truncated",
                               *faces, i);
        }
        const auto corners = numberOf<std::int64_t>(words->front());
        if (!corners || *corners < 3) {
            return fmt::format("line {}: a face starts with its number of corners, at least 3; found '{}'",
                               lines.number(), shown(words->front()));
        }
        if (std::int64_t(words->size()) < *corners + 1) {
            return fmt::format("line {}: the face promises {} corners but lists {}; the file is truncated",
                               lines.number(), *corners, words->size() - 1);
        }
        for (std::int64_t c = 1; c <= *corners; ++c) {
            const auto index = numberOf<std::int64_t>((*words)[c]);
            if (!index || *index < 0 || *index >= *points) {
                return fmt::format("line {}: a face refers to point '{}'; there are points 0 to {}",
                                   lines.number(), shown((*words)[c]), *points - 1);
            }
        }
    }
    return std::nullopt;
}

namespace {

struct PlyProperty {
    std::string name, type, countType;  // countType: empty for a scalar
};
struct PlyElement {
    std::string name;
    std::int64_t count = 0;
    std::vector<PlyProperty> properties;
};
struct PlyHeader {
    std::string format;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0, lines = 0;
};

std::size_t plySizeOf(std::string_view type) {
    if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
    if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
    if (type == "int" || type == "uint" || type == "int32" || type == "uint32" || type == "float" ||
        type == "float32") {
        return 4;
    }
    return type == "double" || type == "float64" ? 8 : 0;
}

// Reads the header; a string is a problem.
std::optional<std::string> parsePlyHeader(std::string_view bytes, PlyHeader& header) {
    const std::size_t end = bytes.find("end_header");
    const std::size_t newline = end == bytes.npos ? end : bytes.find('\n', end);
    if (newline == bytes.npos) return "the header has no 'end_header'; the file is truncated or no PLY";
    header.bytes = newline + 1;
    Lines lines(bytes.substr(0, header.bytes));
    while (const auto words = lines.next()) {
        const Words& w = *words;
        const auto wrong = [&] { return fmt::format("line {}: not understood", lines.number()); };
        if (lines.number() == 1) {
            if (w.size() != 1 || w[0] != "ply") return "line 1: a PLY file starts with 'ply'";
        } else if (w.empty() || w[0] == "comment" || w[0] == "obj_info" || w[0] == "end_header") {
            continue;
        } else if (w[0] == "format" && w.size() > 1) {
            header.format = w[1];
        } else if (w[0] == "element" && w.size() > 2) {
            const auto count = numberOf<std::int64_t>(w[2]);
            if (!count || *count < 0) return wrong();
            header.elements.push_back({std::string(w[1]), *count, {}});
        } else if (w[0] == "property" && w.size() > 2 && !header.elements.empty()) {
            const bool list = w[1] == "list";
            if (w.size() < (list ? 5u : 3u)) return wrong();
            PlyProperty property{std::string(w[list ? 4 : 2]), std::string(w[list ? 3 : 1]),
                                 list ? std::string(w[2]) : std::string()};
            if (plySizeOf(property.type) == 0 || (list && plySizeOf(property.countType) == 0)) {
                return fmt::format("line {}: unknown type", lines.number());
            }
            header.elements.back().properties.push_back(std::move(property));
        } else {
            return wrong();
        }
    }
    header.lines = lines.number();
    return std::nullopt;
}

// What the elements must be, before any of them is read.
std::optional<std::string> plyElementProblem(const PlyHeader& header) {
    if (header.format != "ascii" && header.format != "binary_little_endian" &&
        header.format != "binary_big_endian") {
        return fmt::format("unknown format '{}'", shown(header.format));
    }
    std::int64_t points = 0, faces = 0;
    for (const PlyElement& element : header.elements) {
        if (element.properties.empty()) return fmt::format("element '{}' has no properties", element.name);
        if (element.name == "vertex") {
            points += element.count;
            int axes = 0;
            for (const auto& p : element.properties) axes += p.name == "x" || p.name == "y" || p.name == "z";
            if (axes != 3) return "its vertices lack x, y or z";
        }
        if (element.name != "face") continue;
        faces += element.count;
        bool found = false;
        for (const auto& p : element.properties) {
            if (p.name != "vertex_indices" && p.name != "vertex_index") continue;
            found = true;
            if (p.type != "int" && p.type != "uint" && p.type != "int32" && p.type != "uint32") {
                return fmt::format("faces list their corners as '{}'; only int and uint are read", p.type);
            }
        }
        if (!found) return "its faces lack the list 'vertex_indices'";
    }
    if (points == 0) return "no points";
    if (faces == 0) {
        return fmt::format("{} points but no faces; it is a point cloud, or made of triangle strips", points);
    }
    return std::nullopt;
}

std::string plyTruncated(const PlyElement& element, std::int64_t row) {
    return fmt::format(
        "the header promises {} of element '{}' but the file ends in number {}; it is truncated",
        element.count, element.name, row + 1);
}

std::optional<std::string> plyAsciiProblem(std::string_view bytes, const PlyHeader& header) {
    Lines lines(bytes.substr(header.bytes));
    for (const PlyElement& element : header.elements) {
        for (std::int64_t row = 0; row < element.count; ++row) {
            const auto words = lines.nextFilled();
            if (!words) return plyTruncated(element, row);
            const std::size_t line = header.lines + lines.number();
            std::size_t at = 0;
            for (const PlyProperty& property : element.properties) {
                std::int64_t values = 1;
                if (!property.countType.empty()) {
                    const auto count =
                        at < words->size() ? numberOf<std::int64_t>((*words)[at]) : std::nullopt;
                    if (!count || *count < 0) return fmt::format("line {}: expected a count", line);
                    values = *count;
                    ++at;
                }
                for (std::int64_t i = 0; i < values; ++i, ++at) {
                    if (at >= words->size()) {
                        return fmt::format(
                            "line {}: element '{}' lacks '{}'; the file is truncated or damaged", line,
                            element.name, property.name);
                    }
                    const auto value = numberOf<double>((*words)[at]);
                    if (!value) {
                        return fmt::format("line {}: '{}' is not a number", line, shown((*words)[at]));
                    }
                    if (!std::isfinite(*value)) {
                        return fmt::format("line {}: '{}' of element '{}' is not finite", line, property.name,
                                           element.name);
                    }
                }
            }
        }
    }
    return std::nullopt;
}

// A list's count: one, two or four bytes.
std::int64_t plyCountAt(const char* bytes, std::size_t size, bool bigEndian) {
    std::int64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const auto byte = static_cast<unsigned char>(bytes[bigEndian ? size - 1 - i : i]);
        value |= std::int64_t(byte) << (8 * i);
    }
    return value;
}

std::optional<std::string> plyBinaryProblem(std::string_view bytes, const PlyHeader& header) {
    const bool bigEndian = header.format == "binary_big_endian";
    std::size_t at = header.bytes;
    for (const PlyElement& element : header.elements) {
        for (std::int64_t row = 0; row < element.count; ++row) {
            for (const PlyProperty& property : element.properties) {
                std::uint64_t values = 1;
                if (!property.countType.empty()) {
                    const std::size_t size = plySizeOf(property.countType);
                    if (bytes.size() - at < size) return plyTruncated(element, row);
                    values = std::uint64_t(plyCountAt(bytes.data() + at, size, bigEndian));
                    at += size;
                }
                if ((bytes.size() - at) / plySizeOf(property.type) < values)
                    return plyTruncated(element, row);
                at += values * plySizeOf(property.type);
            }
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> plyProblem(std::string_view bytes) {
    PlyHeader header;
    if (auto problem = parsePlyHeader(bytes, header)) return problem;
    if (auto problem = plyElementProblem(header)) return problem;
    return header.format == "ascii" ? plyAsciiProblem(bytes, header) : plyBinaryProblem(bytes, header);
}

}  // namespace isowave
