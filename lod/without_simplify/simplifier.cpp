// lod/simplifier.h where CGAL's GPL packages are not to be linked.
#include "lod/simplifier.h"

#include "isowave/error.h"

namespace isowave {
namespace {

std::string refusal(std::string_view what) {
    return std::string(what) +
           " needs CGAL packages under the GPL, which this build leaves out; build with -DISOWAVE_GPL=ON";
}

}  // namespace

bool canMeasureDistances() { return false; }

std::int64_t countSelfIntersections(const TriangleMesh&, const Progress&) {
    throw OperationError(refusal("counting self-intersections"));
}

MeshComparison compareMeshes(const TriangleMesh&, const TriangleMesh&, double, const Progress&, double) {
    throw OperationError(refusal("comparing meshes"));
}

namespace lod {

void requireSimplifier(std::string_view what) { throw UsageError(refusal(what)); }

// What follows is never reached: requireSimplifier() comes first.

TriangleMesh collapsedByVolume(const TriangleMesh&, std::int64_t, const Progress&) {
    throw OperationError(refusal("collapsing edges"));
}

std::unique_ptr<ReferenceSurface> makeReferenceSurface(TriangleMesh) {
    throw OperationError(refusal("measuring distances"));
}

std::unique_ptr<BudgetSolver> makeBudgetSolver(std::vector<StepMesh>, const TopologyLimits&,
                                               const std::string&) {
    throw OperationError(refusal("a budget"));
}

}  // namespace lod
}  // namespace isowave
