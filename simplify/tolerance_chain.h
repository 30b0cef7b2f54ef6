// One step's mesh -> ever coarser ones, whatever tolerance is asked for: a larger one has all that a smaller one has to choose
// from, so it never gets more triangles.
//
// Stage j belongs to the length c_j = 2^e_j voxel diagonals of step 0, e_j = -10, -7, -4, -3, -2, ... Of each:
//   flatten   the mesh of the stage before, less what quadrics can take without leaving its planes by more than 0.08 c_j. A
//             planar part becomes the few triangles of its outline here, in one pass. Kept where samples show that it is within
//             0.4 c_j of level 0.
//   measure   from the third stage on: Collapse, by distance, in steps of a quarter of an octave: the costs c_j 2^(i/4),
//             i = -3 .. 3. The next stage begins with the first of these meshes, and has no need to flatten. Above
//             60,000 triangles, where that takes too long, once more quadrics instead, up to 0.3 c_j.
#pragma once

#include <optional>
#include <vector>

#include "isowave/progress.h"
#include "lod/simplifier.h"
#include "simplify/distance.h"

namespace isowave {

// Level 0, which distances are measured to.
struct OriginalSurface {
    const TriangleMesh& mesh;
    DistanceTarget target;
    TriangleMesh sample;  // some of its triangles, for distances that only rank

    explicit OriginalSurface(const TriangleMesh& level0);
    // The larger side, from samples: no more than the true one. World units.
    double roughDistance(const TriangleMesh& mesh, const Progress& progress) const;
};

class ToleranceChain {
  public:
    struct Mesh {
        TriangleMesh mesh;
        double rough;  // OriginalSurface::roughDistance of it
    };
    // voxel: the diagonal of one of step 0, world units. `from` and `original` outlive this.
    ToleranceChain(const StepMesh& from, const OriginalSurface& original, double voxel);

    int step() const { return from_.step; }
    // The distance of the step's own mesh, from samples.
    double ownDistance(const Progress& progress);
    // The fewest triangles that are proven to be within `distance` (world units) of level 0, both ways, and the proof; nothing
    // where the step itself is not. The same answer whatever was asked before.
    struct Proven {
        TriangleMesh mesh;
        MeshComparison distance;
    };
    std::optional<Proven> within(double distance, const Progress& progress);

  private:
    void makeUpTo(double distance, const Progress& progress);
    void flatten(double cost, const Progress& progress);
    void measure(double cost, const Progress& progress);
    void keep(TriangleMesh mesh, const Progress& progress);

    const StepMesh& from_;
    const OriginalSurface& original_;
    double voxel_, extent_;  // extent: level 0's diagonal; whatever is larger allows anything
    std::optional<double> own_;
    std::size_t stages_ = 0;   // done
    TriangleMesh flat_;        // where the next stage begins; empty: with the step's own mesh
    bool isMeasured_ = false;  // flat_
    std::vector<Mesh> made_;
};

}  // namespace isowave
