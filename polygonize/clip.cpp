#include "polygonize/clip.h"

#include <cmath>
#include <unordered_map>

namespace isowave {
namespace {

// A vertex nearer than this to a face, in voxels, lies on it. Marching cubes puts vertices on lattice edges,
// and the faces of an image are lattice planes: rounding decides on which side such a vertex comes out, and
// cutting its edges a hair away would make triangles of no width, whose corners STL's float32 cannot tell
// apart.
constexpr double kOnFace = 1e-6;

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
    // A vertex on the face stays and is its own cut: an edge from it leads outside without another vertex.
    void cut(const Triangle& t, std::vector<Triangle>& kept) {
        std::uint32_t polygon[4];
        int corners = 0;
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i], b = t[(i + 1) % 3];
            if (height_[a] >= 0) polygon[corners++] = a;
            if ((height_[a] > 0 && height_[b] < 0) || (height_[a] < 0 && height_[b] > 0))
                polygon[corners++] = between(a, b);
        }
        for (int i = 2; i < corners; ++i) kept.push_back({polygon[0], polygon[i - 1], polygon[i]});
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
            const double h = face % 2 == 0 ? x - low[axis] : high[axis] - x;
            height.push_back(std::abs(h) < kOnFace ? 0 : h);
        }
        current = HalfSpaceCut(std::move(current), std::move(height)).run();
    }
    return withoutUnusedPoints(current);
}

}  // namespace isowave
