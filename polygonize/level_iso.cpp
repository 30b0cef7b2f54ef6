#include "polygonize/level_iso.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>

#include "polygonize/lattice_value.h"

namespace isowave {

// ---- the volume of another level

namespace {

// Remembers the best point that was asked for, which is not always the last one.
class VolumeError {
  public:
    VolumeError(const std::function<double(double)>& volumeAt, double target, double tolerance)
        : volumeAt_(volumeAt), target_(target), tolerance_(tolerance) {}

    double operator()(double iso) {
        const double volume = volumeAt_(iso), error = volume - target_;
        if (best_.evaluations == 0 || std::abs(error) < std::abs(best_.volume - target_)) {
            best_.iso = iso;
            best_.volume = volume;
        }
        ++best_.evaluations;
        return error;
    }
    bool isEnough() const { return std::abs(best_.volume - target_) <= tolerance_ * target_; }
    const VolumeMatch& best() const { return best_; }

  private:
    const std::function<double(double)>& volumeAt_;
    double target_, tolerance_;
    VolumeMatch best_;
};

}  // namespace

VolumeMatch isoOfVolume(const std::function<double(double iso)>& volumeAt, double target, double limit,
                        double tolerance) {
    constexpr double kFirstStep = 0.02;  // of the limit
    constexpr double kNarrowest = 1e-9;  // of the limit: a volume that jumps here is not reached
    constexpr std::uintmax_t kMostSteps = 40;
    VolumeError error(volumeAt, target, tolerance);
    // invariant: error(low side) and error(near) have the same sign; `near` is the better one.
    double near = 0, nearError = error(near);
    const double direction = nearError < 0 ? 1 : -1;
    double far = direction * kFirstStep * limit;
    while (!error.isEnough()) {
        const double farError = error(far);
        if (error.isEnough()) break;
        if ((farError < 0) != (nearError < 0)) {
            const bool up = far > near;
            const auto stop = [&](double a, double b) {
                return error.isEnough() || std::abs(b - a) <= kNarrowest * limit;
            };
            std::uintmax_t steps = kMostSteps;
            boost::math::tools::toms748_solve([&](double iso) { return error.isEnough() ? 0.0 : error(iso); },
                                              up ? near : far, up ? far : near, up ? nearError : farError,
                                              up ? farError : nearError, stop, steps);
            break;
        }
        if (std::abs(far) >= limit) break;
        // By the secant, half as far again, so that the root comes to lie between; at least twice, at most
        // ten times.
        const double slope = (farError - nearError) / (far - near);
        const double reach = slope > 0 ? std::abs(far - 1.5 * farError / slope) : limit;
        near = far;
        nearError = farError;
        far = direction * std::min(limit, std::clamp(reach, 2 * std::abs(far), 10 * std::abs(far)));
    }
    return error.best();
}

// ---- thin parts

namespace {

using openvdb::Coord;
using openvdb::Vec3d;

// Lattice points first, first + e, ... of a line along `axis`, all inside, both neighbours outside.
struct Run {
    Coord first;
    int axis;
    int length;
};

constexpr int kLongestRun = 512;

Coord ahead(Coord at, int axis, int steps) {
    at[axis] += steps;
    return at;
}

void addRunsFrom(const Shape::ConstUnsafeAccessor& inside, const Coord& first, std::vector<Run>& runs) {
    for (int axis = 0; axis < 3; ++axis) {
        if (inside.getValue(ahead(first, axis, -1))) continue;
        int length = 1;
        while (length <= kLongestRun && inside.getValue(ahead(first, axis, length))) ++length;
        if (length <= kLongestRun) runs.push_back({first, axis, length});
    }
}

// In the order of the shape's leaves. A run starts beside the surface, where lattice points are known.
std::vector<Run> runsOf(const Shape& shape, const Progress& progress) {
    std::vector<const Shape::TreeType::LeafNodeType*> leaves;
    shape.tree().getNodes(leaves);
    std::vector<std::vector<Run>> ofLeaf(leaves.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 16), [&](const auto& range) {
        progress.check();
        const auto inside = shape.getConstUnsafeAccessor();
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel)
                if (*voxel) addRunsFrom(inside, voxel.getCoord(), ofLeaf[i]);
    });
    std::vector<Run> runs;
    for (const auto& some : ofLeaf) runs.insert(runs.end(), some.begin(), some.end());
    return runs;
}

// Index-space gradient -> a vector along the world normal, but for a rotation: dot products are the world's.
// For axes that are orthogonal, as those of images and meshes are.
Vec3d normalAt(const BSplineField& field, const Vec3d& x, const Vec3d& spacing) {
    Vec3d normal = evaluateGradient(field, x) / spacing;
    normal.normalize();
    return normal;
}

