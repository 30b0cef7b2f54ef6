#include "polygonize/clip.h"

#include <cmath>
#include <unordered_map>

namespace isowave {
namespace {

// One face of the box after another. height > 0 is the side that stays; a vertex at height 0 stays.
class HalfSpaceCut {
  public:
    HalfSpaceCut(TriangleMesh mesh, std::vector<double> height)
        : mesh_(std::move(mesh)), height_(std::move(height)) {}

    TriangleMesh run() {
        std::vector<Triangle> kept;
        for (const Triangle& t : mesh_.triangles) cut(t, kept);
        mesh_.triangles = std::move(kept);
        return std::move(mesh_);
    }

  private:
    bool stays(std::uint32_t v) const { return height_[v] >= 0; }

    void cut(const Triangle& t, std::vector<Triangle>& kept) {
        const int count = stays(t[0]) + stays(t[1]) + stays(t[2]);
        if (count == 3) kept.push_back(t);
        if (count == 0 || count == 3) return;
        // Turn the triangle so that its odd vertex (the one alone on its side) comes first; orientation is
        // kept.
        int first = 0;
        while (stays(t[first]) != (count == 1)) ++first;
        const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
        const std::uint32_t ab = between(a, b), ac = between(a, c);
        if (count == 1) {
            kept.push_back({a, ab, ac});
        } else {
            kept.push_back({ab, b, c});
            kept.push_back({ab, c, ac});
        }
    }

    // The vertex where edge ab meets the face; the same one for both triangles of the edge.
    std::uint32_t between(std::uint32_t a, std::uint32_t b) {
        if (a > b) std::swap(a, b);
        const auto [at, isNew] =
            made_.try_emplace(std::uint64_t(a) << 32 | b, std::uint32_t(mesh_.points.size()));
        if (!isNew) return at->second;
        const double t = height_[a] / (height_[a] - height_[b]);
        Point p;
        for (int i = 0; i < 3; ++i) p[i] = mesh_.points[a][i] + t * (mesh_.points[b][i] - mesh_.points[a][i]);
        mesh_.points.push_back(p);
        height_.push_back(0);
        if (!mesh_.normals.empty()) {
            std::array<float, 3> n{};
            float length = 0;
            for (int i = 0; i < 3; ++i) {
                n[i] = mesh_.normals[a][i] + float(t) * (mesh_.normals[b][i] - mesh_.normals[a][i]);
                length += n[i] * n[i];
            }
            if (length > 0)
                for (float& x : n) x /= std::sqrt(length);
            mesh_.normals.push_back(n);
        }
        return at->second;
    }

    TriangleMesh mesh_;
    std::vector<double> height_;
    std::unordered_map<std::uint64_t, std::uint32_t> made_;
};

TriangleMesh withoutUnusedPoints(const TriangleMesh& mesh) {
    constexpr std::uint32_t kUnused = ~0u;
    std::vector<std::uint32_t> renamed(mesh.points.size(), kUnused);
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) renamed[v] = 0;
    TriangleMesh result;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (renamed[v] == kUnused) continue;
        renamed[v] = static_cast<std::uint32_t>(result.points.size());
        result.points.push_back(mesh.points[v]);
        if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[v]);
    }
    for (const Triangle& t : mesh.triangles)
        result.triangles.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]]});
    return result;
}

}  // namespace

TriangleMesh clipToBox(const TriangleMesh& mesh, const openvdb::Mat4d& worldToIndex,
                       const openvdb::Vec3d& low, const openvdb::Vec3d& high) {
    TriangleMesh current = mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        std::vector<double> height;
        height.reserve(current.points.size());
        for (const Point& p : current.points) {
            const double x = worldToIndex.transform(openvdb::Vec3d(p[0], p[1], p[2]))[axis];
            height.push_back(face % 2 == 0 ? x - low[axis] : high[axis] - x);
        }
        current = HalfSpaceCut(std::move(current), std::move(height)).run();
    }
    return withoutUnusedPoints(current);
}

}  // namespace isowave
