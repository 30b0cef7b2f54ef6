// A closed mesh -> the same surface with fewer triangles, by collapsing edges. This header's code lives in the
// target isowave_measure, which links CGAL packages under the GPL: a program that links it is under GPL-3 as a
// whole.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "isowave/progress.h"
#include "simplify/measure.h"
#include "isowave/mesh.h"

namespace isowave {

// Down to at most `triangles` by CGAL's edge collapse (Lindstrom and Turk 1998), which looks at the mesh of the
// moment only. Fast; far above the final count its errors are small against those that follow. Keeps topology as
// Collapse does. No normals. REQUIRES: closed, oriented, 2-manifold.
TriangleMesh thin(const TriangleMesh& mesh, std::int64_t triangles, const Progress& progress = {});

// A surface on its way to fewer and fewer triangles. Every triangle carries the points of the original that it stands
// for (Klein, Liebich and Strasser 1996). A collapse costs the largest distance that it would leave between the
// triangles around the edge and their points, either way; the cheapest collapse comes next. So it is the Hausdorff
// distance itself that is kept low, not a quadric's estimate of the mean.
// (1) The surface stays closed, oriented, 2-manifold, with its components and their genus: an edge is collapsed
//     only when its ends have just the two neighbours in common that face it, and no tetrahedron is flattened.
// (2) No triangle around a collapse turns by a right angle or more, or becomes a needle thinner than kNeedle.
// The result depends on the input alone, not on the number of threads.
class Collapse {
  public:
    struct Options {
        // World units: points of the original that are farther than this from `start` are parts that `start` has lost;
        // they have no say.
        double reach = std::numeric_limits<double>::infinity();
        // World units: distances of at most this are worth the same, and of such collapses the one whose vertex has the
        // smallest quadric comes next. 0: the distance alone counts. Whether a limit helps
        // depends on the solid (docs/fidelity.md): try several and measure, as BudgetChooser does.
        double alike = 0;
    };
    // original: what distances are measured to, made of `surface`.
    // Much dearer than thin(): thin() a large mesh first.
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
    // What is left, with the normals of the original's nearest points where it has normals.
    TriangleMesh mesh() const;

    static constexpr double kNeedle = 1e-3;  // height by longest side

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace isowave
