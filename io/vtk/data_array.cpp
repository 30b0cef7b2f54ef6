#include "io/vtk/data_array.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/text.h"
#include "isowave/error.h"

namespace isowave::vtk {
namespace {

constexpr std::uint64_t kMostBlocks = std::uint64_t(1) << 40;
// Deflate's best: 1032 to 1.
constexpr std::uint64_t kBestRatio = 1032;
constexpr std::string_view kBlanks = " \t\r\n";

// What a broken array is called in messages.
struct Place {
    const std::string& file;
    const std::string& array;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(file, fmt::format("its array '{}' {}", array, what));
    }
    [[noreturn]] void breakOff() const { fail("breaks off; the file is truncated or its header is wrong"); }
};

// ---- bytes, as they are or in base64

class Bytes {
  public:
    Bytes(std::string_view text, bool base64, const Place& place)
        : rest_(text), base64_(base64), place_(place) {}

    // The next `count` bytes, which base64 has encoded by themselves: four characters for each three of them.
    std::string unit(std::uint64_t count) {
        if (!base64_) return asTheyAre(count);
        std::string out = decoded(count);
        rest_.remove_prefix((count + 2) / 3 * 4);
        return out;
    }
    // The same, and they stay: more may be encoded with them.
    std::string peek(std::uint64_t count) {
        if (base64_) return decoded(count);
        if (rest_.size() < count) place_.breakOff();
        return std::string(rest_.substr(0, count));
    }

  private:
    std::string asTheyAre(std::uint64_t count) {
        if (rest_.size() < count) place_.breakOff();
        const std::string out(rest_.substr(0, count));
        rest_.remove_prefix(count);
        return out;
    }

    std::uint32_t digit(char c) const {
        if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
        if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a' + 26);
        if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0' + 52);
        if (c == '+') return 62;
        if (c == '/') return 63;
        place_.fail("has characters that are not base64; the file is damaged");
    }

    std::string decoded(std::uint64_t count) const {
        if (count > rest_.size() || (count + 2) / 3 * 4 > rest_.size()) place_.breakOff();
        std::string out;
        out.reserve(count + 2);
        for (std::size_t at = 0; out.size() < count; at += 4) {
            std::uint32_t bits = 0;
            const std::size_t bytes = std::min<std::size_t>(3, count - out.size());
            for (std::size_t i = 0; i < 4; ++i) bits = bits << 6 | (i <= bytes ? digit(rest_[at + i]) : 0);
            for (std::size_t i = 0; i < bytes; ++i) out += static_cast<char>(bits >> (16 - 8 * i) & 255);
        }
        return out;
    }

    std::string_view rest_;
    bool base64_;
    const Place& place_;
};

std::uint64_t lengthAt(const File& file, std::string_view bytes, std::size_t number) {
    const std::size_t each = file.longLengths ? 8 : 4;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < each; ++i) {
        const std::size_t at = number * each + (file.bigEndian ? i : each - 1 - i);
        value = value << 8 | static_cast<unsigned char>(bytes[at]);
    }
    return value;
}

