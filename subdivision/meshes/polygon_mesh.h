// Who is next to whom in a polygon mesh (the type, and what may be wrong with one: isowave/subdivision.h).
//
// Notation. A *corner* c is one place in one face; corners of all faces are numbered in the order of the faces,
// so corner c of a mesh stands for three things at once:
//   the vertex  corners[c]
//   the halfedge from that vertex to the next one of the face, counter-clockwise seen from outside
//   the wedge of the face at that vertex
// An *edge* is one halfedge without a twin (boundary) or two that are each other's twin.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "isowave/subdivision.h"

namespace isowave::subdivision {

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
                                        std::span<const CornerPair> known);

}  // namespace isowave::subdivision
