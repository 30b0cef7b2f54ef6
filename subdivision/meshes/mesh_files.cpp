#include "subdivision/meshes/mesh_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "base/read_file.h"

namespace isowave::subdivision {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

// Takes the next word off the front; empty at the end.
std::string_view takeWord(std::string_view& text) {
    std::size_t begin = 0;
    while (begin < text.size() && isBlank(text[begin])) ++begin;
    std::size_t end = begin;
    while (end < text.size() && !isBlank(text[end])) ++end;
    const auto word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
}

template <class Number>
std::optional<Number> numberIn(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || word.empty()) return std::nullopt;
    return value;
}

// The lines of a text file, and complaints that name them.
class Lines {
  public:
    Lines(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

    bool next(std::string_view& line) {
        if (rest_.empty()) return false;
        const std::size_t end = std::min(rest_.find('\n'), rest_.size());
        line = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        ++number_;
        return true;
    }
    const std::string& name() const { return name_; }
    std::string_view rest() const { return rest_; }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: line {}", name_, number_), what);
    }

    template <class Number>
    Number number(std::string_view word, const char* expected) const {
        const auto value = numberIn<Number>(word);
        if (!value)
            fail(word.empty() ? fmt::format("ends where {} was expected; is the file truncated?", expected)
                              : fmt::format("'{}' is not {}", word, expected));
        return *value;
    }
    Vec3 point(std::string_view& line) const {
        Vec3 p;
        for (double* at : {&p.x, &p.y, &p.z}) *at = number<double>(takeWord(line), "a coordinate");
        return p;
    }

  private:
    std::string_view rest_;
    std::string name_;
    std::size_t number_ = 0;
};

// What follows `t `: a crease, a pinned vertex, or something else that is passed over.
void readTag(std::string_view text, const Lines& lines, PolygonMesh& mesh) {
    const auto kind = takeWord(text);
    const bool crease = kind == "crease";
    if (!crease && kind != "corner") return;
    const std::string_view counts = crease ? "2/1/0" : "1/1/0";
    if (const auto word = takeWord(text); word != counts)
        lines.fail(fmt::format("'t {} {}' does not count its values as {}", kind, word, counts));
    const auto vertex = [&] {
        return lines.number<Index>(takeWord(text), "a vertex number, counted from 0");
    };
    const Index a = vertex(), b = crease ? vertex() : a;
    const double sharpness = lines.number<double>(takeWord(text), "a sharpness");
    if (!(sharpness > 0)) return;  // 0: smooth
    if (crease)
        mesh.creases.push_back({a, b, sharpness});
    else
        mesh.pinned.push_back(a);
}

std::vector<std::string> tags(const PolygonMesh& mesh) {
    std::vector<std::string> lines;
    for (const Crease& c : mesh.creases)
        lines.push_back(fmt::format("t crease 2/1/0 {} {} {}", c.a, c.b, c.sharpness));
    for (const Index v : mesh.pinned) lines.push_back(fmt::format("t corner 1/1/0 {} 10", v));
    return lines;
}

// A comment that holds a tag.
void readComment(std::string_view text, const Lines& lines, PolygonMesh& mesh) {
    if (takeWord(text) == "t") readTag(text, lines, mesh);
}

// ---- OBJ ----

// "7/1/3" or "-2" -> the vertex from 0. `count`: vertices so far, which negative numbers count back from.
Index objVertex(std::string_view word, std::size_t count, const Lines& lines) {
    const auto text = word.substr(0, word.find('/'));
    const auto number = numberIn<std::int64_t>(text);
    if (!number || *number == 0)
        lines.fail(fmt::format("'{}' is no vertex of a face; they are counted from 1", word));
    const std::int64_t index = *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
    if (index < 0 || index >= kNone)
        lines.fail(fmt::format("'{}' refers to a vertex before the first; there are {} so far", word, count));
    return static_cast<Index>(index);
}

PolygonMesh parseObj(std::string_view text, const std::string& name) {
    PolygonMesh mesh;
    Lines lines(text, name);
    std::vector<Index> face;
    for (std::string_view line; lines.next(line);) {
        const auto key = takeWord(line);
        if (key == "v") {
            mesh.points.push_back(lines.point(line));
        } else if (key == "f") {
            face.clear();
            for (auto word = takeWord(line); !word.empty() && word[0] != '#'; word = takeWord(line))
                face.push_back(objVertex(word, mesh.points.size(), lines));
            mesh.addFace(face);
        } else if (key == "t") {
            readTag(line, lines, mesh);
        }
    }
    return mesh;
}

