#include "volume/repair/loops.h"

#include <array>
#include <cassert>
#include <utility>

namespace isowave::repair {
namespace {

class LoopFinder {
  public:
    LoopFinder(std::vector<BoundaryEdge> edges, std::size_t points, const Progress& progress)
        : edges_(std::move(edges)), cursor_(points), place_(points, kNowhere), progress_(progress) {
        ends_.reserve(2 * edges_.size());
        for (Index e = 0; e < edges_.size(); ++e) {
            ends_.push_back({edges_[e].from, 0, e});
            ends_.push_back({edges_[e].to, 1, e});
        }
        std::sort(ends_.begin(), ends_.end());
        for (std::size_t i = ends_.size(); i-- > 0;) cursor_[ends_[i][0]] = i;
    }

    std::vector<Loop> loops() {
        std::vector<Loop> found;
        for (const BoundaryEdge& edge : edges_) {
            if (!edge.used) walk(edge.from, found);
        }
        return found;
    }

  private:
    // (point, 0 away or 1 towards, edge)
    using End = std::array<Index, 3>;
    static constexpr Index kNowhere = ~Index(0);

    // Walks on until the start has no unused edge left; a point met twice on the way cuts a loop off.
    // invariant: path is a simple path and place_ its inverse; every vertex has an even number of unused
    // edges but for the path's two ends.
    void walk(Index start, std::vector<Loop>& found) {
        std::vector<Index> path{start};
        place_[start] = 0;
        while (true) {
            const auto edge = unusedAt(path.back());
            if (edge == edges_.size()) {
                assert(path.size() == 1);
                place_[start] = kNowhere;
                return;
            }
            edges_[edge].used = true;
            checkNowAndThen(progress_, ++walked_);
            const Index next = edges_[edge].from == path.back() ? edges_[edge].to : edges_[edge].from;
            if (place_[next] == kNowhere) {
                place_[next] = static_cast<Index>(path.size());
                path.push_back(next);
                continue;
            }
            const auto first = path.begin() + place_[next];
            found.emplace_back(first, path.end());
            for (auto point = first + 1; point != path.end(); ++point) place_[*point] = kNowhere;
            path.erase(first + 1, path.end());
        }
    }

    // An edge once used stays used, so a point's cursor never has to go back.
    std::size_t unusedAt(Index point) {
        for (std::size_t& end = cursor_[point]; end < ends_.size() && ends_[end][0] == point; ++end) {
            if (!edges_[ends_[end][2]].used) return ends_[end][2];
        }
        return edges_.size();
    }

    std::vector<BoundaryEdge> edges_;
    std::vector<End> ends_;
    std::vector<std::size_t> cursor_;  // of every point: its first end that may be unused
    std::vector<Index> place_;         // of every point: its index in the path, or kNowhere
    std::size_t walked_ = 0;
    const Progress& progress_;
};

}  // namespace

std::vector<BoundaryEdge> boundaryOf(const std::vector<EdgeUse>& uses) {
    std::vector<BoundaryEdge> boundary;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count % 2 == 0) return;
        const bool backward = balance(use, count) > 0;
        boundary.push_back({backward ? use->high : use->low, backward ? use->low : use->high});
    });
    return boundary;
}

std::vector<Loop> loopsOf(std::vector<BoundaryEdge> edges, std::size_t points, const Progress& progress) {
    return LoopFinder(std::move(edges), points, progress).loops();
}

}  // namespace isowave::repair