// Blocks, bytes of a block, bytes of the last one if it is shorter, then the compressed length of each; then the blocks.
std::string inflated(const File& file, Bytes& bytes, std::uint64_t expected, const Place& place) {
    const std::uint64_t each = file.longLengths ? 8 : 4;
    const std::string head = bytes.peek(3 * each);
    const std::uint64_t blocks = lengthAt(file, head, 0), whole = lengthAt(file, head, 1),
                        last = lengthAt(file, head, 2);
    // invariant of what goes on: (blocks - 1) whole + (last, or whole where it is 0) = expected
    const bool sane = blocks <= kMostBlocks && last <= whole && (blocks == 0) == (expected == 0) &&
                      (blocks < 2 || (whole > 0 && blocks - 1 <= expected / whole));
    if (!sane || (blocks > 0 && (blocks - 1) * whole + (last > 0 ? last : whole) != expected))
        place.fail(fmt::format("says that it has {} compressed blocks of {} bytes; expected {} bytes in all",
                               blocks, whole, expected));
    const std::string lengths = bytes.unit((3 + blocks) * each);
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
        const std::uint64_t length = lengthAt(file, lengths, 3 + i);
        if (length > std::numeric_limits<std::uint32_t>::max()) place.breakOff();
        packed += length;
    }
    const std::string stored = bytes.unit(packed);
    if (expected / kBestRatio > packed)
        place.fail(fmt::format("holds {} compressed bytes, too few for {}", packed, expected));
    std::string out(expected, '\0');
    std::uint64_t from = 0, to = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
        const std::uint64_t length = lengthAt(file, lengths, 3 + i);
        const std::uint64_t size = i + 1 == blocks && last > 0 ? last : whole;
        uLongf got = size;
        if (size > expected - to ||
            uncompress(reinterpret_cast<Bytef*>(out.data() + to), &got,
                       reinterpret_cast<const Bytef*>(stored.data() + from), length) != Z_OK ||
            got != size)
            place.fail(fmt::format("is damaged in its compressed block {}", i + 1));
        from += length;
        to += size;
    }
    return out;
}

std::string binary(const File& file, Bytes bytes, std::uint64_t expected, const Place& place) {
    if (file.compressed) return inflated(file, bytes, expected, place);
    const std::uint64_t each = file.longLengths ? 8 : 4;
    const std::uint64_t length = lengthAt(file, bytes.peek(each), 0);
    if (length != expected) place.fail(fmt::format("holds {} bytes; expected {}", length, expected));
    return bytes.unit(each + length).substr(each);
}

// ---- text

template <class T>
T numberOf(std::string_view word, const Place& place) {
    std::size_t at = 0;
    if constexpr (std::is_integral_v<T>) {
        T value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error == std::errc() && end == word.data() + word.size()) return value;
    } else if (const auto value = takeNumber(word, at); value && at == word.size()) {
        return static_cast<T>(*value);
    }
    place.fail(fmt::format("holds '{}'; expected a number of its type", std::string(word.substr(0, 24))));
}

std::string fromText(ValueType type, std::string_view text, std::int64_t count, const Place& place) {
    if (static_cast<std::uint64_t>(count) > text.size()) place.breakOff();
    std::string out;
    out.reserve(static_cast<std::size_t>(count) * sizeOf(type));
    withType(type, [&]<class T>(T) {
        for (std::int64_t i = 0; i <= count; ++i) {
            text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
            if (text.empty() && i < count) place.breakOff();
            if (text.empty()) return;
            if (i == count) place.fail(fmt::format("holds more than {} numbers", count));
            const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
            const T value = numberOf<T>(text.substr(0, end), place);
            out.append(reinterpret_cast<const char*>(&value), sizeof value);
            text.remove_prefix(end);
        }
    });
    return out;
}

// The first of the element's texts that is not blank: VTK puts InformationKeys beside it.
std::string_view textOf(const Array& array, std::string_view bytes) {
    for (const XmlElement::Range& range : array.element->texts) {
        std::string_view text = bytes.substr(std::min(range.begin, bytes.size()), range.end - range.begin);
        const std::size_t first = text.find_first_not_of(kBlanks);
        if (first == std::string_view::npos) continue;
        return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
    }
    return {};
}

std::optional<std::uint64_t> wholeNumber(const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good = error == std::errc() && end == text.data() + text.size() && !text.empty();
    return good ? std::optional(value) : std::nullopt;
}

// Bytes of the file from which on an appended array stands.
std::uint64_t startOf(const File& file, const Array& array, const Place& place) {
    const auto offset = wholeNumber(array.element->get("offset"));
    if (!offset || file.appended == 0 || *offset > (std::uint64_t(1) << 62))
        place.fail("should be among the appended data, where it is not; the file is truncated or damaged");
    return file.appended + *offset;
}

bool isAppended(const Array& array) { return array.element->get("format") == "appended"; }

void turnBytes(ValueType type, std::string& bytes) {
    const std::size_t each = sizeOf(type);
    for (std::size_t at = 0; each > 1 && at + each <= bytes.size(); at += each)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + each));
}

}  // namespace

