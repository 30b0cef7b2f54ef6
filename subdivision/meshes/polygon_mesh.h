// Polygon meshes by index: points, faces of any size, creases; what is wrong with one; who is next to whom.
//
// Notation. A *corner* c is one place in one face; corners of all faces are numbered in the order of the faces,
// so corner c of a mesh stands for three things at once:
//   the vertex  corners[c]
//   the halfedge from that vertex to the next one of the face, counter-clockwise seen from outside
//   the wedge of the face at that vertex
// An *edge* is one halfedge without a twin (boundary) or two that are each other's twin.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace isowave::subdivision {

struct Vec3 {
    double x = 0, y = 0, z = 0;

    Vec3& operator+=(const Vec3& v) { return x += v.x, y += v.y, z += v.z, *this; }
    Vec3& operator-=(const Vec3& v) { return x -= v.x, y -= v.y, z -= v.z, *this; }
    Vec3& operator*=(double s) { return x *= s, y *= s, z *= s, *this; }
    friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
    friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
    friend Vec3 operator*(double s, Vec3 a) { return a *= s; }
    friend bool operator==(const Vec3&, const Vec3&) = default;
};
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

// An edge across which the surface has a kink, by its two vertices. Sharpness is any number above 0 and is only
// passed on: a crease is a crease at every level.
struct Crease {
    Index a = 0, b = 0;
    double sharpness = 1;
    friend bool operator==(const Crease&, const Crease&) = default;
};

struct PolygonMesh {
    std::vector<Vec3> points;
    std::vector<Index> corners;          // vertex of each corner, face after face
    std::vector<Index> faceBegin = {0};  // face f owns the corners [faceBegin[f], faceBegin[f+1])
    std::vector<Crease> creases;
    std::vector<Index> pinned;  // vertices that subdivision leaves where they are, besides those it must

    std::size_t vertexCount() const { return points.size(); }
    std::size_t faceCount() const { return faceBegin.size() - 1; }
    std::size_t faceSize(std::size_t f) const { return faceBegin[f + 1] - faceBegin[f]; }
    std::span<const Index> face(std::size_t f) const { return {corners.data() + faceBegin[f], faceSize(f)}; }
    void addFace(std::span<const Index> vertices) {
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        faceBegin.push_back(static_cast<Index>(corners.size()));
    }
    void addFace(std::initializer_list<Index> vertices) {
        addFace(std::span<const Index>(vertices.begin(), vertices.size()));
    }
};

// Everything that keeps a mesh from being an oriented 2-manifold (with or without boundary), one line a kind of
// defect: how often, where first (vertices and faces counted from 0), what to do. In this order; of a kind that
// makes others meaningless only that one:
//   no faces; a vertex number beyond the points; a coordinate that is not finite; a face with fewer than three
//   corners or with one vertex twice; an edge with more than two faces; two faces that run along an edge the same
//   way (mixed orientation); a vertex whose faces form more than one fan; a vertex in no face; a crease or a
//   pinned vertex that is not in the mesh.
std::vector<std::string> defects(const PolygonMesh& mesh);

// Throws InputError with the first of defects(), after `name`.
void requireManifold(const PolygonMesh& mesh, const std::string& name);

// Length of the diagonal of the box around the points: the scale that tolerances refer to.
double diagonal(std::span<const Vec3> points);

// Who is next to whom, in time and memory linear in the mesh. REQUIRES: defects(mesh).empty(); only the faces
// and the number of points are looked at, so points may be anything. It keeps no reference to the mesh.
class Adjacency {
  public:
    explicit Adjacency(const PolygonMesh& mesh);

    std::size_t vertices() const { return outgoing_.size(); }
    std::size_t faces() const { return faceBegin_.size() - 1; }
    std::size_t corners() const { return vertex_.size(); }
    std::size_t edges() const { return edgeCorner_.size(); }

    Index vertex(Index c) const { return vertex_[c]; }        // where halfedge c starts
    Index target(Index c) const { return vertex_[next(c)]; }  // where it ends
    Index face(Index c) const { return face_[c]; }
    Index twin(Index c) const { return twin_[c]; }  // kNone on the boundary
    Index edge(Index c) const { return edge_[c]; }
    Index next(Index c) const { return c + 1 == faceBegin_[face_[c] + 1] ? faceBegin_[face_[c]] : c + 1; }
    Index prev(Index c) const { return c == faceBegin_[face_[c]] ? faceBegin_[face_[c] + 1] - 1 : c - 1; }
    Index faceBegin(Index f) const { return faceBegin_[f]; }
    Index faceSize(Index f) const { return faceBegin_[f + 1] - faceBegin_[f]; }

    // Edges are numbered in the order in which the corners meet them first; edgeCorner(e) is that corner.
    Index edgeCorner(Index e) const { return edgeCorner_[e]; }
    bool isBoundaryEdge(Index e) const { return twin_[edgeCorner_[e]] == kNone; }

    // The halfedges that leave v, counter-clockwise: c, nextAround(c), .. Inside the mesh they run around v and
    // come back to outgoing(v); at the boundary outgoing(v) lies on it, and behind the last comes kNone. One more
    // edge then ends at v: that of prev(last).
    Index outgoing(Index v) const { return outgoing_[v]; }
    Index nextAround(Index c) const { return twin_[prev(c)]; }
    bool isBoundaryVertex(Index v) const { return twin_[outgoing_[v]] == kNone; }
    // Faces at v, and edges at v.
    std::size_t faceValence(Index v) const;
    std::size_t valence(Index v) const { return faceValence(v) + (isBoundaryVertex(v) ? 1 : 0); }

    // Calls f(c) for the outgoing halfedges of v.
    template <class F>
    void around(Index v, F f) const {
        const Index first = outgoing_[v];
        Index c = first;
        do {
            f(c);
            c = nextAround(c);
        } while (c != first && c != kNone);
    }

    // The edge between two vertices, kNone when there is none. Takes as long as the valence of a.
    Index edgeBetween(Index a, Index b) const;

    // Connected components: their number, and that of each face, in the order of their first faces.
    std::size_t components(std::vector<Index>& ofFace) const;

  private:
    std::vector<Index> vertex_, face_, twin_, edge_, faceBegin_, edgeCorner_, outgoing_;
};

// For every edge: its sharpness, 0 where it is smooth.
std::vector<double> edgeSharpness(const Adjacency& adjacency, const std::vector<Crease>& creases);

// Edges whose two faces meet at an angle of more than `degrees` (0: flat, 180: folded back), by the faces'
// normals (Newell's, so that faces need not be flat). Sharpness 1, in the order of the edges.
std::vector<Crease> creasesByAngle(const PolygonMesh& mesh, const Adjacency& adjacency, double degrees);

// Two meshes with the same faces in another order, with other vertex numbers: given, in each component at least
// one pair of corners that belong together, finds all. Returns the corner of `b` for every corner of `a`, or an
// empty vector when the meshes are not the same.
struct CornerPair {
    Index a, b;
};
std::vector<Index> correspondingCorners(const Adjacency& a, const Adjacency& b,
                                        std::span<const CornerPair> seeds);

}  // namespace isowave::subdivision
