// collapse = pilot -> rounds. In a round space is cut into cubes, the blocks, half a block off those of the round before.
// Blocks are worked on in parallel, each with a heap of its own (polygonize/collapse/block.h): load -> collapse -> store.
#include "polygonize/quadric_collapse.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/triangle.h"
#include "polygonize/collapse/block.h"

namespace isowave {
namespace {

using namespace collapse;

// ---- all blocks

constexpr double kBlockSide = 48, kCellSide = 2;  // mean edges

bool isKept(const std::vector<char>& kept, const Triangle& t) {
    return !kept.empty() && kept[t[0]] && kept[t[1]] && kept[t[2]];
}

// Of a sample of triangles: every k-th, if it is not kept.
double meanEdge(const TriangleMesh& mesh, const std::vector<char>& kept) {
    constexpr std::size_t kSample = 1 << 16;
    const std::size_t stride = mesh.triangles.size() / kSample + 1;
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
        const Triangle& t = mesh.triangles[i];
        if (isKept(kept, t)) continue;
        ++count;
        for (int k = 0; k < 3; ++k)
            sum += length(toVec3(mesh.points[t[(k + 1) % 3]]) - toVec3(mesh.points[t[k]]));
    }
    return count == 0 ? 0 : sum / (3 * static_cast<double>(count));
}

class Collapsing {
  public:
    Collapsing(TriangleMesh& mesh, const CollapseOptions& options, const Progress& progress)
        : mesh_(mesh),
          kept_(options.kept),
          progress_(progress),
          wanted_(static_cast<std::int64_t>(mesh.triangles.size())) {
        wanted_ = std::max<std::int64_t>(0, (wanted_ - options.triangles + 1) / 2);
        if (options.longest > 0) limits_.longest2 = options.longest * options.longest;
        if (options.deviation > 0) limits_.deviation2 = options.deviation * options.deviation;
        for (const Point& p : mesh.points) bounds_.add(toVec3(p));
        quadrics_.resize(mesh.points.size());
    }

    // The first two rounds take all that the pilot found to be cheap enough, the second one at the borders of the first
    // one's blocks. Later ones share out what is left to do.
    CollapseReport run() {
        if (wanted_ == 0) return report_;
        cut(0);
        double cost = isSmall() || isBounded() ? kInfinity : pilot();
        const int patience = isBounded() ? kPatienceBounded : kPatience;
        for (int round = 0, idle = 0; left() > 0 && idle < patience; ++round) {
            progress_("collapsing", static_cast<double>(report_.collapsed) / static_cast<double>(wanted_));
            if (round > 0) cut(round);
            if (round > 1) cost = idle > 0 ? kInfinity : kRaise * cost;
            const std::int64_t before = report_.collapsed, toDo = left();
            work(round, cost);
            idle = report_.collapsed - before < toDo / kIdle + 1 ? idle + 1 : 0;
            ++report_.rounds;
        }
        return report_;
    }

  private:
    static constexpr std::size_t kSmall = 50'000;  // triangles
    static constexpr int kPatience = 4;            // idle rounds: every shift was tried
    static constexpr int kPatienceBounded = 2;  // what is refused once is refused again, but beside borders
    static constexpr std::int64_t kIdle =
        100;                                // a round is idle that does less than this part of what is left
    static constexpr double kRaise = 2;     // of the cost allowed, from round to round
    static constexpr double kShort = 0.97;  // of the collapses wanted are left to the pilot's cost

    std::int64_t left() const { return wanted_ - report_.collapsed; }

