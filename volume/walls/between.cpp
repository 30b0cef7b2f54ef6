#include "volume/walls/between.h"

#include <openvdb/tree/LeafManager.h>

#include <array>
#include <cmath>

#include "volume/cubic_weights.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;
using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree>;

constexpr int kFinest = 4;
constexpr double kMostKept = 64e6;       // lines and crossings
constexpr double kMostAcross = 1 << 20;  // points of the finer lattice
constexpr double kReach = 2;             // voxels: a wrong sign is never farther from the mesh

std::vector<Vec3d> scaled(std::vector<Vec3d> points, double by) {
    for (Vec3d& p : points) p *= by;
    return points;
}

// F at the points of the finer lattice in one cell, x slowest. One axis after the other: 64 control points at
// first, perVoxel^3 values in the end.
class CellValues {
  public:
    explicit CellValues(int perVoxel) : n_(perVoxel) {
        for (int i = 0; i < n_; ++i) weights_[std::size_t(i)] = cubicWeights(double(i) / n_);
    }

    double at(int i, int j, int k) const { return z_[std::size_t((i * n_ + j) * n_ + k)]; }

    void take(const Accessor& values, const Coord& cell) {
        std::array<double, 64> c;
        std::size_t next = 0;
        for (int i = -1; i < 3; ++i)
            for (int j = -1; j < 3; ++j)
                for (int k = -1; k < 3; ++k) c[next++] = double(values.getValue(cell.offsetBy(i, j, k)));
        const auto n = std::size_t(n_);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t r = 0; r < 16; ++r) x_[i * 16 + r] = sum(i, &c[r], 16);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
                for (std::size_t r = 0; r < 4; ++r) y_[(i * n + j) * 4 + r] = sum(j, &x_[i * 16 + r], 4);
        for (std::size_t ij = 0; ij < n * n; ++ij)
            for (std::size_t k = 0; k < n; ++k) z_[ij * n + k] = sum(k, &y_[ij * 4], 1);
    }

  private:
    double sum(std::size_t i, const double* from, std::size_t step) const {
        const auto& w = weights_[i];
        return w[0] * from[0] + w[1] * from[step] + w[2] * from[2 * step] + w[3] * from[3 * step];
    }

    int n_;
    std::array<std::array<double, 4>, kFinest> weights_;
    std::array<double, 16 * kFinest> x_;
    std::array<double, 4 * kFinest * kFinest> y_;
    std::array<double, kFinest * kFinest * kFinest> z_;
};

class Search {
  public:
    Search(const BSplineField& field, const Coord& shift, const FineSigns& signs,
           const TriangleHierarchy& triangles, double least)
        : field_(field), shift_(shift), signs_(signs), triangles_(triangles), least_(least) {}

    std::vector<WrongPlace> in(const MaskLeaf& leaf) const {
        const Accessor values(field_.controlPoints->tree());
        CellValues cell(signs_.perVoxel());
        std::vector<WrongPlace> found;
        for (auto point = leaf.cbeginValueOn(); point; ++point) {
            cell.take(values, point.getCoord() + shift_);
            addOf(point.getCoord(), cell, found);
        }
        return found;
    }

  private:
    void addOf(const Coord& low, const CellValues& cell, std::vector<WrongPlace>& found) const {
        const int n = signs_.perVoxel();
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                for (int k = 0; k < n; ++k) {
                    const Coord fine(low.x() * n + i, low.y() * n + j, low.z() * n + k);
                    if ((cell.at(i, j, k) < 0) != signs_.inside(fine)) add(fine, found);
                }
    }

    void add(const Coord& fine, std::vector<WrongPlace>& found) const {
        const Vec3d at = fine.asVec3d() / signs_.perVoxel();
        const auto nearest = triangles_.nearest(at, {kReach * kReach, -1});
        if (nearest.triangle < 0 || nearest.squared < least_ * least_) return;
        WrongPlace place{at, signs_.inside(fine), std::sqrt(nearest.squared),
                         triangles_.footOn(nearest.triangle, at), triangles_.areaNormal(nearest.triangle)};
        if (!place.outwards.normalize()) place.outwards = Vec3d(0.0);
        const double height = place.outwards.dot(at - place.foot);
        if ((height < 0) != place.inside) place.outwards = -place.outwards;
        found.push_back(place);
    }

    const BSplineField& field_;
    Coord shift_;
    const FineSigns& signs_;
    const TriangleHierarchy& triangles_;
    double least_;
};

}  // namespace

FineSigns::FineSigns(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles, int perVoxel,
                     bool evenOdd, const Progress& progress)
    : perVoxel_(perVoxel), lines_(scaled(points, perVoxel), triangles, evenOdd, progress) {}

bool componentsTouch(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles,
                     const std::vector<std::uint32_t>& of, std::size_t components, const FineSigns& signs) {
    if (signs.lines().hasOverlap()) return true;
    if (components < 2 || !signs.lines().hasBuried()) return false;
    std::vector<std::vector<Triangle>> parts(components);
    for (const Triangle& t : triangles) parts[of[t[0]]].push_back(t);
    // Of a cavity alone the inside is what is outside of the solid.
    const auto own = [&](const std::vector<Triangle>& part) {
        double six = 0;
        for (const Triangle& t : part)
            six += (points[t[0]] - points[part[0][0]])
                       .dot((points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]));
        const FineSigns alone(points, part, signs.perVoxel(), false);
        return six < 0 ? alone.lines().skippedCount() : alone.lines().buriedCount();
    };
    std::int64_t within = 0;
    for (const auto& part : parts)
        if (!part.empty()) within += own(part);
    return signs.lines().buriedCount() > within;
}

int finestSigns(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles) {
    double twiceArea = 0;
    openvdb::BBoxd box;
    for (const Triangle& t : triangles) {
        twiceArea += (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).length();
        for (const auto corner : t) box.expand(points[corner]);
    }
    const Vec3d extent = box.extents();
    const double kept = extent[1] * extent[2] + twiceArea / 2, longest = extent[box.maxExtent()];
    int perVoxel = kFinest;
    while (perVoxel > 1 && (perVoxel * perVoxel * kept > kMostKept || perVoxel * longest > kMostAcross))
        perVoxel /= 2;
    return perVoxel;
}

std::vector<WrongPlace> wrongPlaces(const BSplineField& field, const Coord& shift,
                                    const openvdb::MaskTree& near, const FineSigns& signs,
                                    const TriangleHierarchy& triangles, double least,
                                    const Progress& progress) {
    const Search search(field, shift, signs, triangles, least);
    openvdb::tree::LeafManager<const openvdb::MaskTree> leaves(near);
    std::vector<std::vector<WrongPlace>> found(leaves.leafCount());
    leaves.foreach ([&](const MaskLeaf& leaf, std::size_t i) {
        progress.check();
        found[i] = search.in(leaf);
    });
    std::vector<WrongPlace> all;
    for (const auto& leaf : found) all.insert(all.end(), leaf.begin(), leaf.end());
    return all;
}

}  // namespace isowave
