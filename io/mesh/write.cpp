#include "io/mesh/write.h"

#include <algorithm>
#include <cassert>

#include "io/mesh/glb.h"
#include "io/mesh/lines.h"
#include "io/mesh/obj.h"
#include "io/mesh/off.h"
#include "io/mesh/place.h"
#include "io/mesh/ply.h"
#include "io/mesh/stl.h"
#include "io/mesh/xml/three_mf_writer.h"
#include "io/mesh/xml/vtp_writer.h"
#include "isowave/error.h"

namespace isowave {
namespace {

constexpr MeshFormatName kNames[] = {{MeshFormat::stl, ".stl"},    {MeshFormat::ply, ".ply"},
                                     {MeshFormat::obj, ".obj"},    {MeshFormat::off, ".off"},
                                     {MeshFormat::glb, ".glb"},    {MeshFormat::vtp, ".vtp"},
                                     {MeshFormat::threeMf, ".3mf"}};

// "stl, ply or obj"; skip: characters of the extension.
std::string allFormats(std::size_t skip) {
    std::string all;
    for (const MeshFormatName& format : kNames) {
        if (!all.empty()) all += &format == std::end(kNames) - 1 ? " or " : ", ";
        all += format.extension + skip;
    }
    return all;
}

}  // namespace

MeshFormat meshFormatFromName(const std::string& name) {
    for (const auto& [format, extension] : kNames)
        if (lowerCase(name) == extension + 1) return format;
    throw InputError("'" + name + "'", "not a mesh format that isowave writes; expected " + allFormats(1));
}

MeshFormat meshFormatOf(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    for (const auto& [format, known] : kNames)
        if (extension == known) return format;
    throw InputError(path.string(), (extension.empty() ? "no extension" : "extension '" + extension + "'") +
                                        "; expected " + allFormats(0));
}

const char* extensionOf(MeshFormat format) {
    return std::find_if(std::begin(kNames), std::end(kNames),
                        [&](const MeshFormatName& name) { return name.format == format; })
        ->extension;
}

std::span<const MeshFormatName> meshFormatNames() { return kNames; }

void printMesh(Sink& sink, const MeshView& mesh, MeshFormat format, const std::filesystem::path& path) {
    switch (format) {
        case MeshFormat::stl:
            return writeStl(sink, mesh, path.string());
        case MeshFormat::ply:
            return writePly(sink, mesh);
        case MeshFormat::obj:
            return writeObj(sink, mesh);
        case MeshFormat::off:
            return writeOff(sink, mesh);
        case MeshFormat::glb:
            return writeGlb(sink, mesh, path.string(), path.stem().string());
        case MeshFormat::vtp:
            return writeVtp(sink, mesh);
        case MeshFormat::threeMf:
            return writeThreeMf(sink, mesh, path.string(), path.stem().string());
    }
}

void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format,
               const MeshWriteOptions& options) {
    assert(mesh.normals.empty() || mesh.normals.size() == mesh.points.size());
    assert(options.distanceToLevel0.empty() || options.distanceToLevel0.size() == mesh.points.size());
    TriangleMesh placed{mesh.points, {}, mesh.normals};
    placeFor(format, options, placed);
    MeshView view;
    view.points = placed.points;
    view.normals = placed.normals;
    view.triangles = mesh.triangles;
    view.space = options.space;
    view.distances = options.distanceToLevel0;
    view.distanceRange = options.distanceRange;
    view.metresPerUnit = options.metresPerUnit;
    Sink sink(path);
    printMesh(sink, view, format, path);
    sink.finish();
}

}  // namespace isowave
