#include "draco_rival.h"

#include <stdexcept>

#ifdef ISOWAVE_WITH_DRACO

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

namespace isowave::bench {
namespace {

int addPositions(draco::Mesh& to, const TriangleMesh& mesh) {
    draco::GeometryAttribute position;
    position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float),
                  0);
    const int id = to.AddAttribute(position, true, static_cast<std::uint32_t>(mesh.points.size()));
    for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
        const Point& p = mesh.points[i];
        const std::array<float, 3> value{static_cast<float>(p[0]), static_cast<float>(p[1]),
                                         static_cast<float>(p[2])};
        to.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), value.data());
    }
    return id;
}

void require(const draco::Status& status) {
    if (!status.ok()) throw std::runtime_error("Draco: " + status.error_msg_string());
}

}  // namespace

bool hasDraco() { return true; }

std::string dracoBytes(const TriangleMesh& mesh, int bits) {
    draco::Mesh copy;
    copy.set_num_points(static_cast<std::uint32_t>(mesh.points.size()));
    addPositions(copy, mesh);
    for (const Triangle& t : mesh.triangles)
        copy.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
    draco::Encoder encoder;
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
    encoder.SetSpeedOptions(0, 0);
    draco::EncoderBuffer buffer;
    require(encoder.EncodeMeshToBuffer(copy, &buffer));
    return {buffer.data(), buffer.size()};
}

TriangleMesh meshOfDraco(std::string_view bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    require(decoded.status());
    const draco::Mesh& mesh = *decoded.value();
    const draco::PointAttribute& position = *mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    TriangleMesh result;
    for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
        std::array<float, 3> p;
        position.GetMappedValue(i, p.data());
        result.points.push_back({p[0], p[1], p[2]});
    }
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
        const auto& face = mesh.face(f);
        result.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
    return result;
}

}  // namespace isowave::bench

#else

namespace isowave::bench {

bool hasDraco() { return false; }
std::string dracoBytes(const TriangleMesh&, int) { throw std::runtime_error("Draco is not installed"); }
TriangleMesh meshOfDraco(std::string_view) { throw std::runtime_error("Draco is not installed"); }

}  // namespace isowave::bench

#endif