// Middle of the lattice edge where the run enters (end = 0) or leaves (end = 1).
Vec3d crossingOf(const Run& run, int end) {
    Vec3d at = run.first.asVec3d();
    at[run.axis] += end == 0 ? -0.5 : run.length - 0.5;
    return at;
}

// n things in parallel, in pieces that cancel.
template <class Body>
void forEach(std::size_t n, const Progress& progress, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

}  // namespace

ThinParts::ThinParts(const BSplineField& finest, const Progress& progress)
    : transform_(finest.transform().copy()), shape_(finest.shape), spacing_(transform_->voxelSize()) {
    const std::vector<Run> runs = runsOf(*shape_, progress);
    const std::size_t stride = runs.size() / kMostSamples + 1;
    std::vector<Sample> samples(runs.size());
    forEach(runs.size(), progress, [&](std::size_t i) {
        if (i % stride != 0) return;
        const Run& run = runs[i];
        const Vec3d in = normalAt(finest, crossingOf(run, 0), spacing_);
        const Vec3d out = normalAt(finest, crossingOf(run, 1), spacing_);
        if (in.dot(out) > kOpposite) return;
        samples[i].at = (crossingOf(run, 0) + crossingOf(run, 1)) / 2;
        samples[i].normal = (out - in).unit();
        samples[i].axis = run.axis;
        samples[i].length = run.length * spacing_[run.axis];
    });
    for (const Sample& sample : samples)
        if (sample.length > 0) samples_.push_back(sample);
}

// Whether the wall or rod goes on in that direction, one voxel of the level away: whether there is solid
// beside the sample's tangent plane, up to half a voxel off it.
bool ThinParts::goesOn(const Sample& sample, const Vec3d& direction, const Vec3d& levelSpacing) const {
    constexpr int kSteps = 4;  // each side of the plane
    const auto inside = shape_->getConstUnsafeAccessor();
    const double far = (direction * levelSpacing).length(), off = (sample.normal * levelSpacing).length() / 2;
    for (int k = -kSteps; k <= kSteps; ++k)
        if (inside.getValue(
                Coord::round(sample.at + (direction * far + sample.normal * (off * k / kSteps)) / spacing_)))
            return true;
    return false;
}

// In every direction it goes on both ways or neither, and in one it does: so the rim of a wall, which is on
// one side of the sample, and the end of a rod are no heart of it, and a crumb is not either.
bool ThinParts::isHeart(const Sample& sample, const Vec3d& levelSpacing) const {
    constexpr int kDirections = 6;
    const Vec3d& n = sample.normal;
    const Vec3d least = std::abs(n[0]) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d u = n.cross(least).unit(), v = n.cross(u);
    bool any = false;
    for (int k = 0; k < kDirections; ++k) {
        const double angle = std::numbers::pi * k / kDirections;
        const Vec3d direction = u * std::cos(angle) + v * std::sin(angle);
        const bool there = goesOn(sample, direction, levelSpacing);
        if (there != goesOn(sample, -direction, levelSpacing)) return false;
        any = any || there;
    }
    return any;
}

std::vector<double> ThinParts::valuesOn(const BSplineField& level, const Vec3d& spacing,
                                        const Progress& progress) const {
    constexpr double kNotThin = std::numeric_limits<double>::infinity();
    std::vector<double> values(samples_.size(), kNotThin);
    forEach(samples_.size(), progress, [&](std::size_t i) {
        const Sample& sample = samples_[i];
        if (sample.length > kThin * spacing[sample.axis] || !isHeart(sample, spacing)) return;
        const Vec3d world = transform_->indexToWorld(sample.at);
        values[i] = latticeInterpolated(level.controlPoints->getConstUnsafeAccessor(),
                                        level.transform().worldToIndex(world));
    });
    std::erase(values, kNotThin);
    std::sort(values.begin(), values.end());
    return values;
}

double shareInside(const std::vector<double>& ascending, double iso) {
    if (ascending.empty()) return 1;
    const auto inside = std::lower_bound(ascending.begin(), ascending.end(), iso) - ascending.begin();
    return static_cast<double>(inside) / static_cast<double>(ascending.size());
}

double isoThatKeeps(const std::vector<double>& ascending, double share, double limit) {
    if (shareInside(ascending, 0) >= share) return 0;
    // The value at which the share ends; inside is F < iso, so the iso-value is an ulp of float32 above.
    constexpr double kAbove = 1e-6;  // of the limit
    const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(ascending.size())));
    return std::min(limit,
                    ascending[std::clamp<std::size_t>(count, 1, ascending.size()) - 1] + kAbove * limit);
}

}  // namespace isowave
