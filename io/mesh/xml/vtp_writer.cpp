#include "io/mesh/xml/vtp_writer.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <string>

#include "io/mesh/float32.h"

namespace isowave {
namespace {

// How the numbers of a file are stored.
struct Widths {
    bool wideCoordinates = false, wideIndices = false;

    std::size_t point() const { return wideCoordinates ? sizeof(Point) : sizeof(FloatPoint); }
    std::size_t index() const { return wideIndices ? sizeof(std::int64_t) : sizeof(std::int32_t); }
    const char* coordinateType() const { return wideCoordinates ? "Float64" : "Float32"; }
    const char* indexType() const { return wideIndices ? "Int64" : "Int32"; }
};

std::size_t cornerCount(const MeshView& mesh) {
    return mesh.isPolygons() ? mesh.corners.size() : 3 * mesh.triangles.size();
}

// The elements of arrays that are appended one after another, each with its length in bytes before it.
class AppendedArrays {
  public:
    std::string element(const char* type, const char* name, std::size_t bytes, int components = 1) {
        std::string text = fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
            "offset=\"{}\"/>\n",
            type, name, components, offset_);
        offset_ += sizeof(std::uint64_t) + bytes;
        return text;
    }

  private:
    std::size_t offset_ = 0;
};

std::string pointData(const MeshView& mesh, AppendedArrays& arrays) {
    std::string active, elements;
    if (!mesh.distances.empty()) {
        active += " Scalars=\"distance_to_level0\"";
        elements += arrays.element("Float32", "distance_to_level0", mesh.distances.size_bytes());
    }
    if (!mesh.normals.empty()) {
        active += " Normals=\"normals\"";
        elements += arrays.element("Float32", "normals", mesh.normals.size_bytes(), 3);
    }
    return "<PointData" + active + ">\n" + elements + "</PointData>\n";
}

std::string headerFor(const MeshView& mesh, const Widths& widths) {
    AppendedArrays arrays;
    std::string header = "<?xml version=\"1.0\"?>\n";
    for (const std::string& comment : mesh.comments()) header += "<!-- " + comment + " -->\n";
    header += fmt::format(
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"{}\">\n",
        mesh.points.size(), mesh.faceCount());
    header += pointData(mesh, arrays) + "<Points>\n";
    header += arrays.element(widths.coordinateType(), "Points", widths.point() * mesh.points.size(), 3);
    header += "</Points>\n<Polys>\n";
    header += arrays.element(widths.indexType(), "connectivity", widths.index() * cornerCount(mesh));
    header += arrays.element(widths.indexType(), "offsets", widths.index() * mesh.faceCount());
    return header + "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
}

// The same arrays in the same order.
class Body {
  public:
    Body(Sink& sink, const MeshView& mesh, const Widths& widths)
        : sink_(sink), mesh_(mesh), widths_(widths) {}

    void write() {
        if (!mesh_.distances.empty()) array(mesh_.distances);
        if (!mesh_.normals.empty()) array(mesh_.normals);
        length(widths_.point() * mesh_.points.size());
        for (const Point& p : mesh_.points)
            widths_.wideCoordinates ? sink_.binary(p) : sink_.binary(toFloat(p));
        length(widths_.index() * cornerCount(mesh_));
        for (std::size_t f = 0; f < mesh_.faceCount(); ++f)
            for (const std::uint32_t corner : mesh_.face(f)) index(corner);
        length(widths_.index() * mesh_.faceCount());
        std::size_t end = 0;
        for (std::size_t f = 0; f < mesh_.faceCount(); ++f) index(end += mesh_.face(f).size());
    }

  private:
    void length(std::uint64_t bytes) { sink_.binary(bytes); }
    template <class T>
    void array(std::span<const T> values) {
        length(values.size_bytes());
        sink_.text({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    }
    void index(std::size_t value) {
        if (widths_.wideIndices)
            sink_.binary(static_cast<std::int64_t>(value));
        else
            sink_.binary(static_cast<std::int32_t>(value));
    }

    Sink& sink_;
    const MeshView& mesh_;
    Widths widths_;
};

}  // namespace

void writeVtp(Sink& sink, const MeshView& mesh) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
    const Widths widths{.wideCoordinates = mesh.isPolygons() || needsFloat64(mesh),
                        .wideIndices = cornerCount(mesh) > kMost || mesh.points.size() > kMost};
    sink.text(headerFor(mesh, widths));
    Body(sink, mesh, widths).write();
    sink.text("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace isowave
