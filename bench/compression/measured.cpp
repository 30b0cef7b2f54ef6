#include "measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compress/coder/mask_coder.h"
#include "polygonize/polygonize.h"

namespace isowave::bench {
namespace {

constexpr int kBisections = 10;

std::string topologyText(const MeshTopology& before, const MeshTopology& after) {
    const auto text = [](std::int64_t a, std::int64_t b) {
        return a == b ? fmt::format("{}", a) : fmt::format("{} for {}", a, b);
    };
    if (after.parts == before.parts && after.genus == before.genus && after.cavities == before.cavities)
        return "same";
    return fmt::format("{} parts, {} handles, {} cavities", text(after.parts, before.parts),
                       text(after.genus, before.genus), text(after.cavities, before.cavities));
}

}  // namespace

Original::Original(std::string name, BSplineField field, double halfWidth)
    : name_(std::move(name)),
      field_(std::move(field)),
      points_(compress::fieldPointsOf(field_, name_, {})),
      voxelsPerK_(halfWidth),
      mesh_(polygonize(field_)),
      topology_(topologyOf(mesh_)),
      voxel_(field_.transform().voxelSize().x()),
      maskBytes_(static_cast<std::int64_t>(compress::encodeNodes(points_.nodes).size())) {}

double Original::changeOf(const Values& values) const {
    return voxelsPerK_ * compress::changeNear(points_.lattice, points_.c, values,
                                              static_cast<float>(points_.K), points_.inside)
                             .largest;
}

// Signs are those that F has: a rival keeps none.
TriangleMesh Original::meshOf(const Values& values) const {
    FieldPoints points = points_;
    points.c = values;
    const Values F = compress::latticeValues(points.lattice, values, static_cast<float>(points.K), nullptr);
    std::transform(F.begin(), F.end(), points.inside.begin(), [](float f) { return f < 0; });
    return polygonize(compress::fieldOf(points));
}

void Original::judge(const TriangleMesh& mesh, Coded& coded) const {
    if (mesh.points == mesh_.points && mesh.triangles == mesh_.triangles) {
        coded.topology = "same triangles";
        return;
    }
    constexpr double kNoProof = 1e30;  // the largest distance found will do
    const MeshComparison comparison = compareMeshes(mesh_, mesh, 0, {}, kNoProof);
    coded.rms = comparison.rms / voxel_;
    coded.max = comparison.max / voxel_;
    coded.topology =
        mesh.triangles == mesh_.triangles ? "same triangles" : topologyText(topology_, topologyOf(mesh));
}

Coded Original::measured(const FieldRival& rival, double parameter) const {
    Coded coded{.coder = rival.name};
    std::string bytes;
    Values values;
    coded.write = secondsOf([&] { bytes = rival.encode(parameter); });
    coded.read = secondsOf([&] { values = rival.decode(bytes, parameter); });
    coded.bytes = static_cast<std::int64_t>(bytes.size()) + (rival.mask ? maskBytes_ : 0);
    coded.change = changeOf(values);
    judge(meshOf(values), coded);
    return coded;
}

Coded Original::within(const FieldRival& rival, double bound) const {
    const auto trial = [&](double p) {
        return rival.trial ? rival.trial(p) : rival.decode(rival.encode(p), p);
    };
    double low = bound / voxelsPerK_ / 4, high = bound / voxelsPerK_ * 16;
    for (int i = 0; i < kBisections; ++i) {
        const double middle = std::sqrt(low * high);
        (changeOf(trial(middle)) <= bound ? low : high) = middle;
    }
    Coded coded = measured(rival, low);
    coded.bound = bound;
    return coded;
}

}  // namespace isowave::bench