std::string objBytes(const PolygonMesh& mesh) {
    fmt::memory_buffer out;
    for (const Vec3& p : mesh.points) fmt::format_to(fmt::appender(out), "v {} {} {}\n", p.x, p.y, p.z);
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        out.push_back('f');
        for (const Index v : mesh.face(f)) fmt::format_to(fmt::appender(out), " {}", std::uint64_t{v} + 1);
        out.push_back('\n');
    }
    for (const auto& tag : tags(mesh)) fmt::format_to(fmt::appender(out), "{}\n", tag);
    return fmt::to_string(out);
}

// ---- OFF: OFF, COFF, NOFF, CNOFF: what follows a vertex's three numbers on its line is passed over ----

// The next line that holds something, without its comment.
std::string_view offLine(Lines& lines, PolygonMesh& mesh, const char* expected) {
    for (std::string_view line; lines.next(line);) {
        const std::size_t hash = std::min(line.find('#'), line.size());
        if (hash < line.size()) readComment(line.substr(hash + 1), lines, mesh);
        line = line.substr(0, hash);
        if (auto probe = line; !takeWord(probe).empty()) return line;
    }
    throw InputError(lines.name(), fmt::format("ends where {} was expected; it is truncated", expected));
}

PolygonMesh parseOff(std::string_view text, const std::string& name) {
    PolygonMesh mesh;
    Lines lines(text, name);
    auto line = offLine(lines, mesh, "'OFF'");
    auto probe = line;
    if (!takeWord(probe).ends_with("OFF")) lines.fail("does not start with OFF; it is no OFF file");
    if (takeWord(probe).empty())
        line = offLine(lines, mesh, "the counts");
    else
        takeWord(line);  // the counts follow on the same line
    const auto vertices = lines.number<Index>(takeWord(line), "the number of vertices");
    const auto faces = lines.number<Index>(takeWord(line), "the number of faces");
    for (Index v = 0; v < vertices; ++v) {
        line = offLine(lines, mesh, "a vertex");
        mesh.points.push_back(lines.point(line));
    }
    std::vector<Index> face;
    for (Index f = 0; f < faces; ++f) {
        line = offLine(lines, mesh, "a face");
        const auto size = lines.number<Index>(takeWord(line), "the number of a face's vertices");
        face.clear();
        for (Index k = 0; k < size; ++k)
            face.push_back(lines.number<Index>(takeWord(line), "a vertex of a face"));
        mesh.addFace(face);
    }
    for (std::string_view rest; lines.next(rest);)
        if (const auto hash = rest.find('#'); hash != rest.npos)
            readComment(rest.substr(hash + 1), lines, mesh);
    return mesh;
}

std::string offBytes(const PolygonMesh& mesh) {
    fmt::memory_buffer out;
    fmt::format_to(fmt::appender(out), "OFF\n{} {} 0\n", mesh.vertexCount(), mesh.faceCount());
    for (const Vec3& p : mesh.points) fmt::format_to(fmt::appender(out), "{} {} {}\n", p.x, p.y, p.z);
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
        fmt::format_to(fmt::appender(out), "{} {}\n", mesh.faceSize(f), fmt::join(mesh.face(f), " "));
    for (const auto& tag : tags(mesh)) fmt::format_to(fmt::appender(out), "# {}\n", tag);
    return fmt::to_string(out);
}

// ---- PLY ----

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
struct PlyTypeName {
    std::string_view names[2];
    PlyType type;
    std::size_t size;
};
constexpr PlyTypeName kPlyTypes[] = {
    {{"char", "int8"}, PlyType::i8, 1},      {{"uchar", "uint8"}, PlyType::u8, 1},
    {{"short", "int16"}, PlyType::i16, 2},   {{"ushort", "uint16"}, PlyType::u16, 2},
    {{"int", "int32"}, PlyType::i32, 4},     {{"uint", "uint32"}, PlyType::u32, 4},
    {{"float", "float32"}, PlyType::f32, 4}, {{"double", "float64"}, PlyType::f64, 8},
};

struct PlyProperty {
    std::string name;
    const PlyTypeName* type = nullptr;
    const PlyTypeName* count = nullptr;  // of a list: the type of its length
};
struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};
struct PlyHeader {
    bool ascii = true, swap = false;
    std::vector<PlyElement> elements;
};

const PlyTypeName* plyType(std::string_view word, const Lines& lines) {
    for (const auto& type : kPlyTypes)
        if (word == type.names[0] || word == type.names[1]) return &type;
    lines.fail(fmt::format("'{}' is no type of PLY", word));
}

void readPlyFormat(std::string_view line, const Lines& lines, PlyHeader& header) {
    const auto format = takeWord(line);
    header.ascii = format == "ascii";
    const bool big = format == "binary_big_endian";
    if (!header.ascii && !big && format != "binary_little_endian")
        lines.fail(
            fmt::format("format '{}' is not ascii, binary_little_endian or binary_big_endian", format));
    header.swap = !header.ascii && big != (std::endian::native == std::endian::big);
}

