#include "hold/surface_pieces.h"

#include <algorithm>
#include <bit>

#include "polygonize/cell_decision.h"
#include "polygonize/polygonize.h"
#include "polygonize/vertex_place.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

constexpr int kSide = kBlock + 1;  // lattice points of the block's cells on an axis
constexpr int kPoints = kSide * kSide * kSide;

constexpr int pointAt(int x, int y, int z) { return (x * kSide + y) * kSide + z; }
constexpr std::array<int, 3> kStride{kSide * kSide, kSide, 1};

// (1,4,1) on each axis, exact in double as insideBits() (polygonize/blocks.h).
std::array<bool, kPoints> signsOf(const PaddedBlock& points) {
    constexpr int n = PaddedBlock::kSize;
    static_assert(n == kSide + 2);
    std::array<double, n * n * kSide> alongZ;
    for (int i = 0; i < n * n; ++i)
        for (int z = 0; z < kSide; ++z) {
            const float* c = &points.values[i * n + z];
            alongZ[i * kSide + z] = double(c[0]) + 4 * double(c[1]) + c[2];
        }
    std::array<double, n * kSide * kSide> alongY;
    for (int x = 0; x < n; ++x)
        for (int i = 0; i < kSide * kSide; ++i) {
            const double* c = &alongZ[x * n * kSide + i];
            alongY[x * kSide * kSide + i] = c[0] + 4 * c[kSide] + c[2 * kSide];
        }
    std::array<bool, kPoints> inside;
    for (int i = 0; i < kPoints; ++i)
        inside[i] = alongY[i] + 4 * alongY[i + kSide * kSide] + alongY[i + 2 * kSide * kSide] < 0;
    return inside;
}

class Builder {
  public:
    Builder(const PaddedBlock& points, const Coord& origin)
        : points_(controlPointsOf(points)), origin_(origin.asVec3d()), inside_(signsOf(points)) {
        onEdge_.fill(kNone);
    }

    SurfacePieces run() {
        for (int x = 0; x < kBlock; ++x)
            for (int y = 0; y < kBlock; ++y)
                for (int z = 0; z < kBlock; ++z) addCell(x, y, z);
        return pieces();
    }

  private:
    static constexpr std::int16_t kNone = -1;
    struct Vertex {
        Vec3d at;
        std::uint16_t parent;
        bool isOwned;
    };
    using Corners = std::array<std::uint16_t, 3>;

    std::uint16_t add(const Vec3d& at, bool isOwned) {
        const auto name = static_cast<std::uint16_t>(vertices_.size());
        vertices_.push_back({origin_ + at, name, isOwned});
        return name;
    }
    std::uint16_t vertexOn(int x, int y, int z, const CellEdge& edge) {
        const std::array<int, 3> low{x + edge.x, y + edge.y, z + edge.z};
        const int point = pointAt(low[0], low[1], low[2]);
        std::int16_t& vertex = onEdge_[edge.axis * kPoints + point];
        if (vertex != kNone) return static_cast<std::uint16_t>(vertex);
        const PolygonizeOptions options;
        Vec3d at(low[0], low[1], low[2]);
        const double t =
            rootOf(edgeField(points_, low, edge.axis).value, inside_[point], options.rootTolerance);
        at[edge.axis] += std::clamp(t, options.rootMargin, 1 - options.rootMargin);
        const bool isOwned = low[0] < kBlock && low[1] < kBlock && low[2] < kBlock;
        const std::uint16_t added = add(at, isOwned);
        vertex = static_cast<std::int16_t>(added);
        return added;
    }
    std::uint16_t vertexOnRay(const std::array<int, 3>& cell, int corner, bool middleInside) {
        const PolygonizeOptions options;
        const Vec3d middle = Vec3d(cell[0], cell[1], cell[2]) + Vec3d(0.5);
        const Vec3d end(cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
        const double t = rootOnRay(points_, cell, middle, end, middleInside, options.rootTolerance);
        return add(middle + (end - middle) * std::clamp(t, options.rootMargin, 1 - options.rootMargin), true);
    }

    void addCell(int x, int y, int z) {
        unsigned pattern = 0;
        for (int c = 0; c < kCellCorners; ++c)
            pattern |= static_cast<unsigned>(inside_[pointAt(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))])
                       << c;
        if (pattern == 0 || pattern == 255) return;
        const CellTable& table = cellTable();
        CellDecision decision;
        if (!table.isPlain(pattern))
            decision =
                decide(pattern, [&](int dx, int dy, int dz) { return *points_.at(x + dx, y + dy, z + dz); });
        const CellCase& cell = table.at(pattern, decision);
        std::array<std::uint16_t, kCellCorners> onRays{};
        for (unsigned rays = cell.rays; rays != 0; rays &= rays - 1) {
            const int corner = std::countr_zero(rays);
            onRays[corner] = vertexOnRay({x, y, z}, corner, decision.middleInside);
        }
        for (const auto& triangle : cell.triangles) {
            Corners corners;
            for (int k = 0; k < 3; ++k)
                corners[k] = triangle[k] < kCellEdges ? vertexOn(x, y, z, table.edge(triangle[k]))
                                                      : onRays[triangle[k] - kCellEdges];
            unite(corners[0], corners[1]);
            unite(corners[0], corners[2]);
            triangles_.push_back(corners);
        }
    }

