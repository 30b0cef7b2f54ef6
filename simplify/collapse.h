// A closed mesh -> the same surface with fewer triangles, by collapsing edges.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "simplify/distance.h"

namespace isowave {

// CGAL's edge collapse (Lindstrom and Turk 1998) down to at most `triangles`. It compares each mesh with the
// one before the collapse and never with the original, so it is fast, and its errors add up: they are small
// while the count is far above the final one. Keeps topology as Collapse does. No normals. REQUIRES: closed,
// oriented, 2-manifold.
TriangleMesh decimate(const TriangleMesh& mesh, std::int64_t triangles, const Progress& progress = {});

// `mesh` with the normals of `surface` at the nearest points of `original`, which was made of it; as it is where `surface` has
// none, or `mesh` has some already.
TriangleMesh withNormalsOf(const TriangleMesh& surface, const DistanceTarget& original, TriangleMesh mesh);

// A surface on its way to fewer and fewer triangles. Every triangle carries the points of the original that
// it stands for (Klein, Liebich and Strasser 1996). A collapse costs the largest distance that it would leave
// between the triangles around the edge and their points, either way; the cheapest collapse comes next. So it
// is the Hausdorff distance itself that is kept low, not a quadric's estimate of the mean.
// (1) The surface stays closed, oriented, 2-manifold, with its components and their genus: an edge is
// collapsed
//     only when its ends have just the two neighbours in common that face it, and no tetrahedron is flattened.
// (2) No triangle around a collapse turns by a right angle or more, or becomes a needle thinner than kNeedle.
// The result depends on the input alone, not on the number of threads.
class Collapse {
  public:
    struct Options {
        // World units. Points of the original that are farther than this from `start` belong to parts that
        // `start` has lost; they are ignored.
        double reach = std::numeric_limits<double>::infinity();
        // World units. Errors below this count as equal and are ordered by quadric error. 0: the distance
        // alone counts. Which floor is best depends on the solid (docs/fidelity.md): try several and measure,
        // as BudgetChooser does.
        double errorFloor = 0;
    };
    // original: what distances are measured to, made of `surface`.
    // Much slower than decimate(): decimate() a large mesh first.
    // REQUIRES: start is closed, oriented and 2-manifold; `surface` and `original` outlive this.
    Collapse(const TriangleMesh& start, const TriangleMesh& surface, const DistanceTarget& original,
             const Options& options, const Progress& progress = {});
    Collapse(const TriangleMesh& start, const TriangleMesh& surface, const DistanceTarget& original)
        : Collapse(start, surface, original, Options{}) {}
    ~Collapse();
    Collapse(Collapse&&) noexcept;

    // Goes on until at most `triangles` are left, or the next collapse would cost more than `distance` (world
    // units), or none is possible.
    void reduce(std::int64_t triangles, double distance = std::numeric_limits<double>::infinity(),
                const Progress& progress = {});

    std::int64_t triangles() const;
    // What is left, with normals as withNormalsOf() has them.
    TriangleMesh mesh() const;

    static constexpr double kNeedle = 1e-3;  // height by longest side

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace isowave
