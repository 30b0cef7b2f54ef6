#include "lod/regions/adaptive_regions.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lod/voxel_edges.h"
#include "volume/blocks.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;

// Samples stand for the surface around them: places are sought beyond a little less than the tolerance, at a spacing of half of it, within
// an eighth and a half of a voxel. With 0.95 samples five times as dense found 1 % more than the tolerance; at a spacing of a voxel,
// twice the tolerance, 10 % more.
constexpr double kAim = 0.9;
constexpr int kMostRounds = 8;
constexpr const char* kStage = "where a finer level is needed";

Coord halved(const Coord& c, const std::array<int, 3>& halvings) {
    return {c.x() >> halvings[0], c.y() >> halvings[1], c.z() >> halvings[2]};
}

// Of the coarse lattice: all control points of both fields.
openvdb::CoordBBox boxOf(const BSplineField& coarse, const BSplineField& fine,
                         const std::array<int, 3>& halvings) {
    openvdb::CoordBBox box = coarse.controlPoints->evalActiveVoxelBoundingBox(),
                       other = fine.controlPoints->evalActiveVoxelBoundingBox();
    if (!other.empty()) {
        box.expand(halved(other.min(), halvings));
        box.expand(halved(other.max(), halvings));
    }
    return box;
}

// Calls each(cell) for the cells that a lattice point is a corner of.
template <class Each>
void forCellsAt(const Coord& corner, const Each& each) {
    for (int n = 0; n < 8; ++n) each(corner.offsetBy(-(n >> 2 & 1), -(n >> 1 & 1), -(n & 1)));
}

}  // namespace

AdaptiveRegions::AdaptiveRegions(const Length& tolerance, const StepOrder& order)
    : asked_(tolerance), order_(order) {}

std::array<int, 3> AdaptiveRegions::halvingsTo(std::size_t level) const {
    std::array<int, 3> to = order_.halvings(order_.stepOf(static_cast<int>(level)));
    const std::array<int, 3> from = order_.halvings(order_.stepOf(static_cast<int>(level) - 1));
    for (std::size_t axis = 0; axis < 3; ++axis) to[axis] -= from[axis];
    return to;
}

void AdaptiveRegions::see(const DrawnLevel& level, const TriangleMesh& mesh, const Progress& progress) {
    assert(order_.levelOf(level.step) == static_cast<int>(seen_.size()));
    const openvdb::math::Transform& lattice = level.field.transform();
    if (seen_.empty()) {
        const double voxel = shortestVoxel(lattice);
        tolerance_ = asked_.unit == Length::Unit::voxels ? asked_.value * voxel : asked_.value;
        level0_.emplace(mesh, std::clamp(tolerance_ / 2, voxel / 8, voxel / 2));
        field0_ = level.field;
        seen_.push_back({lattice.copy(), Cells()});
    } else {
        progress(kStage, 0);
        seen_.push_back({lattice.copy(), badCells(seen_.size(), level.field, mesh, progress)});
    }
}

// From a level's surface to level 0's, and back.
AdaptiveRegions::Apart AdaptiveRegions::apart(const TriangleMesh& mesh, bool howFar,
                                              const Progress& progress) const {
    const double aim = kAim * tolerance_;
    const SampledSurface surface(mesh, level0_->spacing());
    Apart all{surface.farFrom(*level0_, aim, howFar, progress)};
    const std::vector<FarPlace> back = level0_->farFrom(surface, aim, howFar, progress);
    all.places.insert(all.places.end(), back.begin(), back.end());
    if (!howFar) return all;
    for (const FarPlace& place : all.places) all.largest = std::max(all.largest, place.distance);
    // All are within the aim: how near they are takes another look.
    if (all.places.empty())
        all.largest = level0_->farthestFrom(surface, surface.farthestFrom(*level0_, 0, progress), progress);
    return all;
}

Cells AdaptiveRegions::badCells(std::size_t level, const BSplineField& field, const TriangleMesh& mesh,
                                const Progress& progress) const {
    Cells bad;
    openvdb::tree::ValueAccessor<Cells> cells(bad);
    for (const FarPlace& place : apart(mesh, false, progress).places)
        cells.setValueOn(cellAt(field.transform(), place.at));
    for (const Coord& corner : turned(level, field, progress))
        forCellsAt(corner, [&](const Coord& cell) { cells.setValueOn(cell); });
    return bad;
}

