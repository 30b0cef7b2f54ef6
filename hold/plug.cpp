#include "hold/plug.h"

#include <algorithm>
#include <queue>

#include "hold/simple_point.h"

namespace isowave {
namespace {

using openvdb::Coord;

// A cube of lattice points about the saddle; coordinates and indices are the cube's own.
class Grower {
  public:
    Grower(const MeshLattice& lattice, std::int64_t at, bool fill, int radius)
        : lattice_(lattice), radius_(radius), side_(2 * radius + 3) {
        low_ = lattice.coordOf(at).offsetBy(-radius - 1);
        const auto count = static_cast<std::size_t>(side_) * side_ * side_;
        height_.resize(count);
        isX_.resize(count);
        std::size_t i = 0;
        for (int x = 0; x < side_; ++x)
            for (int y = 0; y < side_; ++y)
                for (int z = 0; z < side_; ++z, ++i) {
                    const float f = lattice.at(low_.offsetBy(x, y, z));
                    isX_[i] = (f < 0) == fill;
                    height_[i] = std::abs(f);
                }
        at_ = index(radius + 1, radius + 1, radius + 1);
        for (int n = 0; n < 27; ++n)
            offsets_[n] = ((n / 9 - 1) * side_ + n / 3 % 3 - 1) * side_ + n % 3 - 1;
    }

    std::optional<Plug> run() {
        if (isX_[at_]) return {};
        grow();
        const Neighbours x = neighboursOf(at_);
        if (isSimple(x)) return {};
        Plug plug;
        plug.touchedOfX = touchedOfX(x);
        plug.touchedOfY = touchedOfY(x);
        isX_[at_] = true;
        prune();
        grown_.push_back(at_);
        for (const int i : grown_)
            if (const Coord c = low_ + coordOf(i); lattice_.contains(c)) plug.points.push_back(lattice_.indexOf(c));
        std::sort(plug.points.begin(), plug.points.end());
        return plug;
    }

  private:
    int index(int x, int y, int z) const { return (x * side_ + y) * side_ + z; }
    Coord coordOf(int i) const { return {i / side_ / side_, i / side_ % side_, i % side_}; }
    int squared(int i) const {
        const Coord d = coordOf(i).offsetBy(-radius_ - 1);
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    }
    bool mayGrow(int i) const {
        return !isX_[i] && i != at_ && height_[i] <= height_[at_] && squared(i) <= radius_ * radius_;
    }
    // REQUIRES: not on the cube's border, where nothing grows.
    Neighbours neighboursOf(int i) const {
        Neighbours x = 0;
        for (int n = 0; n < 27; ++n) x |= static_cast<Neighbours>(isX_[i + offsets_[n]]) << n;
        return x & ~(1u << kCentreBit);
    }

    struct Next {
        float height;
        int squared, at;
        bool operator<(const Next& b) const {  // of a heap whose top is the lowest
            if (height != b.height) return height > b.height;
            return squared != b.squared ? squared > b.squared : at > b.at;
        }
    };
    void pushAround(int i) {
        for (int n = 0; n < 27; ++n)
            if (const int j = i + offsets_[n]; mayGrow(j)) heap_.push({height_[j], squared(j), j});
    }
    // invariant: a point that is not on the heap was not simple when its neighbours last changed.
    void grow() {
        for (int i = 0; i < static_cast<int>(isX_.size()); ++i)
            if (mayGrow(i) && neighboursOf(i) != 0) heap_.push({height_[i], squared(i), i});
        while (!heap_.empty()) {
            const int i = heap_.top().at;
            heap_.pop();
            if (isX_[i] || !isSimple(neighboursOf(i))) continue;
            isX_[i] = true;
            grown_.push_back(i);
            pushAround(i);
        }
    }
    // Passes until one takes nothing: what was not simple may be so once others are gone.
    void prune() {
        std::sort(grown_.begin(), grown_.end(), [&](int a, int b) {
            const int da = squared(a), db = squared(b);
            if (da != db) return da > db;
            return height_[a] != height_[b] ? height_[a] > height_[b] : a < b;
        });
        for (std::size_t before = 0; before != grown_.size();) {
            before = grown_.size();
            std::erase_if(grown_, [&](int i) {
                if (!isSimple(neighboursOf(i))) return false;
                isX_[i] = false;
                return true;
            });
        }
    }

    const MeshLattice& lattice_;
    int radius_, side_, at_ = 0;
    Coord low_;
    std::vector<float> height_;
    std::vector<char> isX_;
    std::array<int, 27> offsets_{};
    std::vector<int> grown_;
    std::priority_queue<Next> heap_;
};

}  // namespace

std::optional<Plug> leastPlug(const MeshLattice& lattice, std::int64_t at, bool fill, int radius) {
    return Grower(lattice, at, fill, radius).run();
}

}  // namespace isowave
