#include "compress/coder/lattice_values.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compress/coder/window.h"

namespace isowave::compress {
namespace {

// Three planes of values with a margin of one point around each.
class Planes {
  public:
    Planes(const Lattice& lattice, const std::vector<float>& c, float K, const Flags* inside)
        : lattice_(lattice),
          c_(c),
          K_(K),
          inside_(inside),
          stride_(static_cast<std::size_t>(lattice.size[2]) + 2),
          planes_(3, std::vector<float>(stride_ * (static_cast<std::size_t>(lattice.size[1]) + 2), K)) {}

    // Planes beyond the box are outside.
    void load(int x) {
        std::vector<float>& plane = planes_[static_cast<std::size_t>(x + 3) % 3];
        std::fill(plane.begin(), plane.end(), K_);
        if (x < 0 || x >= lattice_.size[0]) return;
        for (int y = 0; y < lattice_.size[1]; ++y)
            loadRow(x, y, plane.data() + (static_cast<std::size_t>(y) + 1) * stride_ + 1);
    }
    // a: the weight of both neighbours along an axis; b: that of the point itself
    double sum(int x, int y, int z, double a, double b) const {
        const std::size_t at = (static_cast<std::size_t>(y) + 1) * stride_ + static_cast<std::size_t>(z) + 1;
        return a * square(x - 1, at, a, b) + b * square(x, at, a, b) + a * square(x + 1, at, a, b);
    }

  private:
    void loadRow(int x, int y, float* to) const {
        const std::size_t row = lattice_.rowOf(x, y), last = lattice_.rowStart[row + 1];
        for (std::size_t i = lattice_.rowStart[row]; i < last; ++i) {
            to[lattice_.z[i]] = c_[i];
            if (i + 1 == last) break;
            const bool negative = inside_ ? (*inside_)[i] != 0 : c_[i] < 0;
            std::fill(to + lattice_.z[i] + 1, to + lattice_.z[i + 1], negative ? -K_ : K_);
        }
    }
    double square(int x, std::size_t at, double a, double b) const {
        const float* p = planes_[static_cast<std::size_t>(x + 3) % 3].data() + at;
        const auto line = [&](const float* q) { return a * q[-1] + b * q[0] + a * q[1]; };
        return a * line(p - stride_) + b * line(p) + a * line(p + stride_);
    }

    const Lattice& lattice_;
    const std::vector<float>& c_;
    float K_;
    const Flags* inside_;
    std::size_t stride_;
    std::vector<std::vector<float>> planes_;
};

// take(point, sum) at every known point.
template <class Take>
void filter(const Lattice& lattice, const std::vector<float>& c, float K, const Flags* inside, double a,
            double b, const Take& take) {
    constexpr int kSlab = 16;  // planes: two more are loaded for each slab
    tbb::parallel_for(tbb::blocked_range<int>(0, lattice.size[0], kSlab),
                      [&](const tbb::blocked_range<int>& slab) {
                          Planes planes(lattice, c, K, inside);
                          planes.load(slab.begin() - 1);
                          planes.load(slab.begin());
                          for (int x = slab.begin(); x < slab.end(); ++x) {
                              planes.load(x + 1);
                              for (int y = 0; y < lattice.size[1]; ++y)
                                  for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                                       i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                                      take(i, planes.sum(x, y, lattice.z[i], a, b));
                          }
                      });
}

}  // namespace

std::vector<float> latticeValues(const Lattice& lattice, const std::vector<float>& c, float K,
                                 const Flags* inside) {
    std::vector<float> F(lattice.pointCount());
    filter(lattice, c, K, inside, 1, 4,
           [&](std::size_t i, double sum) { F[i] = static_cast<float>(sum / 216); });
    return F;
}

Flags nearSurface(const Lattice& lattice, const Flags& inside) {
    std::vector<float> sign(inside.size());
    std::transform(inside.begin(), inside.end(), sign.begin(),
                   [](std::uint8_t in) { return in ? -1.0f : 1.0f; });
    Flags near(inside.size());
    filter(lattice, sign, 1, nullptr, 1, 1,
           [&](std::size_t i, double sum) { near[i] = std::abs(sum) < 26.5; });
    return near;
}

Change changeNear(const Lattice& lattice, const std::vector<float>& before, const std::vector<float>& after,
                  float K, const Flags& inside) {
    const Flags near = nearSurface(lattice, inside);
    const std::vector<float> F = latticeValues(lattice, before, K, &inside),
                             G = latticeValues(lattice, after, K, &inside);
    Change change;
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < F.size(); ++i) {
        if (!near[i]) continue;
        const double error = std::abs(static_cast<double>(F[i]) - G[i]) / K;
        change.largest = std::max(change.largest, error);
        squares += error * error;
        ++count;
    }
    change.rms = std::sqrt(squares / std::max(count, 1.0));
    return change;
}

double medianSlope(const Lattice& lattice, const std::vector<float>& c, float K, const Flags& inside) {
    const Flags near = nearSurface(lattice, inside);
    const std::vector<float> F = latticeValues(lattice, c, K, &inside);
    std::vector<double> slopes;
    Window<float> window(lattice.size, K);
    walk(lattice, 0, lattice.size[0], window, [&](std::size_t i) {
        const auto step = [&](const Back& o) { return static_cast<double>(F[i]) - window.at(o); };
        if (near[i]) slopes.push_back(std::hypot(step({-1, 0, 0}), step({0, -1, 0}), step({0, 0, -1})));
        window.here() = F[i];
        return inside[i] ? -K : K;
    });
    if (slopes.empty()) return K / 4.0;
    const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
    std::nth_element(slopes.begin(), middle, slopes.end());
    return std::max(*middle, 1e-6);
}

}  // namespace isowave::compress