void readPlyProperty(std::string_view line, const Lines& lines, PlyHeader& header) {
    if (header.elements.empty()) lines.fail("a property stands before the first element");
    PlyProperty property;
    auto word = takeWord(line);
    if (word == "list") {
        property.count = plyType(takeWord(line), lines);
        word = takeWord(line);
    }
    property.type = plyType(word, lines);
    property.name = takeWord(line);
    header.elements.back().properties.push_back(property);
}

PlyHeader readPlyHeader(Lines& lines, PolygonMesh& mesh) {
    PlyHeader header;
    std::string_view line;
    if (!lines.next(line) || takeWord(line) != "ply")
        throw InputError(lines.name(), "does not start with 'ply'");
    while (lines.next(line)) {
        const auto key = takeWord(line);
        if (key == "end_header") return header;
        if (key == "format") readPlyFormat(line, lines, header);
        if (key == "comment") readComment(line, lines, mesh);
        if (key == "property") readPlyProperty(line, lines, header);
        if (key == "element") {
            const std::string name(takeWord(line));
            header.elements.push_back(
                {name, lines.number<std::uint64_t>(takeWord(line), "the number of elements"), {}});
        }
    }
    throw InputError(lines.name(), "ends inside its header; it is truncated");
}

// The body, value by value.
class PlyBody {
  public:
    PlyBody(std::string_view bytes, const PlyHeader& header, std::string name)
        : rest_(bytes), total_(bytes.size()), header_(header), name_(std::move(name)) {}

    double value(const PlyTypeName& type, const PlyElement& element, std::uint64_t row) {
        if (header_.ascii) {
            const auto word = takeWord(rest_);
            if (word.empty()) truncated(element, row);
            const auto number = numberIn<double>(word);
            if (!number) fail(element, row, fmt::format("'{}' is not a number", word));
            return *number;
        }
        if (rest_.size() < type.size) truncated(element, row);
        char bytes[8];
        for (std::size_t k = 0; k < type.size; ++k) bytes[k] = rest_[header_.swap ? type.size - 1 - k : k];
        rest_.remove_prefix(type.size);
        switch (type.type) {
            case PlyType::i8:
                return as<std::int8_t>(bytes);
            case PlyType::u8:
                return as<std::uint8_t>(bytes);
            case PlyType::i16:
                return as<std::int16_t>(bytes);
            case PlyType::u16:
                return as<std::uint16_t>(bytes);
            case PlyType::i32:
                return as<std::int32_t>(bytes);
            case PlyType::u32:
                return as<std::uint32_t>(bytes);
            case PlyType::f32:
                return as<float>(bytes);
            case PlyType::f64:
                return as<double>(bytes);
        }
        return 0;
    }
    // A number of things, or of one: whole, from 0, below 2^32 - 1.
    Index index(const PlyTypeName& type, const PlyElement& element, std::uint64_t row) {
        const double number = value(type, element, row);
        if (!(number >= 0 && number < kNone) || number != std::floor(number))
            fail(element, row, fmt::format("{} is no vertex number or length of a list", number));
        return static_cast<Index>(number);
    }
    [[noreturn]] void fail(const PlyElement& element, std::uint64_t row, const std::string& what) const {
        throw InputError(fmt::format("{}: {} {} of {}", name_, element.name, row, element.count), what);
    }

  private:
    template <class T>
    static double as(const char* bytes) {
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return static_cast<double>(value);
    }
    [[noreturn]] void truncated(const PlyElement& element, std::uint64_t row) const {
        fail(element, row,
             fmt::format("the file ends here, after {} bytes of data; it is truncated", total_));
    }

    std::string_view rest_;
    std::size_t total_;
    const PlyHeader& header_;
    std::string name_;
};

void readPlyVertices(PlyBody& body, const PlyElement& element, PolygonMesh& mesh) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
        Vec3 p;
        for (const auto& property : element.properties) {
            const Index repeat = property.count ? body.index(*property.count, element, row) : 1;
            double value = 0;
            for (Index k = 0; k < repeat; ++k) value = body.value(*property.type, element, row);
            if (property.name == "x") p.x = value;
            if (property.name == "y") p.y = value;
            if (property.name == "z") p.z = value;
        }
        mesh.points.push_back(p);
    }
}

