#include "volume/walls/thin_places.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "volume/padded_leaf.h"
#include "volume/walls/feet.h"
#include "volume/walls/one_per_cell.h"

// Passes:
//   kinks       lattice points where the distance's gradient turns, by second differences
//   candidates  these and their neighbours, with their feet
//   pairs       opposite neighbours among them -> thin lattice points, middles, thicknesses
//   near        thin lattice points, dilated by two

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;

constexpr double kOpposite = -0.7;   // n.n' of opposite faces is less
constexpr double kParallel = -0.96;  // 16 degrees: a wall that has a thickness, and no wedge
constexpr double kAcross = 0.7;      // share of the way from foot to foot that leads across
constexpr double kClose = 1.5;       // voxels: feet so near to each other need not lie straight across
constexpr double kThinnest = 0.01;   // voxels: faces nearer than that touch
constexpr float kKink = 0.5f;        // least second difference
constexpr double kOnFace = 1e-6;     // squared voxels: a foot lies on a triangle that near
constexpr double kBeyond = 0.3;      // voxels
constexpr double kCell = 0.5;        // voxels, of which one middle is kept
constexpr double kFineBelow = 0.6;   // voxels: middles of thinner walls lie
constexpr double kFine = 0.25;       // so far apart, voxels
constexpr int kAcrossCell =
    4;  // of them to a side of the square that replaces one: 0.75, the diagonal of a cell

