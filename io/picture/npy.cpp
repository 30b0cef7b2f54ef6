#include "io/picture/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr char kNativeOrder = std::endian::native == std::endian::big ? '>' : '<';
// By ValueType.
constexpr std::string_view kKinds[] = {"i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"};

// Behind 'key' or "key" and the colon: Python takes either.
std::optional<std::size_t> behindKey(std::string_view header, const std::string& key) {
    for (const char quote : {'\'', '"'}) {
        const std::size_t found = header.find(quote + key + quote);
        if (found == std::string::npos) continue;
        const std::size_t colon = header.find_first_not_of(' ', found + key.size() + 2);
        if (colon != std::string::npos && header[colon] == ':') return colon + 1;
    }
    return std::nullopt;
}

// The text between `'key': ` and the next comma outside brackets in the header's Python dictionary.
std::string headerValue(std::string_view header, const std::string& key, const std::string& name) {
    const auto begin = behindKey(header, key);
    if (!begin) throw InputError(name, "its header has no '" + key + "'; it is not a NumPy array");
    std::size_t at = *begin;
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
    if (text.find_first_not_of("(),L0123456789") != std::string::npos)
        throw InputError(name, "has the shape " + text + "; expected whole numbers from 0 on");
    for (const char c : text) {
        if (c >= '0' && c <= '9') {
            digits += c;
        } else if (!digits.empty()) {
            if (digits.size() > 12)
                throw InputError(name, "its shape " + text + " has more than 10^12 elements along an axis");
            shape.push_back(std::stoull(digits));
            digits.clear();
        }
    }
    return shape;
}

// '<f8', '>i2', '|u1'
std::optional<NpyHeader> elementsOf(const std::string& description) {
    const bool quoted = description.size() == 5 && description.front() == description.back();
    if (!quoted || (description.front() != '\'' && description.front() != '"')) return std::nullopt;
    NpyHeader header;
    const std::string kind = description.substr(2, 2);
    const auto found = std::find(std::begin(kKinds), std::end(kKinds), kind);
    header.half = kind == "f2";
    if (header.half)
        header.type = ValueType::uint16;
    else if (found != std::end(kKinds))
        header.type = static_cast<ValueType>(found - std::begin(kKinds));
    else if (kind != "b1")
        return std::nullopt;
    const char order = description[1];
    header.bigEndian = order == '>' || (order != '<' && std::endian::native == std::endian::big);
    return header;
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

bool beginsAsNpy(std::string_view bytes) { return bytes.size() >= 10 && bytes.starts_with(kMagic); }

NpyHeader readNpyHeader(std::string_view bytes, const std::string& name) {
    if (!beginsAsNpy(bytes)) throw InputError(name, "is not a NumPy array (.npy)");
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
    const std::string_view text = bytes.substr(start, length);
    const std::string description = headerValue(text, "descr", name);
    const std::optional<NpyHeader> elements = elementsOf(description);
    if (!elements)
        throw InputError(
            name,
            "holds elements of type " + description +
                "; booleans, integers and floats of 2, 4 or 8 bytes are read: save it with .astype(float)");
    NpyHeader header = *elements;
    const std::string fortran = headerValue(text, "fortran_order", name);
    if (fortran != "True" && fortran != "False")
        throw InputError(name, "its header says 'fortran_order': " + fortran + "; expected True or False");
    header.fortran = fortran == "True";
    header.shapeText = headerValue(text, "shape", name);
    header.shape = shapeOf(header.shapeText, name);
    header.data = start + length;
    return header;
}

Picture readNpy(std::string_view bytes, const std::string& name) {
    const NpyHeader header = readNpyHeader(bytes, name);
    const std::string_view data = bytes.substr(header.data);
    if (header.half)
        throw InputError(
            name, "holds floats of 2 bytes, which are read of volumes alone: save it with .astype(float)");
    Picture picture;
    picture.type = header.type;
    picture.bits = static_cast<int>(8 * sizeOf(picture.type));
    const std::vector<std::size_t>& shape = header.shape;
    requireShape(shape, header.shapeText, name);
    picture.height = static_cast<std::int64_t>(shape[0]);
    picture.width = static_cast<std::int64_t>(shape[1]);
    picture.channels = shape.size() == 3 ? static_cast<int>(shape[2]) : 1;
    const std::size_t needed =
        shape[0] * shape[1] * static_cast<std::size_t>(picture.channels) * sizeOf(picture.type);
    if (data.size() < needed)
        throw InputError(name, fmt::format("shape {} needs {} bytes but the file holds {}; it is truncated",
                                           header.shapeText, needed, data.size()));
    picture.samples.resize(needed);
    takeElements(data.data(), header.fortran, header.bigEndian != (std::endian::native == std::endian::big),
                 picture);
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