std::optional<File> parse(std::string_view bytes, const std::string& name, const std::string& kind) {
    std::optional<XmlDocument> document = parseXml(bytes, name, "AppendedData");
    if (!document) return std::nullopt;
    File file;
    file.xml = std::move(*document);
    file.kind = kind;
    const XmlElement& root = file.xml.root;
    if (root.name != "VTKFile" || root.get("type") != kind || !root.child(kind))
        throw InputError(name, fmt::format("is an XML file of '{}' {}; expected a VTKFile of {}", root.name,
                                           root.get("type"), kind));
    const std::string compressor = root.get("compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
        throw InputError(
            name, fmt::format("is compressed by {}; vtkZLibDataCompressor is read: save it with that, or "
                              "uncompressed",
                              compressor));
    file.bigEndian = root.get("byte_order") == "BigEndian";
    file.longLengths = root.get("header_type") == "UInt64";
    file.compressed = !compressor.empty();
    const XmlElement* const behind = root.child("AppendedData");
    file.base64Behind = behind && behind->get("encoding") == "base64";
    if (!file.xml.stoppedAt) return file;
    const std::size_t underscore = bytes.find_first_not_of(kBlanks, *file.xml.stoppedAt);
    if (underscore == std::string_view::npos) return std::nullopt;
    if (bytes[underscore] != '_')
        throw InputError(name, "has no '_' before its appended data; it is damaged");
    file.appended = underscore + 1;
    return file;
}

Array describe(const XmlElement& element, const std::string& name) {
    static const std::map<std::string, ValueType> types = {
        {"Int8", ValueType::int8},      {"UInt8", ValueType::uint8},   {"Int16", ValueType::int16},
        {"UInt16", ValueType::uint16},  {"Int32", ValueType::int32},   {"UInt32", ValueType::uint32},
        {"Int64", ValueType::int64},    {"UInt64", ValueType::uint64}, {"Float32", ValueType::float32},
        {"Float64", ValueType::float64}};
    const auto type = types.find(element.get("type"));
    if (type == types.end())
        throw InputError(
            name, fmt::format("its array '{}' is of type '{}'; expected Int8 to UInt64, Float32 or Float64",
                              element.get("Name"), element.get("type")));
    const std::string components = element.get("NumberOfComponents");
    const auto number = components.empty() ? std::optional<std::uint64_t>(1) : wholeNumber(components);
    if (!number || *number < 1 || *number > 1000)
        throw InputError(name, fmt::format("its array '{}' has '{}' components; expected 1 to 1000",
                                           element.get("Name"), components));
    return {element.get("Name"), type->second, static_cast<std::int64_t>(*number), &element};
}

std::optional<std::int64_t> plainStart(const File& file, const Array& array) {
    if (!isAppended(array) || file.base64Behind || file.compressed) return std::nullopt;
    const auto offset = wholeNumber(array.element->get("offset"));
    if (!offset || file.appended == 0 || *offset > (std::uint64_t(1) << 62)) return std::nullopt;
    return static_cast<std::int64_t>(file.appended + *offset);
}

std::string decode(const File& file, const Array& array, std::string_view bytes, std::int64_t count,
                   const std::string& name) {
    const Place place{name, array.name};
    const std::string format = array.element->get("format");
    if (format == "ascii") return fromText(array.type, textOf(array, bytes), count, place);
    if (format != "binary" && format != "appended")
        place.fail(fmt::format("is of format '{}'; expected ascii, binary or appended", format));
    const std::uint64_t expected = static_cast<std::uint64_t>(count) * sizeOf(array.type);
    std::string_view text = textOf(array, bytes);
    if (isAppended(array)) {
        const std::uint64_t start = startOf(file, array, place);
        if (start > bytes.size()) place.breakOff();
        text = bytes.substr(start);
    }
    std::string out = binary(file, {text, !isAppended(array) || file.base64Behind, place}, expected, place);
    if (file.bigEndian != (std::endian::native == std::endian::big)) turnBytes(array.type, out);
    return out;
}

}  // namespace isowave::vtk