void dilate(openvdb::MaskTree& mask, int steps) {
    openvdb::tools::dilateActiveValues(mask, steps, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    mask.voxelizeActiveTiles();
}

void dropEmptyLeaves(openvdb::MaskTree& mask) {
    std::vector<Coord> empty;
    for (auto leaf = mask.cbeginLeaf(); leaf; ++leaf)
        if (leaf->isEmpty()) empty.push_back(leaf->origin());
    for (const Coord& origin : empty) mask.addTile(1, origin, false, false);
}

// ---- kinks

bool isKink(const PaddedLeaf<float, 1, 1>& v, int at) {
    constexpr int kSize = PaddedLeaf<float, 1, 1>::kSize;
    const float* p = &v.values[at];
    for (const int step : {1, kSize, kSize * kSize})
        if (std::abs(p[-step] - 2 * p[0] + p[step]) >= kKink) return true;
    return false;
}

// farthest: lattice points beyond it are left out.
openvdb::MaskTree::Ptr kinksOf(const openvdb::FloatTree& distance, float farthest) {
    auto kinks = std::make_shared<openvdb::MaskTree>(distance, false, openvdb::TopologyCopy());
    openvdb::tree::LeafManager<openvdb::MaskTree> leaves(*kinks);
    leaves.foreach ([&](MaskLeaf& leaf, std::size_t) {
        openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(distance);
        PaddedLeaf<float, 1, 1> v;
        v.gather(values, leaf.origin());
        for (openvdb::Index n = 0; n < 512; ++n) {
            const int at = v.index(int(n >> 6), int(n >> 3 & 7), int(n & 7));
            leaf.setActiveState(n, std::abs(v.values[at]) <= farthest && isKink(v, at));
        }
    });
    dropEmptyLeaves(*kinks);
    return kinks;
}

// ---- pairs

struct Pair {
    double along = 0;  // (n - n').(p' - p)/2: < 0 wall, > 0 gap, 0 no pair
    double apart = 0;  // |p' - p|
    bool isParallel = false;
};

Pair opposite(const Foot& a, const Foot& b, double widest) {
    if (a.normal.dot(b.normal) >= kOpposite) return {};
    const openvdb::Vec3f across = b.at - a.at;
    const double apart = across.length(), along = (a.normal - b.normal).dot(across) / 2;
    if (apart >= widest || std::abs(along) < kThinnest) return {};
    if (std::abs(along) <= kAcross * apart && apart >= kClose) return {};
    return {along, apart, a.normal.dot(b.normal) < kParallel};
}

// One more than the index of the foot of each of a leaf's points and of those around it; 0: none.
PaddedLeaf<std::int32_t, 1, 1> feetAround(const Feet& feet, const Coord& origin) {
    PaddedLeaf<std::int32_t, 1, 1> around;
    const openvdb::tree::ValueAccessor<const openvdb::MaskTree> accessor(feet.mask());
    around.gatherRows(accessor, origin, [&feet](const MaskLeaf& leaf) {
        std::array<std::int32_t, 512> numbers{};
        auto next = static_cast<std::int32_t>(feet.firstOf(leaf));
        for (auto point = leaf.cbeginValueOn(); point; ++point) numbers[point.pos()] = ++next;
        return [numbers](openvdb::Index offset, int count, std::int32_t* out) {
            std::copy_n(numbers.begin() + offset, count, out);
        };
    });
    return around;
}

struct LeafPairs {
    // Of walls and gaps below a voxel: `distance` is the thickness, `normal` points away from the other foot.
    std::vector<Foot> wallFeet, gapFeet;
    std::vector<float> thicknesses;
};

// What point n of a leaf sees among its 26 neighbours. -> whether any is opposite.
bool pairsOf(const PaddedLeaf<std::int32_t, 1, 1>& around, int at, const Feet& feet, double widest,
             LeafPairs& pairs) {
    constexpr int kSize = PaddedLeaf<std::int32_t, 1, 1>::kSize;
    const Foot& foot = feet.all()[std::size_t(around.values[at] - 1)];
    double wall = widest;
    bool isThin = false;
    for (int b = 0; b < 27 && foot.isThere(); ++b) {
        const int step = ((b / 9 - 1) * kSize + b / 3 % 3 - 1) * kSize + b % 3 - 1;
        const std::int32_t other = around.values[at + step];
        if (other == 0 || step == 0) continue;
        const Pair pair = opposite(foot, feet.all()[std::size_t(other - 1)], widest);
        isThin = isThin || pair.along != 0;
        if (pair.along < 0 && pair.isParallel) wall = std::min(wall, -pair.along);
        if (pair.along == 0 || std::abs(pair.along) >= 1 || pair.apart >= kClose) continue;
        const float toSolid = pair.along < 0 ? 1.0f : -1.0f;
        (pair.along < 0 ? pairs.wallFeet : pairs.gapFeet)
            .push_back({foot.at, foot.normal * toSolid, static_cast<float>(std::abs(pair.along))});
    }
    if (wall < widest) pairs.thicknesses.push_back(static_cast<float>(wall));
    return isThin;
}

// Turns the leaf's points off that have no opposite neighbour.
LeafPairs pairsIn(MaskLeaf& leaf, const Feet& feet, double widest) {
    const auto around = feetAround(feet, leaf.origin());
    LeafPairs pairs;
    for (openvdb::Index n = 0; n < 512; ++n) {
        const int at = around.index(int(n >> 6), int(n >> 3 & 7), int(n & 7));
        if (leaf.isValueOn(n)) leaf.setActiveState(n, pairsOf(around, at, feet, widest, pairs));
    }
    return pairs;
}

// The middle of the wall behind a foot, of about the thickness given; of thickness 0: none there.
WallMiddle middleOf(const Vec3d& foot, const Vec3d& normal, double thickness,
                    const TriangleHierarchy& triangles) {
    const WallBehind behind = wallBehind(foot, normal, thickness + kBeyond, triangles);
    Vec3d across = normal - behind.normal;
    across.normalize();
    return {(foot + behind.at) / 2, across, behind.thickness};
}

// More middles round those of walls too thin for the lattice, from places kFine apart in the plane of the wall.
void addBetween(std::vector<WallMiddle>& middles, const TriangleHierarchy& triangles) {
    std::vector<WallMiddle> thin;
    for (const WallMiddle& m : middles)
        if (m.thickness < kFineBelow) thin.push_back(m);
    std::vector<WallMiddle> more(thin.size() * kAcrossCell * kAcrossCell);
    tbb::parallel_for(std::size_t(0), more.size(), [&](std::size_t i) {
        const WallMiddle& m = thin[i / (kAcrossCell * kAcrossCell)];
        const auto n = static_cast<int>(i % (kAcrossCell * kAcrossCell));
        const Vec3d u = m.normal.getArbPerpendicular(), w = m.normal.cross(u);
        const auto step = [](int k) { return (k - (kAcrossCell - 1) / 2.0) * kFine; };
        const Vec3d x = m.at + u * step(n % kAcrossCell) + w * step(n / kAcrossCell);
        const auto nearest = triangles.nearest(x, {1.0, -1});
        if (nearest.triangle < 0) return;
        const Vec3d foot = triangles.footOn(nearest.triangle, x);
        Vec3d normal = triangles.areaNormal(nearest.triangle);
        if (!normal.normalize()) return;
        if (normal.dot(foot - m.at) < 0) normal = -normal;
        more[i] = middleOf(foot, normal, m.thickness, triangles);
    });
    std::erase_if(more,
                  [](const WallMiddle& m) { return m.thickness < kThinnest || m.thickness >= kFineBelow; });
    std::erase_if(middles, [](const WallMiddle& m) { return m.thickness < kFineBelow; });
    more = onePerCell(
        more, kFine, [](const WallMiddle& m) { return m.at; },
        [](const WallMiddle& m) { return m.thickness; });
    middles.insert(middles.end(), more.begin(), more.end());
}

// One in each cell, more where the wall or gap is too thin for the lattice.
std::vector<WallMiddle> middlesOf(const std::vector<Foot>& all, const TriangleHierarchy& triangles) {
    const std::vector<Foot> feet = onePerCell(
        all, kCell, [](const Foot& f) { return f.at - f.normal * (f.distance / 2); },
        [](const Foot& f) { return f.distance; });
    std::vector<WallMiddle> middles(feet.size());
    tbb::parallel_for(std::size_t(0), feet.size(), [&](std::size_t i) {
        middles[i] = middleOf(Vec3d(feet[i].at), Vec3d(feet[i].normal), feet[i].distance, triangles);
    });
    std::erase_if(middles, [](const WallMiddle& m) { return m.thickness < kThinnest || m.thickness >= 1; });
    addBetween(middles, triangles);
    return middles;
}

}  // namespace

