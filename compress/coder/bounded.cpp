#include "compress/coder/bounded.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "compress/coder/middle_signs.h"

namespace isowave::compress {
namespace {

constexpr double kMargin =
    1e-5;  // of K: s F has to reach it, so that any order of summation gives the same sign
constexpr int kMostPasses = 200;
constexpr int kMiddlePasses =
    100;  // then middles that are still wrong are left: their mesh is compared, too (lod/packing)
constexpr int kBisections = 9;

template <class Each>
void forEachPoint(std::size_t count, const Each& each) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) each(i);
    });
}

// 0 .. 7, of each point
Flags paritiesOf(const Lattice& lattice) {
    Flags parities(lattice.pointCount());
    for (int x = 0; x < lattice.size[0]; ++x)
        for (int y = 0; y < lattice.size[1]; ++y)
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                 i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                parities[i] = static_cast<std::uint8_t>((x & 1) + 2 * (y & 1) + 4 * (lattice.z[i] & 1));
    return parities;
}

class Search {
  public:
    Search(const BoundedInput& input, double bound, const Progress& progress)
        : in_(input),
          bound_(bound),
          progress_(progress),
          reach_(reachOf(input)),
          near_(nearSurface(input.lattice, input.inside)),
          parities_(paritiesOf(input.lattice)),
          F_(latticeValues(input.lattice, input.c, input.K, &input.inside)),
          middles_(input.lattice, input.inside, input.c) {}

    std::optional<Bounded> run() {
        for (double delta = largestWithoutSigns(); delta >= Quantiser::kLeastDelta;) {
            const Quantiser quantiser(delta, reach_);
            Bounded result{delta, quantised(quantiser), 0};
            if (keepSigns(quantiser, result.indices)) {
                measure(quantiser, result);
                if (result.largest <= bound_) return result;
                delta *= std::clamp(bound_ / result.largest, 0.9, 0.98);
            } else {
                delta *= 0.9;
            }
        }
        return std::nullopt;
    }

  private:
    std::vector<std::int32_t> quantised(const Quantiser& quantiser) const {
        std::vector<std::int32_t> q(in_.c.size());
        const double scale = in_.voxelsPerK / in_.K * kOneVoxel;
        forEachPoint(q.size(), [&](std::size_t i) {
            q[i] = quantiser.index(static_cast<std::int32_t>(std::lround(in_.c[i] * scale)));
        });
        return q;
    }
    std::vector<float> latticeOf(const Quantiser& quantiser, const std::vector<std::int32_t>& q) const {
        progress_("quantising", 0);
        return latticeValues(in_.lattice, valuesOf(q, quantiser, in_.K, in_.voxelsPerK), in_.K, &in_.inside);
    }
    void measure(const Quantiser& quantiser, Bounded& result) const {
        const std::vector<float> F = latticeOf(quantiser, result.indices);
        result.largest = 0;
        for (std::size_t i = 0; i < F.size(); ++i)
            if (near_[i])
                result.largest = std::max(
                    result.largest, std::abs(static_cast<double>(F[i]) - F_[i]) / in_.K * in_.voxelsPerK);
    }
    // Signs only ever make the error larger, so the search with them begins here.
    double largestWithoutSigns() const {
        double low = std::max(bound_ / 4, Quantiser::kLeastDelta),
               high = std::min(bound_ * 4, Quantiser::kMostDelta);
        for (int i = 0; i < kBisections && low < high; ++i) {
            const double middle = std::sqrt(low * high);
            const Quantiser quantiser(middle, reach_);
            Bounded trial{middle, quantised(quantiser), 0};
            measure(quantiser, trial);
            (trial.largest <= bound_ ? low : high) = middle;
        }
        return low;
    }
    // Lattice points first; middles where these are right.
    bool keepSigns(const Quantiser& quantiser, std::vector<std::int32_t>& q) const {
        const auto move = [&](std::size_t i, int s) {
            q[i] = std::clamp(q[i] + s, -quantiser.most(), quantiser.most());
        };
        for (int pass = 0; pass < kMostPasses; ++pass) {
            progress_("quantising", 0);
            const std::vector<float> c = valuesOf(q, quantiser, in_.K, in_.voxelsPerK);
            if (!moveWrong(latticeValues(in_.lattice, c, in_.K, &in_.inside), pass % 8, move) &&
                (pass >= kMiddlePasses || !middles_.forEachWrong(c, kMargin * in_.K, move)))
                return true;
        }
        return false;
    }
    // Moves the wrong lattice points of a parity. Returns whether any is wrong.
    template <class Move>
    bool moveWrong(const std::vector<float>& F, int parity, const Move& move) const {
        std::atomic<bool> wrong = false;
        forEachPoint(F.size(), [&](std::size_t i) {
            if ((in_.inside[i] ? -F[i] : F[i]) >= kMargin * in_.K) return;
            wrong.store(true, std::memory_order_relaxed);
            if (parities_[i] == parity) move(i, in_.inside[i] ? -1 : 1);
        });
        return wrong;
    }

    const BoundedInput& in_;
    double bound_;
    const Progress& progress_;
    double reach_;
    Flags near_, parities_;
    std::vector<float> F_;
    MiddleSigns middles_;
};

}  // namespace

std::optional<Bounded> boundIndices(const BoundedInput& input, double bound, const Progress& progress) {
    return Search(input, bound, progress).run();
}

std::vector<float> valuesOf(const std::vector<std::int32_t>& indices, const Quantiser& quantiser, double K,
                            double voxelsPerK) {
    const double scale = K / voxelsPerK / kOneVoxel;
    std::vector<float> values(indices.size());
    forEachPoint(values.size(),
                 [&](std::size_t i) { values[i] = static_cast<float>(quantiser.value(indices[i]) * scale); });
    return values;
}

double reachOf(const BoundedInput& input) {
    float most = input.K;
    for (const float value : input.c) most = std::max(most, std::abs(value));
    return std::ceil(16 * (most / input.K * input.voxelsPerK + 1)) / 16;
}

}  // namespace isowave::compress
