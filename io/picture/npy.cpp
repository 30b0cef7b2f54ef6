#include "io/picture/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr char kNativeOrder = std::endian::native == std::endian::big ? '>' : '<';
// By ValueType.
constexpr std::string_view kKinds[] = {"i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"};

// The text between `'key': ` and the next comma outside brackets in the header's Python dictionary.
std::string headerValue(std::string_view header, const std::string& key, const std::string& name) {
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
        if (static_cast<unsigned char>(c) > ' ') value += c;  // a message that quotes it is one line
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

// '<f8', '>i2', '|u1'
ValueType typeOf(const std::string& description, const std::string& name) {
    if (description.size() == 5 && description.front() == '\'' && description.back() == '\'') {
        const std::string kind = description.substr(2, 2);
        if (kind == "b1") return ValueType::uint8;
        const auto found = std::find(std::begin(kKinds), std::end(kKinds), kind);
        if (found != std::end(kKinds)) return static_cast<ValueType>(found - std::begin(kKinds));
    }
    throw InputError(
        name, "holds elements of type " + description +
                  "; booleans, integers and floats of 4 or 8 bytes are read: save it with .astype(float)");
}

void requireShape(const std::vector<std::size_t>& shape, const std::string& text, const std::string& name) {
    if (shape.size() < 2 || shape.size() > 3 || (shape.size() == 3 && (shape[2] < 1 || shape[2] > 4)))
        throw InputError(name,
                         "has the shape " + text + "; a grid has (rows, columns) or (rows, columns, 1 to 4)");
    if (shape[0] < 2 || shape[1] < 2 || shape[0] > (1u << 20) || shape[1] > (1u << 20))
        throw InputError(name, "has the shape " + text + "; from 2 x 2 to 2^20 x 2^20 samples are read");
}

// In the file's order, elements that lie `data` long and in the other byte order where `swap` says so.
void takeElements(const char* data, bool fortran, bool swap, Picture& picture) {
    const auto rows = static_cast<std::size_t>(picture.height),
               columns = static_cast<std::size_t>(picture.width),
               channels = static_cast<std::size_t>(picture.channels), each = sizeOf(picture.type);
    auto* to = reinterpret_cast<char*>(picture.samples.data());
    for (std::size_t r = 0, k = 0; r < rows; ++r)
        for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t ch = 0; ch < channels; ++ch, ++k, to += each) {
                const char* from = data + each * (fortran ? r + rows * (c + columns * ch) : k);
                std::copy(from, from + each, to);
                if (swap) std::reverse(to, to + each);
            }
}

}  // namespace

Picture readNpy(std::string_view bytes, const std::string& name) {
    if (bytes.size() < 10 || !bytes.starts_with(kMagic))
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
    const std::string_view header = bytes.substr(start, length), data = bytes.substr(start + length);

    Picture picture;
    const std::string description = headerValue(header, "descr", name);
    picture.type = typeOf(description, name);
    picture.bits = static_cast<int>(8 * sizeOf(picture.type));
    const bool fortran = headerValue(header, "fortran_order", name) == "True";
    const std::string shapeText = headerValue(header, "shape", name);
    const std::vector<std::size_t> shape = shapeOf(shapeText, name);
    requireShape(shape, shapeText, name);
    picture.height = static_cast<std::int64_t>(shape[0]);
    picture.width = static_cast<std::int64_t>(shape[1]);
    picture.channels = shape.size() == 3 ? static_cast<int>(shape[2]) : 1;
    const std::size_t needed =
        shape[0] * shape[1] * static_cast<std::size_t>(picture.channels) * sizeOf(picture.type);
    if (data.size() < needed)
        throw InputError(name, fmt::format("shape {} needs {} bytes but the file holds {}; it is truncated",
                                           shapeText, needed, data.size()));
    picture.samples.resize(needed);
    const char order = description[1];
    takeElements(data.data(), fortran, (order == '<' || order == '>') && order != kNativeOrder, picture);
    return picture;
}

std::string npyBytes(const Picture& picture) {
    const std::string shape =
        picture.channels == 1 ? fmt::format("({}, {})", picture.height, picture.width)
                              : fmt::format("({}, {}, {})", picture.height, picture.width, picture.channels);
    std::string header = fmt::format("{{'descr': '{}{}', 'fortran_order': False, 'shape': {}, }}",
                                     sizeOf(picture.type) == 1 ? '|' : kNativeOrder,
                                     kKinds[static_cast<int>(picture.type)], shape);
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    std::string bytes(kMagic);
    bytes += {'\1', '\0', static_cast<char>(header.size() & 255), static_cast<char>(header.size() >> 8)};
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(picture.samples.data()), picture.samples.size());
    return bytes;
}

}  // namespace isowave
