#include "io/mesh/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/mesh/float32.h"
#include "io/mesh/lines.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// The bytes of a T, in this machine's order, as a double: exact for all types of PLY.
template <class T>
double valueOf(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

struct NumberType {
    std::string_view names[2];
    std::size_t size;  // in bytes
    double (*value)(const char* bytes);

    bool isFloat32() const { return value == valueOf<float>; }
};
constexpr NumberType kTypes[] = {
    {{"char", "int8"}, 1, valueOf<std::int8_t>},    {{"uchar", "uint8"}, 1, valueOf<std::uint8_t>},
    {{"short", "int16"}, 2, valueOf<std::int16_t>}, {{"ushort", "uint16"}, 2, valueOf<std::uint16_t>},
    {{"int", "int32"}, 4, valueOf<std::int32_t>},   {{"uint", "uint32"}, 4, valueOf<std::uint32_t>},
    {{"float", "float32"}, 4, valueOf<float>},      {{"double", "float64"}, 8, valueOf<double>},
};

struct Property {
    std::string name;
    const NumberType* type = nullptr;
    const NumberType* count = nullptr;  // of a list: the type of its length
    int axis = -1;                      // 0, 1, 2: x, y, z, which are no lists
    bool isCorners = false;             // of a face
};
struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};
struct Header {
    std::string format;
    std::vector<Element> elements;
    std::vector<MeshTag> tags;

    std::uint64_t countOf(std::string_view name) const {
        std::uint64_t count = 0;
        for (const Element& element : elements) count += element.name == name ? element.count : 0;
        return count;
    }
};

// ---- header ----

class HeaderReader {
  public:
    explicit HeaderReader(Lines& lines) : lines_(lines) {}

    Header read() {
        if (lines_.after().find("end_header") == std::string_view::npos)
            throw InputError(lines_.name(),
                             "the header has no 'end_header'; the file is truncated or no PLY");
        lines_.next();
        if (lines_.word() != "ply" || !lines_.word().empty()) lines_.fail("a PLY file starts with 'ply'");
        while (lines_.next() && takeLine(lines_.word())) {
        }
        check();
        return std::move(header_);
    }

  private:
    // False at the end.
    bool takeLine(std::string_view key) {
        if (key == "end_header") return false;
        if (key == "comment")
            takeComment();
        else if (key == "format")
            header_.format = neededWord();
        else if (key == "element")
            takeElement();
        else if (key == "property")
            takeProperty();
        else if (!key.empty() && key != "obj_info")
            failLine();
        return true;
    }
    void takeComment() {
        if (lines_.word() == "t") header_.tags.push_back({std::string(lines_.restOfLine()), lines_.number()});
    }
    void takeElement() {
        std::string name(neededWord());
        const auto count = numberIn<std::int64_t>(neededWord());
        if (!count || *count < 0) failLine();
        header_.elements.push_back({std::move(name), static_cast<std::uint64_t>(*count), {}});
    }
    void takeProperty() {
        if (header_.elements.empty()) failLine();
        Property property;
        std::string_view type = neededWord(), count;
        if (type == "list") {
            count = neededWord();
            type = neededWord();
        }
        property.name = neededWord();
        property.type = typeOf(type);
        if (!count.empty()) property.count = typeOf(count);
        const std::size_t axis = property.name.size() == 1 ? std::string_view("xyz").find(property.name) : 3;
        if (!property.count && axis < 3) property.axis = static_cast<int>(axis);
        property.isCorners =
            property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
        header_.elements.back().properties.push_back(std::move(property));
    }
    const NumberType* typeOf(std::string_view word) const {
        for (const NumberType& type : kTypes)
            if (word == type.names[0] || word == type.names[1]) return &type;
        lines_.fail("unknown type");
    }
    std::string_view neededWord() {
        const std::string_view word = lines_.word();
        if (word.empty()) failLine();
        return word;
    }
    [[noreturn]] void failLine() const { lines_.fail("not understood"); }

    void check() const {
        if (header_.format != "ascii" && header_.format != "binary_little_endian" &&
            header_.format != "binary_big_endian")
            fail(fmt::format("unknown format '{}'", shown(header_.format)));
        for (const Element& element : header_.elements) checkElement(element);
        const std::uint64_t points = header_.countOf("vertex");
        if (points == 0) fail("no points");
        if (header_.countOf("face") == 0 && header_.countOf("tristrips") == 0)
            fail(fmt::format("{} points but no faces; it is a point cloud", points));
    }
    void checkElement(const Element& element) const {
        if (element.properties.empty()) fail(fmt::format("element '{}' has no properties", element.name));
        int axes[3] = {};
        bool hasCorners = false;
        for (const Property& property : element.properties) {
            if (property.axis >= 0) ++axes[property.axis];
            hasCorners = hasCorners || property.isCorners;
        }
        if (element.name == "vertex" && std::ranges::find(axes, 0) != std::end(axes))
            fail("its vertices lack x, y or z");
        if (element.name == "vertex" && std::ranges::max(axes) > 1) fail("its vertices have x, y or z twice");
        if (element.name == "face" && !hasCorners) fail("its faces lack the list 'vertex_indices'");
        if (element.name == "tristrips" && !hasCorners)
            fail("its triangle strips lack the list 'vertex_indices'");
    }
    [[noreturn]] void fail(const std::string& what) const { throw InputError(lines_.name(), what); }

