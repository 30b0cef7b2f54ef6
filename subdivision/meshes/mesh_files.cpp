#include "subdivision/meshes/mesh_files.h"

#include <fmt/format.h>

#include "base/inflate.h"
#include "base/number_text.h"
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

// Returns how many vertices went. Those that a crease or a corner names stay, and so does a face's corner that names no
// vertex: they are complained about by requireManifold().
std::size_t leaveOutUnused(PolygonMesh& mesh) {
    std::vector<bool> used(mesh.points.size());
    const auto use = [&](Index v) {
        if (v < used.size()) used[v] = true;
    };
    for (const Index v : mesh.corners) use(v);
    for (const Crease& c : mesh.creases) use(c.a), use(c.b);
    for (const Index v : mesh.pinned) use(v);
    std::vector<Index> number(used.size());
    Index count = 0;
    for (std::size_t v = 0; v < used.size(); ++v) {
        number[v] = count;
        if (used[v]) mesh.points[count++] = mesh.points[v];
    }
    const std::size_t left = used.size() - count;
    if (left == 0) return 0;
    mesh.points.resize(count);
    const auto renumber = [&](Index& v) { v = v < number.size() ? number[v] : v - static_cast<Index>(left); };
    for (Index& v : mesh.corners) renumber(v);
    for (Crease& c : mesh.creases) renumber(c.a), renumber(c.b);
    for (Index& v : mesh.pinned) renumber(v);
    return left;
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
    if (const std::string advice = adviceFor(path); !advice.empty()) throw InputError(path.string(), advice);
    throw InputError(path.string(),
                     fmt::format("'{}' is no kind of polygon mesh; they are .obj .off .ply", extension));
}

PolygonMesh readPolygonMesh(const std::filesystem::path& path, std::vector<std::string>* remarks) {
    const MeshFormat format = polygonFormatOf(withoutGz(path));
    return parsePolygonMesh(readInflatedFile(path, "a mesh file"), format, path.string(), remarks);
}

PolygonMesh parsePolygonMesh(std::string_view bytes, MeshFormat format, const std::string& name,
                             std::vector<std::string>* remarks) {
    PolygonSoup soup = parseMesh(bytes, format, name);
    if (const std::string note = soup.droppedNote(); remarks && !note.empty())
        remarks->push_back(name + ": " + note);
    PolygonMesh mesh;
    mesh.points.reserve(soup.points.size());
    for (const Point& p : soup.points) mesh.points.push_back({p[0], p[1], p[2]});
    mesh.corners = std::move(soup.corners);
    mesh.faceBegin = std::move(soup.faceBegin);
    for (const MeshTag& tag : soup.tags) takeTag(tag, name, mesh);
    const std::size_t unused = leaveOutUnused(mesh);
    if (remarks && unused > 0)
        remarks->push_back(fmt::format("{}: {} in no face left out", name,
                                       counted(static_cast<std::int64_t>(unused), "vertex", "vertices")));
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
