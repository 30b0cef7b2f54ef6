#include "simplify/tolerance_chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/point_box.h"
#include "polygonize/quadric_collapse.h"
#include "simplify/collapse.h"
#include "simplify/triangle_subset.h"

namespace isowave {
namespace {

// To rank candidates, so many triangles of level 0 are enough; what is reported is measured from all of them.
constexpr std::size_t kRankingTriangles = 20'000;

constexpr double kFlat = 0.08,
                 kFlatShare = 0.4;      // of a stage's length: the quadrics' deviation, and its distance
constexpr double kQuadricsAlone = 0.3;  // the deviation where there is no time to measure
constexpr std::size_t kMostMeasured = 60'000;  // triangles
constexpr std::size_t kFirstMeasured = 2;      // stage
constexpr int kFirstPart = -3, kLastPart = 3;  // quarters of an octave
constexpr double kFloor = 0.25;                // Collapse::Options::errorFloor, of a stage's length
constexpr double kSmaller = 0.9;               // of a large mesh's triangles: what is kept beside it
constexpr double kWorthwhile = 0.98;           // of the triangles before: a pass that leaves more is not kept

// Below a thousandth of a voxel there is nothing but rounding; then planes are found; then shapes matter.
double lengthOf(std::size_t stage, double voxel) {
    constexpr std::array<int, 3> kCoarse{-10, -7, -4};
    const int exponent = stage < kCoarse.size() ? kCoarse[stage] : static_cast<int>(stage) - 6;
    return std::ldexp(voxel, exponent);
}

}  // namespace

OriginalSurface::OriginalSurface(const TriangleMesh& level0)
    : mesh(level0), target(level0), sample(evenSubset(level0, kRankingTriangles)) {}

double OriginalSurface::roughDistance(const TriangleMesh& other, const Progress& progress) const {
    return std::max(target.sampledDistanceFrom(other, 0, progress).max,
                    DistanceTarget(other).sampledDistanceFrom(sample, 0, progress).max);
}

ToleranceChain::ToleranceChain(const StepMesh& from, const OriginalSurface& original, double voxel)
    : from_(from), original_(original), voxel_(voxel) {
    const PointBox box = boxAround(original.mesh);
    extent_ = std::hypot(box.extent(0), box.extent(1), box.extent(2));
}

double ToleranceChain::ownDistance(const Progress& progress) {
    if (!own_) own_ = from_.step == 0 ? 0 : original_.roughDistance(from_.mesh, progress);
    return *own_;
}

// Not what another one is better than, nor, of large meshes, what is hardly any smaller.
void ToleranceChain::keep(TriangleMesh mesh, const Progress& progress) {
    const double rough = original_.roughDistance(mesh, progress),
                 triangles = static_cast<double>(mesh.triangles.size());
    const double share = mesh.triangles.size() > kMostMeasured ? kSmaller : 1;
    const bool isBeaten = std::any_of(made_.begin(), made_.end(), [&](const Mesh& other) {
        return share * static_cast<double>(other.mesh.triangles.size()) <= triangles && other.rough <= rough;
    });
    if (!isBeaten) made_.push_back({std::move(mesh), rough});
}

void ToleranceChain::flatten(double cost, const Progress& progress) {
    TriangleMesh mesh = flat_.triangles.empty() ? from_.mesh : flat_;
    const auto before = static_cast<double>(mesh.triangles.size());
    collapseByQuadrics(mesh, {.deviation = kFlat * cost}, nullptr, progress);
    if (static_cast<double>(mesh.triangles.size()) > kWorthwhile * before) return;
    if (original_.roughDistance(mesh, progress) <= std::max(kFlatShare * cost, ownDistance(progress)))
        keep(flat_ = std::move(mesh), progress);
}

void ToleranceChain::measure(double cost, const Progress& progress) {
    const TriangleMesh start = flat_.triangles.empty() ? from_.mesh : flat_;
    if (start.triangles.size() > kMostMeasured) {
        TriangleMesh mesh = start;
        collapseByQuadrics(mesh, {.deviation = kQuadricsAlone * cost}, nullptr, progress);
        if (static_cast<double>(mesh.triangles.size()) <
            kWorthwhile * static_cast<double>(start.triangles.size()))
            keep(std::move(mesh), progress);
        return;
    }
    Collapse collapse(start, original_.mesh, original_.target, {from_.voxel, kFloor * cost}, progress);
    std::int64_t before = collapse.triangles();
    for (int part = kFirstPart; part <= kLastPart; ++part) {
        collapse.reduce(4, cost * std::pow(2, part / 4.0), progress);
        if (collapse.triangles() < before) keep(collapse.mesh(), progress);
        before = collapse.triangles();
        if (part == kFirstPart) flat_ = collapse.mesh();
    }
    isMeasured_ = true;
}

void ToleranceChain::makeUpTo(double distance, const Progress& progress) {
    for (; lengthOf(stages_, voxel_) <= distance; ++stages_) {
        const double cost = lengthOf(stages_, voxel_);
        if (2 * cost < ownDistance(progress)) continue;
        if (!isMeasured_) flatten(cost, progress);
        if (stages_ >= kFirstMeasured) measure(cost, progress);
    }
}

std::optional<ToleranceChain::Proven> ToleranceChain::within(double distance, const Progress& progress) {
    makeUpTo(std::min(distance, extent_), progress);
    std::vector<const TriangleMesh*> candidates;
    for (const Mesh& each : made_)
        if (each.rough <= distance) candidates.push_back(&each.mesh);
    if (ownDistance(progress) <= distance) candidates.push_back(&from_.mesh);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto* a, const auto* b) { return a->triangles.size() < b->triangles.size(); });
    for (const TriangleMesh* mesh : candidates) {
        const MeshComparison proof = compareMeshes(*mesh, original_.mesh, 0, progress, distance);
        if (proof.maxBound <= distance)
            return Proven{withNormalsOf(original_.mesh, original_.target, *mesh), proof};
    }
    return {};
}

}  // namespace isowave
