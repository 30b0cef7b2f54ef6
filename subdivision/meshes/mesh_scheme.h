// What a subdivision of meshes has to offer to take part in hierarchies (hierarchy.h) and commands: one row of the
// table in mesh_schemes.cpp, and one class.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/progress.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

// One subdivision step over a given coarse connectivity, forwards and backwards. Fine points have the *canonical
// order* that fineMesh() gives them:
//   vertices   fine vertex i is the coarse vertex i, for all coarse vertices; then those of the edges, in the order
//              of Adjacency; then, where the scheme makes them, those of the faces
//   faces      fine face c lies at the corner c of the coarse mesh and starts at its vertex, for all coarse corners;
//              then those without a coarse vertex (of 1-to-4: the middle ones, in the order of the faces)
// so it depends on the coarse mesh alone, and a base mesh fixes the order of every level.
//
//   f = P c' + D    with c' = c - shift(D):    c coarse points, D one detail for every fine point.
// D has more numbers than are needed: the stored ones, as many as fine minus coarse points, determine it.
//   (1) decompose(f) = {c, d}  =>  reconstruct(c, d) = f            (2) decompose(P c) = {c, 0}
// (2) holds for every c as long as P is injective.
// Immutable once made; safe to use from several threads.
class SubdivisionStep {
  public:
    virtual ~SubdivisionStep() = default;

    // Faces, creases and pinned vertices of the fine mesh; its points are all 0.
    virtual PolygonMesh fineMesh() const = 0;
    std::size_t coarseSize() const { return coarseSize_; }
    std::size_t fineSize() const { return fineSize_; }

    // P c. REQUIRES: coarseSize() points.
    virtual std::vector<Vec3> subdivide(std::span<const Vec3> coarse) const = 0;
    // Where subdivision without end takes the coarse vertices, from the points of one step, P c: the left eigenvector of
    // the eigenvalue 1 of the matrix that takes the fine points around a vertex to those of the next step.
    // REQUIRES: fineSize() points.
    virtual std::vector<Vec3> limit(std::span<const Vec3> fine) const = 0;

    struct Parts {
        std::vector<Vec3> coarse, stored;
    };
    // REQUIRES: fineSize() points.
    virtual Parts decompose(std::span<const Vec3> fine) const = 0;

    // D from what is stored. Where P is not injective it takes the coarse points to fill the gap.
    virtual std::vector<Vec3> allDetails(std::span<const Vec3> coarse,
                                         std::span<const Vec3> stored) const = 0;
    // How far the details move the coarse points from where A0, the inverse without refinement, has them.
    virtual std::vector<Vec3> shift(std::span<const Vec3> allDetails) const = 0;

    // P (c - shift(D)) + D.
    std::vector<Vec3> compose(std::span<const Vec3> coarse, std::span<const Vec3> allDetails) const;
    std::vector<Vec3> reconstruct(std::span<const Vec3> coarse, std::span<const Vec3> stored) const {
        return compose(coarse, allDetails(coarse, stored));
    }

  protected:
    SubdivisionStep(std::size_t coarseSize, std::size_t fineSize)
        : coarseSize_(coarseSize), fineSize_(fineSize) {}

  private:
    std::size_t coarseSize_, fineSize_;
};

// A coarse connectivity found inside a fine mesh. `coarse` has points (near where they belong: the scheme's step says),
// faces, creases and pinned vertices. fineCorner[c], for each corner c of `coarse`: the corner of the fine mesh that
// lies in it, that is, at the same vertex, in the face that one step of the scheme makes there.
struct Coarsening {
    PolygonMesh coarse;
    std::vector<Index> fineCorner;
};

struct MeshScheme {
    std::string_view name;                   // "catmull-clark"
    std::string_view summary;                // one line for messages and documentation
    std::vector<std::string_view> variants;  // of A; the first is taken when none is named
    // REQUIRES: defects(coarse).empty(), a variant of the list. Throws InputError when the scheme cannot take such
    // faces (and names one). Points are not looked at.
    std::unique_ptr<SubdivisionStep> (*step)(const PolygonMesh& coarse, std::string_view variant);
    // The connectivities inside `fine`, from the first coarser one on: exactly `levels` of them, or with kAllLevels
    // as many as there are. Throws InputError when there are fewer (none): which vertex or face stands in the way,
    // and how many levels are possible. REQUIRES: defects(fine).empty().
    std::vector<Coarsening> (*recover)(const PolygonMesh& fine, int levels, const Progress& progress);
};

// `variant` itself, or the scheme's first when it is empty. Throws InputError that lists them.
std::string_view meshVariant(const MeshScheme& scheme, std::string_view variant);

}  // namespace isowave::subdivision
