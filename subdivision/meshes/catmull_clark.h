// Catmull-Clark subdivision backwards: any faces, any valence, boundaries, creases.
// Olsen and Samavati, "A discrete approach to multiresolution curves and surfaces" (O): section 6.
//
// Notation (O figure 6). v a coarse vertex with n edges, w the vertices at their other ends; v', e, f the fine points
// of a vertex, an edge, a face. A tilde is what subdivision makes of the coarse points, d = fine - tilde the detail.
//   f~ = mean of the face's vertices
//   e~ = (v + w + f~a + f~b)/4,  on a sharp edge (v + w)/2
//   v~ = (n-2)/n v + sum(w)/n^2 + sum(f~)/n^2     smooth: at most one sharp edge ends at v
//      = 3/4 v + (w1 + w2)/8                      curve: two sharp edges do, and it runs along them
//      = v                                        corner: three or more, a boundary vertex with one face, or pinned
// Sharp: boundary edges, and creases, at every level. (O(10)'s first display must have + before its last sum.)
//
// Put e~ and f~ in the place of w, and every kind of vertex reads
//   v~ = mu v + sum(alpha_e e~) + sum(alpha_f f~):
//   kind     mu        alpha_e                        alpha_f
//   smooth   (n-3)/n   4/n^2, on a sharp edge 2/n^2   (s-1)/n^2, s of the face's two edges at v are sharp
//   curve    1/2       1/4 on the two sharp edges     0
//   corner   1         0                              0
// so asking for d_v = sum(alpha_e d_e) + sum(alpha_f d_f) gives the *trial* inverse, O(8):
//   v = (v' - sum(alpha_e e) - sum(alpha_f f)) / mu,
// and d_v need not be stored. It does not exist where mu = 0, at smooth vertices with three edges.
//
// Vertices with mu = 0. Each edge knows the sum of its ends:  v + w = 4e - fa - fb  (2e when sharp), up to
//   h = 4 d_e - d_fa - d_fb  (2 d_e).
// In layers, breadth first from all other vertices: v is the mean of what its edges to earlier layers, its candidates,
// say (O(9)). That forces sum(h) = 0 over the candidates, and each edge is a candidate of one vertex at most: the last
// candidate's d_e follows from the others, and d_v is stored in its slot. (O stores one more number a vertex.)
// A component of such vertices alone: a spanning tree gives v_i = c_i + s_i x with signs s_i and one unknown x.
//   Edges that close an odd cycle (s_i = s_j) each give x; their mean forces sum(s_i h) = 0, so the last such edge's
//   slot is free for the root.
//   Where there is none (the cube: even cycles only), s is in the kernel of P, and no base can be recovered beyond it:
//   x minimises sum |v_i - v'_i|^2. Then sum s_i (v_i - v'_i) = 0, so the mean t of s_i d_i is that of s_i (v_i - v~_i)
//   and need not be stored: the slots hold d_i - s_i t, which determine the root's. With empty slots all d_i are s_i t,
//   small and even, where a d of the root alone would be a spike.
//
// Limit. Subdivision maps the star of a vertex, v, e_i and f_i (i = 0 .. n-1, f_i between e_i and e_i+1), to that of the
// same vertex one level finer, where all faces are quads. With the left eigenvector (a, b_i, c_i) of the eigenvalue 1,
//   limit = (a v' + sum(b_i e_i) + sum(c_i f_i)) / (a + sum(b_i) + sum(c_i)).
//   smooth   a = n^2, b = 4, c = 1: Halstead, Kass and DeRose (1993)
//   dart     a smooth vertex at which one sharp edge, e_0, ends. Columns e_i and f_i of x S = x, c eliminated, leave
//              7 b_i = 20 + b_i-1 + b_i+1  (0 < i < n, 0 in the place of b_0 and b_n),
//            so b_i = 4 (1 - (r^i + r^(n-i))/(1 + r^n)), r = (7 - sqrt 45)/2,
//            b_0 = (10 + b_1)/3, c_i = 1/3 + (b_i + b_i+1)/12 with 0 for the sharp edge
//   curve    (4 v' + e + e)/6 along the two sharp edges
//   corner   v
//
// Refinement, O(11). Moving v by delta moves v~ by r delta, e~ by s delta, f~ by t delta; the delta that makes the
// details around v least, times r for what its neighbours do at the same time:
//   delta = r sum((r alpha + s) d) / (r^2 + sum s^2 + sum t^2),     r d_v in place of r alpha d where mu = 0
//   (nothing in its place where t is needed to know d_v).
// On curves only the curve counts: r = 3/4, s = 1/2, so delta = 33/68 (d_1 + d_2).
//
// variant    delta                                                                            noise, rough 256^2 torus
//   refined    O(11)                                                                          0.168
//   trial      0                                                                              0.58
//   unscaled   O(11) without the factor r                                                     0.45
//   tensor     where all faces around the four faces of v are quads and all their inner vertices have valence 4:
//              A7 x A7 of the cubic B-spline curve, the least-norm row of 7 x 7 fine points; on curves A7;
//              refined elsewhere                                                              0.069
// (relative error of 3 levels without details; tests/subdivision/catmull_clark_test.cpp)
#pragma once