    Lines& lines_;
    Header header_;
};

// ---- body: values one after the other, from text or from bytes ----

[[noreturn]] void failTruncated(const std::string& name, const Element& element, std::uint64_t row) {
    throw InputError(
        name,
        fmt::format("the header promises {} of element '{}' but the file ends in number {}; it is truncated",
                    element.count, element.name, row + 1));
}

class TextBody {
  public:
    TextBody(Lines& lines) : lines_(lines) {}

    void beginRow(const Element& element, std::uint64_t row) {
        if (!lines_.nextFilled()) failTruncated(lines_.name(), element, row);
    }
    double value(const NumberType& type, const Element& element, const Property& property) {
        const std::string_view word = lines_.word();
        if (word.empty())
            lines_.fail(fmt::format("element '{}' lacks '{}'; the file is truncated or damaged", element.name,
                                    property.name));
        const auto number =
            type.isFloat32() ? std::optional<double>(numberIn<float>(word)) : numberIn<double>(word);
        if (!number) lines_.fail(fmt::format("'{}' is not a number", shown(word)));
        if (!std::isfinite(*number) && property.axis >= 0)
            lines_.fail(fmt::format("'{}' of element '{}' is not finite", property.name, element.name));
        return *number;
    }
    [[noreturn]] void fail(const std::string& what) const { lines_.fail(what); }
    // A value takes two bytes at least.
    std::size_t mostRows(const Element& element) const {
        return (lines_.after().size() + 1) / (2 * element.properties.size());
    }

  private:
    Lines& lines_;
};

class BinaryBody {
  public:
    BinaryBody(std::string_view bytes, bool bigEndian, const std::string& name)
        : rest_(bytes), swap_(bigEndian), name_(name) {}

    void beginRow(const Element& element, std::uint64_t row) {
        element_ = &element;
        row_ = row;
    }
    double value(const NumberType& type, const Element&, const Property&) {
        if (rest_.size() < type.size) failTruncated(name_, *element_, row_);
        char bytes[8];
        std::memcpy(bytes, rest_.data(), type.size);
        if (swap_) std::reverse(bytes, bytes + type.size);
        rest_.remove_prefix(type.size);
        return type.value(bytes);
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(name_, fmt::format("element '{}' number {}: {}", element_->name, row_ + 1, what));
    }
    std::size_t mostRows(const Element& element) const {
        std::size_t bytes = 0;
        for (const Property& p : element.properties) bytes += p.count ? p.count->size : p.type->size;
        return rest_.size() / bytes;
    }

  private:
    std::string_view rest_;
    bool swap_;
    const std::string& name_;
    const Element* element_ = nullptr;
    std::uint64_t row_ = 0;
};

template <class Body>
std::uint32_t lengthOf(Body& body, const Element& element, const Property& property) {
    if (!property.count) return 1;
    const double length = body.value(*property.count, element, property);
    if (!(length >= 0 && length <= 0xffffffffu) || length != std::floor(length))
        body.fail(fmt::format("{} is no length of the list '{}'", length, property.name));
    return static_cast<std::uint32_t>(length);
}

std::uint32_t cornerOf(double value) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    return value >= 0 && value < kNone && value == std::floor(value) ? static_cast<std::uint32_t>(value)
                                                                     : kNone;
}

// One element: calls take(property, value) for each of its values, and endRow().
template <class Body, class Take, class EndRow>
void readElement(Body& body, const Element& element, const Take& take, const EndRow& endRow) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
        body.beginRow(element, row);
        for (const Property& property : element.properties) {
            const std::uint32_t length = lengthOf(body, element, property);
            for (std::uint32_t k = 0; k < length; ++k)
                take(property, body.value(*property.type, element, property));
        }
        endRow();
    }
}

// Triangle strips -> triangles: corners a b c d e make abc, cbd, cde; -1 ends a strip, and so does the end of the list. A corner given
// twice in a row is how a strip turns or joins another one: no triangle.
class Strips {
  public:
    explicit Strips(PolygonSoup& soup) : soup_(soup) {}

    void take(double value) {
        if (value == -1) return end();
        const std::uint32_t corner = cornerOf(value);
        if (length_ >= 2) add(corner);
        last_ = {last_[1], corner};
        ++length_;
    }
    void end() { length_ = 0; }

  private:
    void add(std::uint32_t corner) {
        auto [a, b] = last_;
        if (a == b || b == corner || corner == a) return;
        if (length_ % 2 == 1) std::swap(a, b);
        soup_.corners.insert(soup_.corners.end(), {a, b, corner});
        soup_.endFace();
    }

    PolygonSoup& soup_;
    std::array<std::uint32_t, 2> last_{};
    std::size_t length_ = 0;  // corners of this strip so far
};

