#include "volume/distance/triangle_band.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "volume/distance/triangle_lists.h"
#include "volume/mesh_nearest.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;
using Finish = std::function<void(Leaf&)>;

std::vector<TriangleSoup::Corners> cornersOf(const std::vector<Vec3d>& points,
                                             const std::vector<Triangle>& triangles) {
    std::vector<TriangleSoup::Corners> corners;
    corners.reserve(triangles.size());
    const auto placeOf = [&](std::uint32_t p) { return Place{points[p].x(), points[p].y(), points[p].z()}; };
    for (const Triangle& t : triangles) corners.push_back({placeOf(t[0]), placeOf(t[1]), placeOf(t[2])});
    return corners;
}

// A cube of lattice points.
struct Block {
    Coord origin;
    int size;
};

// The block that holds every lattice point within reach.
Block around(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles, double reach) {
    openvdb::BBoxd box;
    for (const Triangle& t : triangles)
        for (const std::uint32_t p : t) box.expand(points[p]);
    const Coord low = Coord::floor(box.min() - Vec3d(reach)) & ~7,
                high = Coord::ceil(box.max() + Vec3d(reach));
    Block block{low, 16};
    while (block.size <= std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]})) block.size *= 2;
    return block;
}

class Descent {
  public:
    Descent(const TriangleSoup& soup, double reach, const Finish& finish, const Progress& progress)
        : reach_(static_cast<float>(reach)),
          finish_(finish),
          progress_(progress),
          lists_([&soup, reach] { return TriangleLists(soup, reach); }) {}

    void run(const Block& block, TriangleList triangles) {
        all_ = std::pow(double(block.size), 3);
        descend(block, std::move(triangles));
    }

    // Blocks that it has left alone.
    std::vector<Block> crowded() const {
        std::vector<Block> blocks;
        for (const auto& some : crowded_) blocks.insert(blocks.end(), some.begin(), some.end());
        return blocks;
    }

    std::vector<FloatLeafPtr> takeLeaves() {
        std::vector<FloatLeafPtr> leaves;
        for (auto& some : made_) std::move(some.begin(), some.end(), std::back_inserter(leaves));
        return leaves;
    }

  private:
    // Blocks from here on are tasks of their own, and told of.
    static constexpr int kReported = 32;
    // More triangles than these in such a block leave several hundred to each leaf, most of which are nearest to none of its
    // lattice points: a hierarchy that is asked point by point takes three quarters of the time.
    static constexpr std::size_t kCrowded = 4000;

    void descend(const Block& block, TriangleList triangles) {
        if (triangles.empty()) return report(block);
        if (block.size == kReported && triangles.size() > kCrowded) return crowded_.local().push_back(block);
        if (block.size == int(Leaf::DIM)) return measure(block.origin, triangles);
        if (block.size == kReported) progress_.check();
        const int half = block.size / 2;
        std::array<TriangleList, 8> children =
            lists_.local().split(triangles, {block.origin[0], block.origin[1], block.origin[2]}, half);
        TriangleList().swap(triangles);
        const auto child = [&](int n) {
            const Coord origin = block.origin.offsetBy(n & 4 ? half : 0, n & 2 ? half : 0, n & 1 ? half : 0);
            descend({origin, half}, std::move(children[static_cast<std::size_t>(n)]));
        };
        if (block.size >= kReported)
            tbb::parallel_for(0, 8, child);
        else
            for (int n = 0; n < 8; ++n) child(n);
        if (block.size == kReported) report(block);
    }

    void report(const Block& block) {
        if (block.size < kReported) return;
        const std::int64_t volume = std::int64_t(block.size) * block.size * block.size;
        progress_("measuring distances", double(done_ += volume) / all_);
    }

    void measure(const Coord& origin, const TriangleList& triangles) {
        std::array<float, 512> distances;
        if (!lists_.local().distances(triangles, {origin[0], origin[1], origin[2]}, distances.data())) return;
        auto leaf = std::make_unique<Leaf>(origin, reach_, false);
        std::copy(distances.begin(), distances.end(), leaf->buffer().data());
        finish_(*leaf);
        made_.local().push_back(std::move(leaf));
    }

    float reach_;
    const Finish& finish_;
    const Progress& progress_;
    double all_ = 0;
    std::atomic<std::int64_t> done_ = 0;
    tbb::enumerable_thread_specific<TriangleLists> lists_;
    tbb::enumerable_thread_specific<std::vector<FloatLeafPtr>> made_;
    tbb::enumerable_thread_specific<std::vector<Block>> crowded_;
};

// ---- crowded blocks

// The leaf at origin, point by point: each is a neighbour of one before it, whose nearest triangle bounds the distance, so that
// most queries only confirm it. Null where all lattice points are farther than reach.
FloatLeafPtr leafByPoints(const Coord& origin, const TriangleHierarchy& triangles, double reach) {
    const Vec3d middle = origin.asVec3d() + Vec3d(3.5);
    const double toCorner = std::sqrt(3.0) * 3.5, most = reach + toCorner;
    if (triangles.nearest(middle, {most * most, -1}).triangle < 0) return nullptr;
    auto leaf = std::make_unique<Leaf>(origin, static_cast<float>(reach), false);
    std::array<std::int64_t, Leaf::SIZE> nearest;
    float* values = leaf->buffer().data();
    bool any = false;
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
        const Vec3d point = leaf->offsetToGlobalCoord(n).asVec3d();
        const openvdb::Index before = n & 7 ? n - 1 : n & 63 ? n - 8 : n - 64;  // along z, else y, else x
        TriangleHierarchy::Nearest best{reach * reach, -1};
        if (n > 0 && nearest[before] >= 0) {
            const auto guess = triangles.distanceTo(nearest[before], point);
            if (guess.squared < best.squared) best = guess;
        }
        best = triangles.nearest(point, best);
        nearest[n] = best.triangle;
        any |= best.triangle >= 0;
        values[n] = std::min(static_cast<float>(std::sqrt(best.squared)), static_cast<float>(reach));
    }
    return any ? std::move(leaf) : nullptr;
}

void addCrowded(const std::vector<Block>& blocks, const TriangleHierarchy& triangles, double reach,
                const Finish& finish, const Progress& progress, std::vector<FloatLeafPtr>& leaves) {
    constexpr std::size_t kInBlock = 64;  // 4^3
    std::vector<FloatLeafPtr> made(blocks.size() * kInBlock);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, made.size(), 16), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const int n = static_cast<int>(i % kInBlock);
            made[i] = leafByPoints(
                blocks[i / kInBlock].origin.offsetBy(8 * (n >> 4), 8 * (n >> 2 & 3), 8 * (n & 3)), triangles,
                reach);
            if (made[i]) finish(*made[i]);
        }
        progress("measuring distances", double(done += range.size()) / double(made.size()));
    });
    std::move(made.begin(), made.end(), std::back_inserter(leaves));
}

}  // namespace

std::vector<FloatLeafPtr> leavesAround(const std::vector<Vec3d>& points,
                                       const std::vector<Triangle>& triangles, double reach,
                                       const Finish& finish, const Progress& progress) {
    if (triangles.empty()) return {};
    const TriangleSoup soup(cornersOf(points, triangles));
    Descent descent(soup, reach, finish, progress);
    TriangleList all(triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    descent.run(around(points, triangles, reach), std::move(all));
    std::vector<FloatLeafPtr> leaves = descent.takeLeaves();
    if (const std::vector<Block> crowded = descent.crowded(); !crowded.empty())
        addCrowded(crowded, TriangleHierarchy(points, triangles), reach, finish, progress, leaves);
    return leaves;
}

}  // namespace isowave
