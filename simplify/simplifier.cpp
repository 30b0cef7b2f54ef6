// lod/simplifier.h with CGAL: what the workflow asks for, by what this folder has.
#include "lod/simplifier.h"

#include "simplify/budget_chooser.h"
#include "simplify/collapse.h"
#include "simplify/distance.h"
#include "simplify/self_intersections.h"
#include "simplify/triangle_subset.h"

namespace isowave {

bool canMeasureDistances() { return true; }

namespace lod {
namespace {

// From level 0 to a coarser level, which is far from most of it, the nearest triangle takes long to find: so
// many triangles of level 0, evenly chosen, are enough for an rms to three digits and see every speck of a
// few hundredths of a percent of the surface. In the other direction every vertex and centroid counts.
constexpr std::size_t kReferenceTriangles = 50'000;

class Reference : public ReferenceSurface {
  public:
    explicit Reference(TriangleMesh mesh)
        : sample_(evenSubset(mesh, kReferenceTriangles)), target_(std::move(mesh)) {}

    Distances distances(const TriangleMesh& level, const Progress& progress) const override {
        const OneSidedDistance to = target_.sampledDistanceFrom(level, 0, progress);
        return {to, DistanceTarget(level).sampledDistanceFrom(sample_, 0, progress)};
    }

  private:
    TriangleMesh sample_;
    DistanceTarget target_;
};

class Solver : public BudgetSolver {
  public:
    Solver(std::vector<StepMesh> steps, const TopologyLimits& limits, const std::string& name)
        : chooser_(std::move(steps), limits, name) {}
    BudgetMesh choose(const Budget& budget, const Progress& progress) override {
        return chooser_.choose(budget, progress);
    }

  private:
    BudgetChooser chooser_;
};

}  // namespace

void requireSimplifier(std::string_view) {}

TriangleMesh collapsedByVolume(const TriangleMesh& mesh, std::int64_t triangles, const Progress& progress) {
    return decimate(mesh, triangles, progress);
}

std::unique_ptr<ReferenceSurface> makeReferenceSurface(TriangleMesh mesh) {
    return std::make_unique<Reference>(std::move(mesh));
}

std::unique_ptr<BudgetSolver> makeBudgetSolver(std::vector<StepMesh> steps, const TopologyLimits& limits,
                                               const std::string& name) {
    return std::make_unique<Solver>(std::move(steps), limits, name);
}

}  // namespace lod
}  // namespace isowave
