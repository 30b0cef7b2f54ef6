#include "subdivision/meshes/mesh_files.h"

#include <fmt/format.h>

#include "base/read_file.h"
#include "io/mesh/lines.h"
#include "io/mesh/read.h"
#include "io/mesh/write.h"
#include "isowave/error.h"

namespace isowave::subdivision {
namespace {

// A tag's word as a number. Throws InputError with its line.
template <class Number>
Number numberOf(Lines& tag, std::size_t line, const char* expected) {
    const std::string_view word = tag.word();
    const auto value = numberIn<Number>(word);
    if (!value)
        tag.failAt(line, word.empty()
                             ? fmt::format("ends where {} was expected; is the file truncated?", expected)
                             : fmt::format("'{}' is not {}", shown(word), expected));
    return *value;
}

// A crease, a pinned vertex, or something else that is passed over.
void takeTag(const MeshTag& tag, const std::string& name, PolygonMesh& mesh) {
    Lines words(tag.text, name, Lines::Break::blank);
    const auto kind = words.word();
    const bool crease = kind == "crease";
    if (!crease && kind != "corner") return;
    const std::string_view counts = crease ? "2/1/0" : "1/1/0";
    if (const auto word = words.word(); word != counts)
        words.failAt(tag.line,
                     fmt::format("'t {} {}' does not count its values as {}", kind, shown(word), counts));
    const auto vertex = [&] { return numberOf<Index>(words, tag.line, "a vertex number, counted from 0"); };
    const Index a = vertex(), b = crease ? vertex() : a;
    const double sharpness = numberOf<double>(words, tag.line, "a sharpness");
    if (!(sharpness > 0)) return;  // 0: smooth
    if (crease)
        mesh.creases.push_back({a, b, sharpness});
    else
        mesh.pinned.push_back(a);
}

std::vector<std::string> tagsOf(const PolygonMesh& mesh) {
    std::vector<std::string> tags;
    for (const Crease& c : mesh.creases)
        tags.push_back(fmt::format("crease 2/1/0 {} {} {}", c.a, c.b, c.sharpness));
    for (const Index v : mesh.pinned) tags.push_back(fmt::format("corner 1/1/0 {} 10", v));
    return tags;
}

void print(Sink& sink, const PolygonMesh& mesh, MeshFormat format, const std::filesystem::path& path) {
    std::vector<Point> points;
    points.reserve(mesh.vertexCount());
    for (const Vec3& p : mesh.points) points.push_back({p.x, p.y, p.z});
    MeshView view;
    view.points = points;
    view.corners = mesh.corners;
    view.faceBegin = mesh.faceBegin;
    view.tags = tagsOf(mesh);
    printMesh(sink, view, format, path);
}

}  // namespace

MeshFormat polygonFormatOf(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    for (const MeshFormat format : {MeshFormat::obj, MeshFormat::off, MeshFormat::ply})
        if (extension == extensionOf(format)) return format;
    throw InputError(path.string(),
                     fmt::format("'{}' is no kind of polygon mesh; they are .obj .off .ply", extension));
}

PolygonMesh readPolygonMesh(const std::filesystem::path& path) {
    const MeshFormat format = polygonFormatOf(path);
    return parsePolygonMesh(readFile(path, "a mesh file"), format, path.string());
}

PolygonMesh parsePolygonMesh(std::string_view bytes, MeshFormat format, const std::string& name) {
    PolygonSoup soup = parseMesh(bytes, format, name);
    PolygonMesh mesh;
    mesh.points.reserve(soup.points.size());
    for (const Point& p : soup.points) mesh.points.push_back({p[0], p[1], p[2]});
    mesh.corners = std::move(soup.corners);
    mesh.faceBegin = std::move(soup.faceBegin);
    for (const MeshTag& tag : soup.tags) takeTag(tag, name, mesh);
    return mesh;
}

std::string polygonMeshBytes(const PolygonMesh& mesh, MeshFormat format) {
    Sink sink;
    print(sink, mesh, format, {});
    return sink.take();
}

void writePolygonMesh(const std::filesystem::path& path, const PolygonMesh& mesh) {
    const MeshFormat format = polygonFormatOf(path);
    Sink sink(path);
    print(sink, mesh, format, path);
    sink.finish();
}

}  // namespace isowave::subdivision
