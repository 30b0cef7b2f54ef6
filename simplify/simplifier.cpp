// lod/simplifier.h with CGAL: what the workflow asks for, by what this folder has.
#include "lod/simplifier.h"

#include <cmath>

#include "base/triangle.h"
#include "simplify/budget_chooser.h"
#include "simplify/collapse.h"
#include "simplify/distance.h"
#include "simplify/self_intersections.h"
#include "simplify/triangle_subset.h"

namespace isowave {

bool canMeasureDistances() { return true; }

namespace lod {
namespace {

// So many triangles, evenly chosen, give an rms to two or three digits (rmsError says how many) and see every speck of a few
// hundredths of a percent of the surface. Of a level the largest distance is that of all its vertices and centroids: most of them are
// known to be nearer than it after a few boxes.
constexpr std::size_t kSampleTriangles = 50'000;

// Some triangles of a fine mesh; all of a coarse one, cut into about as many pieces.
class Sample {
  public:
    explicit Sample(const TriangleMesh& mesh)
        : some_(evenSubset(mesh, kSampleTriangles)), spacing_(spacingFor(mesh)) {}
    OneSidedDistance to(const DistanceTarget& target, const Progress& progress) const {
        return target.sampledDistanceFrom(some_, spacing_, progress);
    }

  private:
    // 0: the triangles as they are.
    static double spacingFor(const TriangleMesh& mesh) {
        if (mesh.triangles.size() > kSampleTriangles / 4) return 0;
        double twiceArea = 0;
        for (const Triangle& t : mesh.triangles) twiceArea += length(areaNormal(mesh, t));
        return std::sqrt(twiceArea / kSampleTriangles);
    }
    TriangleMesh some_;
    double spacing_;
};

class Reference : public ReferenceSurface {
  public:
    explicit Reference(TriangleMesh mesh) : sample_(mesh), target_(std::move(mesh)) {}

    Distances distances(const TriangleMesh& level, const Progress& progress) const override {
        return {distanceFrom(level, progress), sample_.to(DistanceTarget(level), progress)};
    }
    OneSidedDistance distanceFrom(const TriangleMesh& level, const Progress& progress) const override {
        OneSidedDistance to = Sample(level).to(target_, progress);
        to.max = target_.farthestSample(level, to.max, progress);
        return to;
    }

  private:
    Sample sample_;
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
