// A hierarchy of boxes over items 0 .. count - 1, in an order that its user chooses: how it is built, and how
// the nearest item is found. The boxes are the user's.
#pragma once

#include <tbb/parallel_invoke.h>

#include <array>
#include <cstddef>
#include <utility>

namespace isowave {

// A complete binary tree: the root box holds all items, a box's children hold its halves, until a leaf has at
// most mostInLeaf. Box i has children 2i + 1 and 2i + 2; all leaves lie equally deep. Which items a box holds
// depends on count alone, so halves are built in parallel.
class HalvingTree {
  public:
    // REQUIRES: count, mostInLeaf >= 1.
    HalvingTree(std::size_t count, std::size_t mostInLeaf) : count_(count) {
        std::size_t leaves = 1;
        while (leaves * mostInLeaf < count) leaves *= 2;
        firstLeaf_ = leaves - 1;
    }

    struct Range {  // what a box holds
        std::size_t box = 0, begin = 0, end = 0;
        std::size_t size() const { return end - begin; }
        std::size_t middle() const { return begin + (end - begin) / 2; }
        Range left() const { return {2 * box + 1, begin, middle()}; }
        Range right() const { return {2 * box + 2, middle(), end}; }
    };
    Range root() const { return {0, 0, count_}; }
    bool isLeaf(const Range& range) const { return range.box >= firstLeaf_; }
    std::size_t boxCount() const { return 2 * firstLeaf_ + 1; }

    // Calls divide(range) for each box but the leaves, then the same for both halves (in parallel where they
    // are large), then finish(range). divide() puts the items of range.left() before those of range.right().
    template <class Divide, class Finish>
    void build(const Range& range, const Divide& divide, const Finish& finish) const;

    // Calls atLeaf(range) for every leaf that may hold something nearer than `best`, which atLeaf lowers; of
    // two children the nearer one comes first. toBox(i): no distance to what box i holds is less.
    template <class ToBox, class AtLeaf>
    void nearestFirst(const double& best, const ToBox& toBox, const AtLeaf& atLeaf) const;

  private:
    std::size_t count_ = 0, firstLeaf_ = 0;
};

template <class Divide, class Finish>
void HalvingTree::build(const Range& range, const Divide& divide, const Finish& finish) const {
    constexpr std::size_t kParallel = 4096;
    if (!isLeaf(range)) {
        divide(range);
        const auto left = [&] { build(range.left(), divide, finish); };
        const auto right = [&] { build(range.right(), divide, finish); };
        if (range.size() > kParallel) {
            tbb::parallel_invoke(left, right);
        } else {
            left();
            right();
        }
    }
    finish(range);
}

template <class ToBox, class AtLeaf>
void HalvingTree::nearestFirst(const double& best, const ToBox& toBox, const AtLeaf& atLeaf) const {
    // invariant: boxes on the stack and below `at` are all that may hold something nearer. One box a level
    // waits.
    std::array<std::pair<Range, double>, 64> stack;
    std::size_t waiting = 0;
    Range at = root();
    double distance = toBox(at.box);
    while (true) {
        if (distance < best) {
            if (!isLeaf(at)) {
                Range near = at.left(), far = at.right();
                double toNear = toBox(near.box), toFar = toBox(far.box);
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