bool isFaceList(const PlyProperty& property) {
    return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void readPlyFaces(PlyBody& body, const PlyElement& element, PolygonMesh& mesh) {
    std::vector<Index> face;
    for (std::uint64_t row = 0; row < element.count; ++row) {
        for (const auto& property : element.properties) {
            const Index repeat = property.count ? body.index(*property.count, element, row) : 1;
            face.clear();
            for (Index k = 0; k < repeat; ++k) {
                if (isFaceList(property))
                    face.push_back(body.index(*property.type, element, row));
                else
                    body.value(*property.type, element, row);
            }
            if (isFaceList(property)) mesh.addFace(face);
        }
    }
}

void skipPlyElement(PlyBody& body, const PlyElement& element) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
        for (const auto& property : element.properties) {
            const Index repeat = property.count ? body.index(*property.count, element, row) : 1;
            for (Index k = 0; k < repeat; ++k) body.value(*property.type, element, row);
        }
    }
}

PolygonMesh parsePly(std::string_view bytes, const std::string& name) {
    PolygonMesh mesh;
    Lines lines(bytes, name);
    const PlyHeader header = readPlyHeader(lines, mesh);
    PlyBody body(lines.rest(), header, name);
    for (const PlyElement& element : header.elements) {
        const auto& properties = element.properties;
        const auto has = [&](std::string_view property) {
            return std::any_of(properties.begin(), properties.end(),
                               [&](const PlyProperty& p) { return p.name == property; });
        };
        if (element.name == "vertex") {
            if (!has("x") || !has("y") || !has("z")) throw InputError(name, "its vertices have no x, y, z");
            readPlyVertices(body, element, mesh);
        } else if (element.name == "face") {
            if (std::none_of(properties.begin(), properties.end(), isFaceList))
                throw InputError(name, "its faces have no list 'vertex_indices'");
            readPlyFaces(body, element, mesh);
        } else {
            skipPlyElement(body, element);
        }
    }
    return mesh;
}

template <class T>
void append(std::string& bytes, T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof value);
    bytes.append(raw, sizeof value);
}

std::string plyBytes(const PolygonMesh& mesh) {
    std::size_t largest = 0;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) largest = std::max(largest, mesh.faceSize(f));
    const bool small = largest < 256;
    std::string bytes = "ply\nformat binary_little_endian 1.0\n";
    for (const auto& tag : tags(mesh)) bytes += fmt::format("comment {}\n", tag);
    bytes += fmt::format(
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list {} uint vertex_indices\nend_header\n",
        mesh.vertexCount(), mesh.faceCount(), small ? "uchar" : "uint");
    bytes.reserve(bytes.size() + 24 * mesh.vertexCount() + 5 * mesh.corners.size());
    for (const Vec3& p : mesh.points)
        for (const double value : {p.x, p.y, p.z}) append(bytes, value);
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        if (small)
            append(bytes, static_cast<std::uint8_t>(mesh.faceSize(f)));
        else
            append(bytes, static_cast<std::uint32_t>(mesh.faceSize(f)));
        for (const Index v : mesh.face(f)) append(bytes, v);
    }
    return bytes;
}

constexpr std::pair<std::string_view, PolygonFormat> kFormats[] = {
    {".obj", PolygonFormat::obj}, {".off", PolygonFormat::off}, {".ply", PolygonFormat::ply}};

}  // namespace

PolygonFormat polygonFormatOf(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const auto& [known, format] : kFormats)
        if (extension == known) return format;
    throw InputError(path.string(),
                     fmt::format("'{}' is no kind of polygon mesh; they are .obj .off .ply", extension));
}

PolygonMesh readPolygonMesh(const std::filesystem::path& path) {
    const PolygonFormat format = polygonFormatOf(path);
    return parsePolygonMesh(readFile(path, "a mesh file"), format, path.string());
}

PolygonMesh parsePolygonMesh(std::string_view bytes, PolygonFormat format, const std::string& name) {
    switch (format) {
        case PolygonFormat::obj:
            return parseObj(bytes, name);
        case PolygonFormat::off:
            return parseOff(bytes, name);
        case PolygonFormat::ply:
            break;
    }
    return parsePly(bytes, name);
}

std::string polygonMeshBytes(const PolygonMesh& mesh, PolygonFormat format) {
    switch (format) {
        case PolygonFormat::obj:
            return objBytes(mesh);
        case PolygonFormat::off:
            return offBytes(mesh);
        case PolygonFormat::ply:
            break;
    }
    return plyBytes(mesh);
}

void writePolygonMesh(const std::filesystem::path& path, const PolygonMesh& mesh) {
    const std::string bytes = polygonMeshBytes(mesh, polygonFormatOf(path));
    AtomicFile file(path);
    try {
        file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    } catch (const std::ios_base::failure&) {
        throw OperationError(path.string(), "writing failed; is the disk full? Nothing was left behind");
    }
    file.commit();
}

}  // namespace isowave::subdivision
