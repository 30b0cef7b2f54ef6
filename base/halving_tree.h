// The shape of a hierarchy of boxes over 0 .. count - 1, in an order of its user's, and the way to the nearest of them.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace isowave {

// A complete binary tree: the root is all, a node's children are its halves, until a leaf has at most mostInLeaf. Node i
// has children 2i + 1 and 2i + 2; all leaves lie equally deep. The shape depends on count alone, so that halves are built
// in parallel.
class HalvingTree {
  public:
    // REQUIRES: count, mostInLeaf >= 1.
    HalvingTree(std::size_t count, std::size_t mostInLeaf) : count_(count) {
        std::size_t leaves = 1;
        while (leaves * mostInLeaf < count) leaves *= 2;
        firstLeaf_ = leaves - 1;
    }

    struct Range {  // what a node holds
        std::size_t node = 0, begin = 0, end = 0;
        std::size_t size() const { return end - begin; }
        std::size_t middle() const { return begin + (end - begin) / 2; }
        Range left() const { return {2 * node + 1, begin, middle()}; }
        Range right() const { return {2 * node + 2, middle(), end}; }
    };
    Range root() const { return {0, 0, count_}; }
    bool isLeaf(const Range& range) const { return range.node >= firstLeaf_; }
    std::size_t nodeCount() const { return 2 * firstLeaf_ + 1; }

    // Calls atLeaf(range) for every leaf that may hold something nearer than `best`, which atLeaf lowers; of two children
    // the nearer one comes first. toNode(i): no distance to what node i holds is less.
    template <class ToNode, class AtLeaf>
    void nearestFirst(const double& best, const ToNode& toNode, const AtLeaf& atLeaf) const;

  private:
    std::size_t count_ = 0, firstLeaf_ = 0;
};

template <class ToNode, class AtLeaf>
void HalvingTree::nearestFirst(const double& best, const ToNode& toNode, const AtLeaf& atLeaf) const {
    // invariant: nodes on the stack and below `at` are all that may hold something nearer. One node a level waits.
    std::array<std::pair<Range, double>, 64> stack;
    std::size_t waiting = 0;
    Range at = root();
    double distance = toNode(at.node);
    while (true) {
        if (distance < best) {
            if (!isLeaf(at)) {
                Range near = at.left(), far = at.right();
                double toNear = toNode(near.node), toFar = toNode(far.node);
                if (toFar < toNear) {
                    std::swap(near, far);
                    std::swap(toNear, toFar);
                }
                if (toFar < best) stack[waiting++] = {far, toFar};
                at = near;
                distance = toNear;
                continue;
            }
            atLeaf(at);
        }
        if (waiting == 0) return;
        --waiting;
        at = stack[waiting].first;
        distance = stack[waiting].second;
    }
}

}  // namespace isowave
