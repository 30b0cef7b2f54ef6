#include "io/mesh/tiles/draco_bytes.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include "isowave/error.h"

namespace isowave {

std::string dracoBytes(std::span<const std::array<std::int32_t, 3>> points,
                       std::span<const Triangle> triangles) {
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<std::uint32_t>(points.size()));
    draco::GeometryAttribute position;
    position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false,
                  3 * sizeof(std::int32_t), 0);
    draco::PointAttribute* const values =
        mesh.attribute(mesh.AddAttribute(position, /*identity_mapping*/ true, mesh.num_points()));
    for (std::uint32_t i = 0; i < points.size(); ++i)
        values->SetAttributeValue(draco::AttributeValueIndex(i), points[i].data());
    mesh.SetNumFaces(triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const Triangle& corners = triangles[t];
        mesh.SetFace(draco::FaceIndex(t), {draco::PointIndex(corners[0]), draco::PointIndex(corners[1]),
                                           draco::PointIndex(corners[2])});
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer);
    if (!status.ok()) throw OperationError("Draco", "cannot pack a tile (" + status.error_msg_string() + ")");
    return {buffer.data(), buffer.size()};
}

}  // namespace isowave