#include "subdivision/meshes/mesh_scheme.h"

namespace isowave::subdivision {

enum class CatmullClarkVariant { refined, trial, unscaled, tensor };

class CatmullClarkStep final : public SubdivisionStep {
  public:
    // REQUIRES: defects(coarse).empty().
    CatmullClarkStep(const PolygonMesh& coarse, CatmullClarkVariant variant);

    PolygonMesh fineMesh() const override;
    std::vector<Vec3> subdivide(std::span<const Vec3> coarse) const override;
    std::vector<Vec3> limit(std::span<const Vec3> fine) const override;
    Parts decompose(std::span<const Vec3> fine) const override;
    std::vector<Vec3> allDetails(std::span<const Vec3> coarse, std::span<const Vec3> stored) const override;
    std::vector<Vec3> shift(std::span<const Vec3> allDetails) const override;

    const Adjacency& adjacency() const { return adjacency_; }
    // Vertices whose shift is that of A7 x A7 (variant tensor).
    std::size_t tensorVertices() const;
    // Components in which P is not injective.
    std::size_t ambiguousComponents() const;

  private:
    enum class Kind : std::uint8_t { smooth, curve, corner };
    struct Candidate {
        Index edge, other;
    };
    // A vertex with mu = 0 and its candidates, [begin, end) of candidates_; the last one's slot holds its detail.
    struct Cascaded {
        Index vertex, begin, end;
    };
    // A component of such vertices alone: the root, its part of cascade_, and the edges that close an odd cycle.
    struct Tree {
        Index root, begin, end;
        std::vector<Candidate> odd;  // `other` is either end
    };
    struct Mask {
        double mu;
        double edge[2];  // alpha_e of a smooth and of a sharp edge
        double face[3];  // alpha_f of a face with so many sharp edges at the vertex
    };

    CatmullClarkStep(const PolygonMesh& coarse, Adjacency adjacency, CatmullClarkVariant variant);
    void findKinds(const PolygonMesh& coarse);
    void findCascade();
    void findTree(Index root, std::vector<bool>& reached);
    void findTensorFaces();

    Index edgePoint(Index e) const { return static_cast<Index>(adjacency_.vertices() + e); }
    Index facePoint(Index f) const {
        return static_cast<Index>(adjacency_.vertices() + adjacency_.edges() + f);
    }
    bool cascades(Index v) const { return kind_[v] == Kind::smooth && valence_[v] == 3; }
    Mask mask(Index v) const;
    template <class Edge, class Face>
    void forStar(Index v, Edge edge, Face face) const;
    Vec3 aroundVertex(Index v, std::span<const Vec3> fine) const;
    Vec3 curveLimit(Index v, std::span<const Vec3> fine) const;
    Vec3 smoothLimit(Index v, std::span<const Vec3> fine) const;
    Vec3 dartLimit(Index v, Index sharp, std::span<const Vec3> fine) const;
    Vec3 sumOfEnds(Index e, std::span<const Vec3> fine) const;
    void solveTree(const Tree& tree, std::span<const Vec3> fine, std::vector<Vec3>& coarse) const;
    std::vector<Vec3> trial(std::span<const Vec3> fine) const;
    void fillSlots(std::span<const Vec3> stored, std::vector<Vec3>& details) const;
    void fillEvenTrees(std::span<const Vec3> coarse, std::vector<Vec3>& details) const;
    template <class F>
    void forTree(const Tree& tree, F f) const;
    Vec3 refinement(Index v, std::span<const Vec3> details) const;
    Vec3 tensorOfFace(Index f, std::span<const Vec3> details) const;

    CatmullClarkVariant variant_;
    Adjacency adjacency_;
    std::vector<Crease> creases_;
    std::vector<Index> pinned_;
    std::vector<bool> sharp_;     // of each edge
    std::vector<Kind> kind_;      // of each vertex
    std::vector<Index> valence_;  // of each vertex
    std::vector<Candidate> candidates_;
    std::vector<Cascaded> cascade_;  // in the order in which they can be solved
    std::vector<Tree> trees_;
    std::vector<std::int8_t> sign_;  // +-1 in trees
    std::vector<bool> evenTree_;     // vertices of trees without odd cycles
    std::vector<bool> tensorFace_, tensorVertex_;
};

}  // namespace isowave::subdivision
