// Loop and Butterfly on any manifold triangle mesh, and their inverses: P, A, B, Q at every place.
//
//   f fine, c coarse, d details:   c = A f,   d = B f,   f = P c + Q d.      Fine vertices are numbered as in
//   mesh_scheme.h: first the coarse vertices' own (vertex nodes), then one an edge (edge nodes).
//
// P                    Loop                                         Butterfly
//   vertex inside      (1 - n b) v + b (its n neighbours)           v
//   edge inside        3/8 its ends, 1/8 the two across             1/2 ends, 1/8 across, -1/16 four wings (w = 1/16)
//     an end with      the same                                     3/4 v + sum s_j e_j around that end; the mean of
//     valence K != 6                                                both when both have
//   vertex on the      3/4 v + 1/8 its two neighbours along it      v
//   boundary
//   edge on the        1/2 its ends                                 four points along it (-1, 9, 9, -1)/16; beside a
//   boundary                                                        corner (5, 15, -5, 1)/16, (3, 6, -1)/8, (1, 1)/2
//   corner             v                                            v
//
//   b = (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n: Loop, "Smooth subdivision surfaces based on triangles" (1987), as
//   OpenSubdiv and CGAL have it, so that what they subdivided is recovered. (Warren's 3/(8n), 3/16 for n = 3, is as
//   good and inverts a little better: the row below would have 5/2 in its centre at every n > 3.)
//   s_j = (1/4 + cos(2 pi j/K) + cos(4 pi j/K)/2)/K for K >= 5; 5/12, -1/12, -1/12 for K = 3; 3/8, 0, -1/8, 0 for
//   K = 4: Zorin, Schroeder, Sweldens, "Interpolating subdivision for meshes with arbitrary topology" (1996). A wing
//   beyond the boundary, across (a, c) of the triangle (a, b, c), is a + c - b, as in surface.h.
//   A corner is a boundary vertex with a single triangle, or a pinned vertex; the boundary is cut there.
//
// Limit: the left eigenvector of the eigenvalue 1, over the points of one step.
//   Loop, inside: with w = 3/(8 b), (w v + sum e)/(w + n): the column of e says x_e = b x_v + (3/8 + 2/8) x_e.
//   Loop, boundary: (4 v + e + e)/6. Corners, and Butterfly everywhere: v.
//
// A0, a left inverse of P that reads one vertex node, exists everywhere, so P is injective on every mesh:
//   Butterfly: the vertex node.   Loop, inside: the n edge nodes e of v sum to (3/8 n) v + (3/8 + 2/8) (neighbours), so
//       v = (f_v - (8/5) b sum e) / (1 - (8/5) n b)
//   whose centre is 10 at n = 3, 4.44, 3.06, 5/2 (n = 6), 2.22, .. 1.6: no worse for large n.  On the boundary: 2 in
//   the centre, -1/2 at the two edge nodes along it, since their sum is v + (neighbours)/2.
// A is A0 (Trial), or of least norm among the rows on a window with AP = I, and so the window's least-squares fit:
//              inside          along the boundary, up to corners
//   Refined    three rings     7 nodes (Loop), 9 (Butterfly)
//   Wide       five rings      11, 13
//   Where all valences around are 6 that is the exact row of construct.h. Elsewhere it is computed, in doubles. A0's row
//   lies in every window, so there is always one, never longer than A0's, and AP = I holds to rounding.
//   Measured (a real part, docs/subdivision_triangles.md): |f - P A f| is 9 % (Refined), 1.7 % (Wide) above the least
//   that any c has, after three levels 29 % and 4 %; seven rings, 0.4 % and 0.9 %, were not worth their price.
// B = (I - P A0) at edge nodes. Q0: d at edge nodes and, at vertex nodes, what makes A0 Q0 = 0.
//   Q = (I - P A) Q0, as in construct.h; never formed: f = P (c - A g) + g with g = Q0 d,
//   which is allDetails(); A g is shift().
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "subdivision/meshes/least_norm_rows.h"
#include "subdivision/meshes/mesh_scheme.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

class TriangleStep final : public SubdivisionStep {
  public:
    enum class Family { Loop, Butterfly };
    enum class Fit { Trial, Refined, Wide };
    // REQUIRES: defects(coarse).empty(). Throws InputError as requireTriangles() does.
    TriangleStep(Family family, Fit fit, const PolygonMesh& coarse);

    void rowOfP(Index fine, Taps& row) const;     // over coarse vertices
    void rowOfA0(Index vertex, Taps& row) const;  // over fine vertices, v's own first
    void rowOfA(Index vertex, Taps& row) const;   // over fine vertices

    PolygonMesh fineMesh() const override;
    std::vector<Vec3> subdivide(std::span<const Vec3> coarse) const override;
    std::vector<Vec3> limit(std::span<const Vec3> fine) const override;
    Parts decompose(std::span<const Vec3> fine) const override;
    std::vector<Vec3> allDetails(std::span<const Vec3> coarse, std::span<const Vec3> stored) const override;
    std::vector<Vec3> shift(std::span<const Vec3> allDetails) const override;

    // Rows of A that had to be computed, and how many different ones they are.
    struct Count {
        std::size_t rows, different;
    };
    Count computedRows() const;

  private:
    enum class Place : char { Inside, Boundary, Corner };
    // The rows of A where they are not the exact one: computed when first asked for.
    struct Irregular;

    TriangleStep(Family family, Fit fit, Adjacency coarse, const std::vector<Index>& pinned);

    Place place(Index v) const { return place_[v]; }
    bool isIrregular(Index v) const { return place_[v] == Place::Inside && valence_[v] != 6; }
    Index edgeNode(Index h) const { return static_cast<Index>(coarse_.vertices()) + coarse_.edge(h); }
    // The corner across from a halfedge, in its own triangle.
    Index apex(Index h) const { return coarse_.vertex(coarse_.prev(h)); }
    Index boundaryAfter(Index v) const;
    Index boundaryBefore(Index v) const;

    void limitRow(Index v, Taps& row) const;  // over fine vertices
    void vertexRowOfP(Index v, Taps& row) const;
    void butterflyEdge(Index h, Taps& row) const;
    void addStencilAround(Index h, double factor, Taps& row) const;
    void addWings(Index h, Taps& row) const;
    void boundaryEdge(Index h, Taps& row) const;

    const Irregular& irregular() const;
    std::vector<char> regularVertices() const;
    void regularRow(Index v, Taps& row) const;
    Index turned(Index h, int turns) const;
    std::vector<Index> ballWindow(Index v) const;
    std::vector<Index> boundaryWindow(Index v) const;

    Family family_;
    Fit fit_;
    Adjacency coarse_;
    std::vector<Index> pinned_;
    std::vector<Place> place_;
    std::vector<int> valence_;
    mutable std::once_flag once_;
    mutable std::shared_ptr<const Irregular> irregular_;
};

// b above, for n >= 3 neighbours.
double loopBeta(int n);

}  // namespace isowave::subdivision