// The lattice points that are inside one of the two fields and outside the other, and not near level 0's surface. Such a place has no
// surface of its own where a hole is filled: its middle would stay filled while its walls come back.
std::vector<Coord> AdaptiveRegions::turned(std::size_t level, const BSplineField& field,
                                           const Progress& progress) const {
    const std::array<int, 3> halvings = order_.halvings(order_.stepOf(static_cast<int>(level)));
    const auto onFine = [&](const Coord& c) {
        return Coord(c.x() << halvings[0], c.y() << halvings[1], c.z() << halvings[2]);
    };
    const openvdb::CoordBBox box = boxOf(field, field0_, halvings);
    std::vector<Coord> all;
    if (box.empty()) return all;
    struct Signs {
        openvdb::FloatGrid::ConstUnsafeAccessor coarse, fine;
    };
    const auto isTurned = [&](const Coord& c, Signs& signs) {
        const Coord there = onFine(c);
        if ((signs.coarse.getValue(c) < 0) == (signs.fine.getValue(there) < 0)) return false;
        if ((evaluate(field, c.asVec3d()) < 0) == (evaluate(field0_, there.asVec3d()) < 0)) return false;
        const openvdb::Vec3d world = field.transform().indexToWorld(c);
        return !level0_->isNear({world.x(), world.y(), world.z()}, kAim * tolerance_);
    };
    const auto turnedOf = [&](const Coord& origin, Signs& signs) {
        std::vector<Coord> found;
        for (openvdb::Index n = 0; n < openvdb::BoolTree::LeafNodeType::SIZE; ++n)
            if (const Coord c = origin + openvdb::BoolTree::LeafNodeType::offsetToLocalCoord(n);
                isTurned(c, signs))
                found.push_back(c);
        return found;
    };
    forEachBlock<std::vector<Coord>>(
        box, progress, kStage, turnedOf,
        [&] {
            return Signs{openvdb::FloatGrid::ConstUnsafeAccessor(field.controlPoints->tree()),
                         openvdb::FloatGrid::ConstUnsafeAccessor(field0_.controlPoints->tree())};
        },
        [&](const Coord&, const std::vector<Coord>& found) {
            all.insert(all.end(), found.begin(), found.end());
        });
    return all;
}

AdaptiveRegions::Kept AdaptiveRegions::keptFor(int step) const {
    Kept kept;
    for (std::size_t l = 0; order_.stepOf(static_cast<int>(l)) < step; ++l) {
        kept.push_back(seen_[l + 1].bad);
        if (l > 0) kept[l].topologyUnion(parentsOf(kept[l - 1], halvingsTo(l + 1)));
    }
    return kept;
}

RegionsByStep AdaptiveRegions::regionsOf(const Kept& kept) const {
    RegionsByStep regions;
    for (std::size_t l = 0; l < kept.size(); ++l) {
        if (kept[l].empty()) continue;
        auto cells = std::make_shared<const CellDistance>(kept[l], halvingsTo(l + 1), latticeOf(l));
        regions[order_.stepOf(static_cast<int>(l))].push_back(
            {std::move(cells), 0, longestVoxel(latticeOf(l + 1))});
    }
    return regions;
}

std::size_t AdaptiveRegions::followedAt(const Kept& kept, const Point& place) const {
    std::size_t level = 0;
    while (level < kept.size() && !kept[level].isValueOn(cellAt(latticeOf(level + 1), place))) ++level;
    return level;
}

// Whether anything is new.
bool AdaptiveRegions::add(const Kept& before, Kept& kept, const Point& place) const {
    const std::size_t followed = followedAt(before, place), finer = followed == 0 ? 0 : followed - 1;
    const Coord cell = cellAt(latticeOf(finer + 1), place);
    const int ring = followed == 0 ? 1 : 0;
    bool isNew = false;
    for (int x = -ring; x <= ring; ++x)
        for (int y = -ring; y <= ring; ++y)
            for (int z = -ring; z <= ring; ++z) {
                Coord at = cell.offsetBy(x, y, z);
                for (std::size_t l = finer; l < kept.size(); ++l) {
                    if (l > finer) at = halved(at, halvingsTo(l + 1));
                    isNew = isNew || !kept[l].isValueOn(at);
                    kept[l].setValueOn(at);
                }
            }
    return isNew;
}

bool AdaptiveRegions::widen(Kept& kept, const TriangleMesh& blended, AdaptiveSummary& summary,
                            const Progress& progress) const {
    const auto [places, farthest] = apart(blended, true, progress);
    summary.tolerance = tolerance_;
    summary.farthest = farthest;
    summary.samplesBeyond = std::count_if(places.begin(), places.end(),
                                          [&](const FarPlace& place) { return place.distance > tolerance_; });
    ++summary.rounds;
    if (places.empty() || summary.rounds == kMostRounds) return false;
    bool isNew = false;
    const Kept before = kept;  // what a place follows is what it was measured with
    for (const FarPlace& place : places) isNew = add(before, kept, place.at) || isNew;
    return isNew;
}

}  // namespace isowave::lod
