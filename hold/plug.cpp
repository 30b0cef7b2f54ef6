#include "hold/plug.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "hold/mesh_lattice.h"
#include "hold/simple_point.h"

namespace isowave {
namespace {

using openvdb::Coord;

// A cube of places about the saddle, lattice points and halfway between them: coordinates and indices are the
// cube's own, lattice points have even ones.
class Grower {
  public:
    Grower(const BSplineField& fine, const Coord& at, bool fill, float height, int radius)
        : fill_(fill),
          radius_(2 * radius),
          low_(at.offsetBy(-radius - 2)),
          values_(halfwayValues(fine, low_, Coord(2 * radius + 5))),
          signs_(values_) {
        at_ = values_.index(2 * (radius + 2), 2 * (radius + 2), 2 * (radius + 2));
        for (int n = 0; n < 27; ++n)
            near_[n] = (n / 9 - 1) * signs_.stride(0) + (n / 3 % 3 - 1) * signs_.stride(1) + n % 3 - 1;
        height_ = std::max(height, this->height(at_));
        orderAround();
    }

    std::vector<Coord> run() {
        std::vector<Coord> plug;
        if (isX(at_)) return plug;
        grow();
        if (flipIfSimple(at_)) return plug;
        flip(at_);
        if (!isAttached()) return plug;
        prune();
        grown_.push_back(at_);
        for (const std::int64_t i : grown_) plug.push_back(low_ + (values_.point(i) >> 1));
        std::sort(plug.begin(), plug.end());
        return plug;
    }

  private:
    bool isX(std::int64_t i) const { return signs_.inside(i) == fill_; }
    float height(std::int64_t i) const { return std::abs(values_.values[i]); }
    int squared(std::int64_t i) const {  // distance from the saddle, half lattice steps
        const Coord d = values_.point(i) - values_.point(at_);
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    }
    bool mayGrow(std::int64_t i) const {
        return !isX(i) && i != at_ && height(i) <= height_ && squared(i) <= radius_ * radius_;
    }
    Neighbours neighboursOf(std::int64_t i) const {
        // Simple points are the same for a set and its complement, the ways of joining changed with them.
        Neighbours inside = 0;
        for (int n = 0; n < 27; ++n) inside |= static_cast<Neighbours>(signs_.inside(i + near_[n])) << n;
        return inside & ~(1u << kCentreBit);
    }

    // Whether the saddle is joined to more of X: along an axis, or across a face.
    bool isAttached() const {
        for (int n = 0; n < 27; ++n) {
            const int axes = simple_point::differing(n, kCentreBit);
            if ((axes == 1 || (axes == 2 && isX(at_ + near_[n]))) && isX(at_ + 2 * near_[n])) return true;
        }
        return false;
    }

    // Places around a lattice point: edges, faces, cells, each after what it follows from.
    void orderAround() {
        int next = 0;
        for (int odd = 1; odd <= 3; ++odd)
            for (int n = 0; n < 27; ++n)
                if (simple_point::differing(n, kCentreBit) == odd) around_[next++] = n;
    }
    // Puts a lattice point on the other side, and all that follows from it.
    void flip(std::int64_t i) {
        signs_.set(i, !signs_.inside(i));
        const Coord at = values_.point(i);
        for (const int n : around_)
            signs_.set(i + near_[n],
                       signs_.derived(i + near_[n], at.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1)));
    }
    // A lattice point is simple when the places that change with it can do so one by one, each simple in its turn.
    // -> whether it was, and is flipped.
    bool flipIfSimple(std::int64_t i) {
        std::array<char, 27> before, after;
        for (int n = 0; n < 27; ++n) before[n] = signs_.inside(i + near_[n]);
        flip(i);
        for (int n = 0; n < 27; ++n) after[n] = signs_.inside(i + near_[n]);
        for (int n = 0; n < 27; ++n) signs_.set(i + near_[n], before[n]);
        int left = 0;
        for (int n = 0; n < 27; ++n) left += before[n] != after[n];
        for (int last = 0; left != 0 && left != last;) {
            last = left;
            for (int n = 0; n < 27; ++n) {
                const std::int64_t place = i + near_[n];
                if (signs_.inside(place) == (after[n] != 0) || !isSimple(neighboursOf(place))) continue;
                signs_.set(place, after[n] != 0);
                --left;
            }
        }
        if (left != 0)
            for (int n = 0; n < 27; ++n) signs_.set(i + near_[n], before[n]);
        return left == 0;
    }

    struct Next {
        float height;
        int squared;
        std::int64_t at;
        bool operator<(const Next& b) const {  // of a heap whose top is the lowest
            if (height != b.height) return height > b.height;
            return squared != b.squared ? squared > b.squared : at > b.at;
        }
    };
    void push(std::int64_t i) {
        if (mayGrow(i)) heap_.push({height(i), squared(i), i});
    }
    // invariant: a point that is not on the heap was not simple when its neighbours last changed.
    void grow() {
        const int side = values_.size[0];
        for (int x = 2; x < side - 2; x += 2)
            for (int y = 2; y < side - 2; y += 2)
                for (int z = 2; z < side - 2; z += 2) push(values_.index(x, y, z));
        while (!heap_.empty()) {
            const std::int64_t i = heap_.top().at;
            heap_.pop();
            if (isX(i) || !flipIfSimple(i)) continue;
            grown_.push_back(i);
            for (const std::int64_t step : near_) push(i + 2 * step);
        }
    }
    // Passes until one takes nothing: what was not simple may be so once others are gone.
    void prune() {
        std::sort(grown_.begin(), grown_.end(), [&](std::int64_t a, std::int64_t b) {
            const int da = squared(a), db = squared(b);
            if (da != db) return da > db;
            return height(a) != height(b) ? height(a) > height(b) : a < b;
        });
        for (std::size_t before = 0; before != grown_.size();) {
            before = grown_.size();
            std::erase_if(grown_, [&](std::int64_t i) { return flipIfSimple(i); });
        }
    }

    bool fill_;
    int radius_;  // half lattice steps
    Coord low_;
    LatticeFunction values_;
    DecidedSigns signs_;
    std::int64_t at_ = 0;
    float height_ = 0;  // up to which X grows
    std::array<std::int64_t, 27> near_{};
    std::array<int, 26> around_{};
    std::vector<std::int64_t> grown_;
    std::priority_queue<Next> heap_;
};

}  // namespace

std::vector<Coord> leastPlug(const BSplineField& fine, const Coord& at, bool fill, float height, int radius) {
    return Grower(fine, at, fill, height, radius).run();
}

}  // namespace isowave