WallBehind wallBehind(const Vec3d& foot, const Vec3d& normal, double depth,
                      const TriangleHierarchy& triangles) {
    const Vec3d beyond = foot - normal * depth;
    const auto nearest = triangles.nearest(beyond, {1.0, -1}), own = triangles.nearest(foot, {kOnFace, -1});
    if (nearest.triangle < 0 || own.triangle < 0) return {};
    WallBehind wall{triangles.footOn(nearest.triangle, beyond), triangles.areaNormal(nearest.triangle)};
    if (!wall.normal.normalize()) return {};
    // Which way the other face looks its winding tells, as far as that of the foot's own face is right.
    if (triangles.areaNormal(own.triangle).dot(normal) < 0) wall.normal = -wall.normal;
    const double thickness = normal.dot(foot - wall.at);
    if (wall.normal.dot(normal) < kOpposite && thickness > kThinnest) wall.thickness = thickness;
    return wall;
}

ThinPlaces thinPlaces(const openvdb::FloatTree& distance, const TriangleHierarchy& triangles, double widest,
                      const Progress& progress) {
    // Opposite neighbours lie on either side of the middle, so at most half the thickness from their feet; the
    // points beside a kink one step more.
    const auto farthest = static_cast<float>(widest / 2 + 0.1);
    ThinPlaces places;
    places.near = kinksOf(distance, farthest);
    if (places.near->empty()) return places;
    dilate(*places.near, 1);
    const Feet feet(*places.near, distance, triangles, farthest, progress);

    openvdb::tree::LeafManager<openvdb::MaskTree> leaves(*places.near);
    std::vector<LeafPairs> pairs(leaves.leafCount());
    leaves.foreach ([&](MaskLeaf& leaf, std::size_t i) { pairs[i] = pairsIn(leaf, feet, widest); });
    dropEmptyLeaves(*places.near);
    dilate(*places.near, 2);

    std::vector<Foot> walls, gaps;
    for (const LeafPairs& leaf : pairs) {
        walls.insert(walls.end(), leaf.wallFeet.begin(), leaf.wallFeet.end());
        gaps.insert(gaps.end(), leaf.gapFeet.begin(), leaf.gapFeet.end());
        places.thicknesses.insert(places.thicknesses.end(), leaf.thicknesses.begin(), leaf.thicknesses.end());
    }
    std::sort(places.thicknesses.begin(), places.thicknesses.end());
    places.middles = middlesOf(walls, triangles);
    places.gaps = middlesOf(gaps, triangles);
    return places;
}

}  // namespace isowave
