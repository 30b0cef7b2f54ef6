// The yardstick of O-T2: generalised bicubic B-spline wavelets by lifting, on meshes with Catmull-Clark connectivity.
// Bertram, Duchaineau, Hamann, Joy: "Generalized B-spline subdivision-surface wavelets for geometry compression"
// (2004); "Bicubic subdivision-surface wavelets for large-scale isosurface representation and visualization" (2000).
//
// On the line, s at every second place, w between them:
//     s-lift(a, b)   s <- b s + a (the two w beside it)          w-lift(a, b)   w <- b w + a (the two s beside it)
//     apart:  s-lift(-1/2, 2), w-lift(-1/2, 1), s-lift(3/8, 1)   together: the inverses, backwards
// With w = 0 the inverses of the first two are the cubic B-spline's subdivision; 3/8 is what gives the wavelet two
// vanishing moments (its column sums to 3/2 - 4a). On a quad grid the same along both axes, which leaves means:
//     s-lift   v <- b^2 v + 4ab mean(e at v) + 4a^2 mean(f at v)      e <- b e + 2a mean(f at e)
//     w-lift   f <- b^2 f + 4ab mean(e of f) + 4a^2 mean(v of f)      e <- b e + 2a mean(v of e)
// with the values from before the lift on the right. The means make sense at any valence and face size; so it is not
// Catmull-Clark there (a vertex of valence n takes 9/16, 3/8, 1/16 of itself, its edges, its faces, for every n).
// Along the boundary the line's lifts; a boundary vertex with one face stays.
// Written from these formulas; the papers' own code is not known to us.
#pragma once

#include <span>
#include <vector>

#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::bench {

class LiftingStep {
  public:
    explicit LiftingStep(const subdivision::PolygonMesh& coarse) : mesh_(coarse) {}

    // Fine points in the order of mesh_scheme.h: vertices, edges, faces. Apart and together in place: first the
    // coarse points, then the details.
    void apart(std::vector<Vec3>& fine) const;
    void together(std::vector<Vec3>& fine) const;
    std::size_t coarseSize() const { return mesh_.vertices(); }
    std::size_t fineSize() const { return mesh_.vertices() + mesh_.edges() + mesh_.faces(); }

  private:
    struct Lift {
        double a, b;
    };
    void liftVertices(std::vector<Vec3>& p, Lift lift, bool inverse) const;
    void liftFaces(std::vector<Vec3>& p, Lift lift, bool inverse) const;

    subdivision::Adjacency mesh_;
};

}  // namespace isowave::bench
