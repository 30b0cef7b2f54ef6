#include "subdivision/lattice/grid_files.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <sstream>

#include "isowave/error.h"
#include "base/read_file.h"

namespace isowave::subdivision {

namespace {

// The text between `'key': ` and the next comma outside brackets in the header's Python dictionary.
std::string headerValue(const std::string& header, const std::string& key, const std::string& name) {
    const std::size_t found = header.find("'" + key + "':");
    if (found == std::string::npos)
        throw InputError(name, "its header has no '" + key + "'; it is not a NumPy array");
    std::size_t at = found + key.size() + 3;
    std::string value;
    for (int depth = 0; at < header.size(); ++at) {
        const char c = header[at];
        if (c == '(' || c == '[') ++depth;
        if (c == ')' || c == ']') --depth;
        if (depth == 0 && (c == ',' || c == '}')) break;
        if (c != ' ') value += c;
    }
    return value;
}

std::vector<std::size_t> shapeOf(const std::string& text, const std::string& name) {
    std::vector<std::size_t> shape;
    std::string digits;
    for (const char c : text) {
        if (c >= '0' && c <= '9') {
            digits += c;
        } else if (!digits.empty()) {
            if (digits.size() > 12) throw InputError(name, "its shape " + text + " is not a picture's");
            shape.push_back(std::stoull(digits));
            digits.clear();
        }
    }
    return shape;
}

template <class T>
double load(const char* from, bool swap) {
    char bytes[sizeof(T)];
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes[k] = from[swap ? sizeof(T) - 1 - k : k];
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
}

struct Element {
    std::size_t size;
    std::function<double(const char*)> read;
};

Element elementOf(const std::string& description, const std::string& name) {
    // '<f8', '>i2', '|u1'
    if (description.size() == 5 && description.front() == '\'' && description.back() == '\'') {
        const bool swap = (description[1] == '>') != (std::endian::native == std::endian::big) &&
                          (description[1] == '<' || description[1] == '>');
        const std::string kind = description.substr(2, 2);
        const auto make = [&]<class T>(T) {
            return Element{sizeof(T), [swap](const char* p) { return load<T>(p, swap); }};
        };
        if (kind == "f8") return make(double{});
        if (kind == "f4") return make(float{});
        if (kind == "i1") return make(std::int8_t{});
        if (kind == "i2") return make(std::int16_t{});
        if (kind == "i4") return make(std::int32_t{});
        if (kind == "i8") return make(std::int64_t{});
        if (kind == "u1" || kind == "b1") return make(std::uint8_t{});
        if (kind == "u2") return make(std::uint16_t{});
        if (kind == "u4") return make(std::uint32_t{});
        if (kind == "u8") return make(std::uint64_t{});
    }
    throw InputError(
        name, "holds elements of type " + description +
                  "; booleans, integers and floats of 4 or 8 bytes are read: save it with .astype(float)");
}

void requireFinite(const Grid& grid, const std::string& name) {
    std::size_t missing = 0, first = 0;
    for (std::size_t k = grid.values.size(); k-- > 0;) {
        if (std::isfinite(grid.values[k])) continue;
        ++missing;
        first = k / grid.channels;
    }
    if (missing == 0) return;
    throw InputError(
        name, fmt::format(
                  "{} of {} samples hold no finite number, the first at row {}, column {}; fill them or crop",
                  missing, grid.values.size(), first / grid.columns, first % grid.columns));
}

}  // namespace

Grid readGrid(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".npy") return parseNpy(readFile(path, "a grid of numbers"), path.string());
    if (extension == ".asc") return parseAsc(readFile(path, "a grid of numbers"), path.string());
    throw InputError(path.string(), "is of no kind that holds a grid; they are .npy .asc .png .tif");
}