    std::uint16_t firstOf(std::uint16_t v) {
        while (vertices_[v].parent != v) v = vertices_[v].parent = vertices_[vertices_[v].parent].parent;
        return v;
    }
    void unite(std::uint16_t a, std::uint16_t b) {
        a = firstOf(a), b = firstOf(b);
        vertices_[std::max(a, b)].parent = std::min(a, b);
    }

    SurfacePieces pieces() {
        SurfacePieces result;
        std::vector<std::uint16_t> pieceOf(vertices_.size());
        for (std::uint16_t v = 0; v < vertices_.size(); ++v) {
            const std::uint16_t root = firstOf(v);
            if (root == v) {
                pieceOf[v] = static_cast<std::uint16_t>(result.pieces.size());
                result.pieces.emplace_back();
            }
            pieceOf[v] = pieceOf[root];
            result.pieces[pieceOf[v]].twiceEuler += 2 * vertices_[v].isOwned;
        }
        for (const Corners& t : triangles_) {
            SurfacePiece& piece = result.pieces[pieceOf[t[0]]];
            --piece.twiceEuler;
            piece.volume += vertices_[t[0]].at.dot(vertices_[t[1]].at.cross(vertices_[t[2]].at)) / 6;
        }
        for (int axis = 0; axis < 3; ++axis)
            for (const int end : {0, kBlock}) putFace(axis, end, pieceOf, result);
        return result;
    }
    // The vertices of the lattice edges in the plane where the coordinate on `axis` is `end`.
    void putFace(int axis, int end, const std::vector<std::uint16_t>& pieceOf, SurfacePieces& result) const {
        auto& face = result.onFace[2 * axis + (end != 0)];
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const int point = end * kStride[axis] + i * kStride[u] + j * kStride[v];
                for (int k = 0; k < 2; ++k) {
                    const std::int16_t vertex = onEdge_[(k == 0 ? u : v) * kPoints + point];
                    if (vertex == kNone) continue;
                    face.push_back({static_cast<std::uint16_t>((i * kSide + j) * 2 + k), pieceOf[vertex]});
                }
            }
    }

    DenseControlPoints points_;
    Vec3d origin_;
    std::array<bool, kPoints> inside_;
    std::array<std::int16_t, 3 * kPoints> onEdge_;
    std::vector<Vertex> vertices_;
    std::vector<Corners> triangles_;
};

}  // namespace

SurfacePieces surfacePieces(const PaddedBlock& points, const Coord& origin) {
    return Builder(points, origin).run();
}

}  // namespace isowave