    // The blocks of a round, and the triangles that overlap each.
    void cut(int round) {
        constexpr std::array<double, 4> kShift{0, 0.5, 0.25, 0.75};  // of a block
        const double edge = meanEdge(mesh_, kept_);
        cell_ = kCellSide * edge;
        layBlocks(kBlockSide * edge, kShift[static_cast<std::size_t>(round) % kShift.size()]);
        first_.assign(blocks_.size() + 1, 0);
        std::vector<Cell> cells(mesh_.points.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 4096), [&](const auto& range) {
            for (std::size_t v = range.begin(); v != range.end(); ++v)
                cells[v] = blocks_.cellOf(toVec3(mesh_.points[v]));
        });
        const auto forBlocks = [&](const Triangle& t, const auto& each) {
            Cell low = cells[t[0]], high = low;
            for (int k = 1; k < 3; ++k)
                for (int a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], cells[t[k]][a]);
                    high[a] = std::max(high[a], cells[t[k]][a]);
                }
            blocks_.forCells(low, high, [&](std::size_t block) { return each(block), true; });
        };
        for (const Triangle& t : mesh_.triangles)
            forBlocks(t, [&](std::size_t block) { ++first_[block + 1]; });
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        listed_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (Index t = 0; t < mesh_.triangles.size(); ++t)
            forBlocks(mesh_.triangles[t], [&](std::size_t block) { listed_[next[block]++] = t; });
        used_.clear();
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            if (first_[block] != first_[block + 1]) used_.push_back(block);
    }

    // By the deviation of each collapse: all that it allows are wanted, at any cost.
    bool isBounded() const { return limits_.deviation2 < kInfinity; }

    // One block for all: it is done before a pilot would be.
    bool isSmall() const { return mesh_.triangles.size() <= kSmall; }

    void layBlocks(double side, double shift) {
        Box shifted = bounds_;
        if (!isSmall())
            for (int a = 0; a < 3; ++a) shifted.low[a] -= shift * side;
        blocks_ = latticeOver(shifted, side, isSmall() ? 1 : 1000 + mesh_.triangles.size());
    }

    void load(Block& block, std::size_t used, bool first) const {
        const std::size_t index = used_[used], y = static_cast<std::size_t>(blocks_.count[1]),
                          z = static_cast<std::size_t>(blocks_.count[2]);
        const Cell cell{static_cast<int>(index / (y * z)), static_cast<int>(index / z % y),
                        static_cast<int>(index % z)};
        block.load(mesh_, kept_, quadrics_, first, &listed_[0] + first_[index],
                   &listed_[0] + first_[index + 1], blocks_, cell, cell_);
    }

    // Collapses some of the blocks, in copies, farther than all are to be. Returns the cost up to which about
    // the number of collapses wanted is done.
    double pilot() {
        const std::size_t count = std::min(used_.size(), std::clamp<std::size_t>(used_.size() / 8, 4, 24));
        std::vector<std::vector<double>> costs(count);
        std::vector<std::int64_t> triangles(count);
        forEach(count, [&](Block& block, std::size_t i) {
            load(block, i * used_.size() / count, true);
            triangles[i] = block.freeTriangles();
            block.collapse(limits_, &costs[i]);
        });
        std::vector<double> all;
        for (const auto& some : costs) all.insert(all.end(), some.begin(), some.end());
        std::sort(all.begin(), all.end());
        const double sampled =
            static_cast<double>(std::accumulate(triangles.begin(), triangles.end(), std::int64_t{0})) /
            static_cast<double>(mesh_.triangles.size());
        const auto rank = static_cast<std::size_t>(kShort * sampled * static_cast<double>(wanted_));
        if (all.empty()) return 0;
        return all[std::min(rank, all.size() - 1)];
    }

    void work(int round, double cost) {
        std::vector<Counts> counts(used_.size());
        const std::int64_t toDo = left();
        forEach(used_.size(), [&](Block& block, std::size_t i) {
            Limits limits = limits_;
            limits.cost = cost;
            limits.collapses = round < 2 ? toDo : shareOf(i, toDo);
            load(block, i, round == 0);
            block.collapse(limits, nullptr);
            block.store(mesh_, quadrics_);
            counts[i] = block.counts();
        });
        for (const Counts& r : counts) {
            report_.collapsed += r.collapsed;
            report_.refusedTopology += r.refusedTopology;
            report_.refusedShape += r.refusedShape;
            report_.refusedSheets += r.refusedSheets;
            report_.refusedDeviation += r.refusedDeviation;
        }
        std::erase_if(mesh_.triangles, isDegenerate);
    }

    // Of the collapses that are left, by its triangles, rounded upwards.
    std::int64_t shareOf(std::size_t used, std::int64_t toDo) const {
        const auto has = static_cast<double>(first_[used_[used] + 1] - first_[used_[used]]);
        return static_cast<std::int64_t>(
            std::ceil(static_cast<double>(toDo) * has / static_cast<double>(listed_.size())));
    }

    template <class Each>
    void forEach(std::size_t count, const Each& each) {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const auto& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    progress_.check();
                    each(workspaces_.local(), i);
                }
            },
            tbb::simple_partitioner());
    }

    TriangleMesh& mesh_;
    const std::vector<char>& kept_;
    const Progress& progress_;
    std::int64_t wanted_;  // collapses
    Limits limits_;
    Box bounds_;
    CollapseReport report_;
    std::vector<Quadric> quadrics_;  // by vertex, about it
    Lattice blocks_;
    double cell_ = 0;
    std::vector<std::size_t> first_, used_;  // by block; the blocks that are not empty
    std::vector<Index> listed_;
    tbb::enumerable_thread_specific<Block> workspaces_;
};

void dropUnusedPoints(TriangleMesh& mesh) {
    std::vector<Index> number(mesh.points.size(), kNone);
    for (const Triangle& t : mesh.triangles)
        for (const Index v : t) number[v] = 0;
    Index next = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kNone) continue;
        mesh.points[next] = mesh.points[v];
        number[v] = next++;
    }
    mesh.points.resize(next);
    for (Triangle& t : mesh.triangles)
        for (Index& v : t) v = number[v];
}

}  // namespace

void collapseByQuadrics(TriangleMesh& mesh, const CollapseOptions& options, CollapseReport* report,
                        const Progress& progress) {
    mesh.normals.clear();
    const CollapseReport done = Collapsing(mesh, options, progress).run();
    dropUnusedPoints(mesh);
    progress("collapsing", 1.0);
    if (report) *report = done;
}

}  // namespace isowave