// What makes up the surface: strips count where there are no faces, beside which they would be the same triangles again.
bool isStrips(const Header& header, const Element& element) {
    return element.name == "tristrips" && header.countOf("face") == 0;
}

template <class Body>
void readBody(Body body, const Header& header, PolygonSoup& soup) {
    for (const Element& element : header.elements) {
        const std::size_t rows = std::min<std::uint64_t>(element.count, body.mostRows(element));
        if (element.name == "vertex") {
            soup.points.reserve(soup.points.size() + rows);
            Point p{};
            readElement(
                body, element,
                [&](const Property& property, double value) {
                    if (property.axis >= 0) p[property.axis] = value;
                },
                [&] { soup.points.push_back(p); });
        } else if (element.name == "face") {
            soup.faceBegin.reserve(soup.faceBegin.size() + rows);
            readElement(
                body, element,
                [&](const Property& property, double value) {
                    if (property.isCorners) soup.corners.push_back(cornerOf(value));
                },
                [&] { soup.endFace(); });
        } else if (isStrips(header, element)) {
            Strips strips(soup);
            readElement(
                body, element,
                [&](const Property& property, double value) {
                    if (property.isCorners) strips.take(value);
                },
                [&] { strips.end(); });
        } else {
            readElement(
                body, element, [](const Property&, double) {}, [] {});
        }
    }
}

Dropped kindOfProperty(std::string_view name) {
    for (const std::string_view colour : {"red", "green", "blue", "alpha", "r", "g", "b", "a", "intensity"})
        if (name == colour || name.ends_with("_" + std::string(colour))) return Dropped::colours;
    for (const std::string_view uv : {"s", "t", "u", "v", "texcoord", "texnumber"})
        if (name == uv || name.ends_with("_" + std::string(uv))) return Dropped::textureCoordinates;
    return name == "nx" || name == "ny" || name == "nz" ? Dropped::normals : Dropped::other;
}

void noteDropped(const Header& header, PolygonSoup& soup) {
    for (const Element& element : header.elements) {
        const bool isVertex = element.name == "vertex",
                   isFace = element.name == "face" || isStrips(header, element);
        if (!isVertex && !isFace && element.count > 0) soup.drop(Dropped::other);
        if (element.count == 0) continue;
        for (const Property& property : element.properties)
            if ((isVertex && property.axis < 0) || (isFace && !property.isCorners))
                soup.drop(kindOfProperty(property.name));
    }
}

bool isFloat64(const Header& header) {
    for (const Element& element : header.elements)
        for (const Property& property : element.properties)
            if (element.name == "vertex" && property.axis == 0) return !property.type->isFloat32();
    return false;
}

std::string headerFor(const MeshView& mesh, bool wide, bool longFaces) {
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : mesh.comments()) header += "comment " + comment + "\n";
    for (const std::string& tag : mesh.tags) header += "comment t " + tag + "\n";
    header += fmt::format("element vertex {}\n", mesh.points.size());
    for (const char axis : {'x', 'y', 'z'})
        header += fmt::format("property {} {}\n", wide ? "double" : "float", axis);
    if (!mesh.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!mesh.distances.empty()) header += "property float distance_to_level0\n";
    // int, as all readers know it, unless indices need the 32nd bit.
    const bool isSigned = !mesh.isPolygons() && mesh.points.size() <= 0x7fffffffu;
    return header + fmt::format("element face {}\nproperty list {} {} vertex_indices\nend_header\n",
                                mesh.faceCount(), longFaces ? "uint" : "uchar", isSigned ? "int" : "uint");
}

}  // namespace

PolygonSoup readPly(std::string_view bytes, const std::string& name) {
    Lines lines(bytes, name, Lines::Break::statement);
    Header header = HeaderReader(lines).read();
    PolygonSoup soup;
    soup.space = spaceIn(bytes.substr(0, bytes.size() - lines.after().size()));
    soup.float32 = !isFloat64(header);
    soup.tags = std::move(header.tags);
    noteDropped(header, soup);
    const bool isText = header.format == "ascii";
    soup.format = isText ? "ASCII PLY" : "binary PLY";
    if (isText)
        readBody(TextBody(lines), header, soup);
    else
        readBody(BinaryBody(lines.after(), header.format == "binary_big_endian", name), header, soup);
    return soup;
}

void writePly(Sink& sink, const MeshView& mesh) {
    bool longFaces = false;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) longFaces = longFaces || mesh.face(f).size() > 255;
    const bool wide = mesh.isPolygons() || needsFloat64(mesh);
    sink.text(headerFor(mesh, wide, longFaces));
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (wide)
            sink.binary(mesh.points[i]);
        else
            sink.binary(toFloat(mesh.points[i]));
        if (!mesh.normals.empty()) sink.binary(mesh.normals[i]);
        if (!mesh.distances.empty()) sink.binary(mesh.distances[i]);
    }
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        if (longFaces)
            sink.binary(static_cast<std::uint32_t>(face.size()));
        else
            sink.binary(static_cast<std::uint8_t>(face.size()));
        sink.text({reinterpret_cast<const char*>(face.data()), face.size_bytes()});
    }
}

}  // namespace isowave