Grid parseNpy(const std::string& bytes, const std::string& name) {
    if (bytes.size() < 10 || bytes.compare(0, 6, "\x93NUMPY") != 0)
        throw InputError(name, "is not a NumPy array (.npy)");
    const auto byte = [&](std::size_t k) {
        return static_cast<std::size_t>(static_cast<unsigned char>(bytes[k]));
    };
    const std::size_t version = byte(6);
    if (version < 1 || version > 3 || (version > 1 && bytes.size() < 12)) {
        throw InputError(name, fmt::format("is a NumPy array of version {}; 1 to 3 are read", version));
    }
    const std::size_t start = version == 1 ? 10 : 12;
    std::size_t length = byte(8) | byte(9) << 8;
    if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
    if (start + length > bytes.size()) throw InputError(name, "ends inside its header; it is truncated");
    const std::string header = bytes.substr(start, length);

    const Element element = elementOf(headerValue(header, "descr", name), name);
    const bool fortran = headerValue(header, "fortran_order", name) == "True";
    const std::string shapeText = headerValue(header, "shape", name);
    const auto shape = shapeOf(shapeText, name);
    if (shape.size() < 2 || shape.size() > 3 || (shape.size() == 3 && (shape[2] < 1 || shape[2] > 4))) {
        throw InputError(
            name, "has the shape " + shapeText + "; a grid has (rows, columns) or (rows, columns, 1 to 4)");
    }
    Grid grid{shape[0], shape[1], shape.size() == 3 ? shape[2] : 1, {}};
    if (grid.rows < 2 || grid.columns < 2 || grid.rows > (1u << 20) || grid.columns > (1u << 20)) {
        throw InputError(name, "has the shape " + shapeText + "; from 2 x 2 to 2^20 x 2^20 samples are read");
    }
    const std::size_t count = grid.rows * grid.columns * grid.channels, have = bytes.size() - start - length;
    if (have < count * element.size) {
        throw InputError(name, fmt::format("shape {} needs {} bytes but the file holds {}; it is truncated",
                                           shapeText, count * element.size, have));
    }
    const char* const data = bytes.data() + start + length;
    grid.values.resize(count);
    for (std::size_t r = 0, k = 0; r < grid.rows; ++r) {
        for (std::size_t c = 0; c < grid.columns; ++c) {
            for (std::size_t ch = 0; ch < grid.channels; ++ch, ++k) {
                const std::size_t from = fortran ? r + grid.rows * (c + grid.columns * ch) : k;
                grid.values[k] = element.read(data + from * element.size);
            }
        }
    }
    requireFinite(grid, name);
    return grid;
}

Grid parseAsc(const std::string& text, const std::string& name) {
    std::istringstream in(text);
    Grid grid;
    double noData = -9999;
    std::string word;
    // Header lines begin with a letter; the first number ends them.
    while (in >> std::ws && std::isalpha(in.peek())) {
        double value = 0;
        if (!(in >> word >> value)) throw InputError(name, "its header line '" + word + "' has no number");
        for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        if (word == "ncols" || word == "nrows") {
            if (!(value >= 2 && value <= 1 << 20))
                throw InputError(name, fmt::format("'{}' says {}; from 2 to 2^20 are read", word, value));
            (word == "ncols" ? grid.columns : grid.rows) = static_cast<std::size_t>(value);
        }
        if (word == "nodata_value") noData = value;
    }
    if (grid.rows == 0 || grid.columns == 0)
        throw InputError(name, "has no 'ncols' or no 'nrows'; it is not an ESRI ASCII grid");
    const std::size_t count = grid.rows * grid.columns;
    std::size_t missing = 0, first = 0;
    for (std::size_t k = 0; k < count; ++k) {
        double value = 0;
        if (!(in >> value)) {
            throw InputError(
                name,
                fmt::format(
                    "'ncols' and 'nrows' say {} samples but {} can be read; it is truncated or holds text",
                    count, k));
        }
        if (value == noData && missing++ == 0) first = k;
        grid.values.push_back(value);
    }
    if (missing > 0) {
        throw InputError(
            name, fmt::format(
                      "{} of {} samples are without data, the first at row {}, column {}; fill them or crop",
                      missing, count, first / grid.columns, first % grid.columns));
    }
    requireFinite(grid, name);
    return grid;
}

std::string npyBytes(const Grid& grid) {
    const std::string shape = grid.channels == 1
                                  ? fmt::format("({}, {})", grid.rows, grid.columns)
                                  : fmt::format("({}, {}, {})", grid.rows, grid.columns, grid.channels);
    const char* order = std::endian::native == std::endian::big ? ">" : "<";
    std::string header =
        fmt::format("{{'descr': '{}f8', 'fortran_order': False, 'shape': {}, }}", order, shape);
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    std::string bytes = "\x93NUMPY\x01";
    bytes += '\0';
    bytes += static_cast<char>(header.size() & 255);
    bytes += static_cast<char>(header.size() >> 8);
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(grid.values.data()), grid.values.size() * sizeof(double));
    return bytes;
}

}  // namespace isowave::subdivision
