#include "volume/fit/fit_mask.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "volume/fit/known.h"
#include "volume/fit/mask_between.h"
#include "volume/fit/mask_energy.h"
#include "volume/fit/mask_volume.h"
#include "volume/fit/repair.h"

// Notation, lengths in voxels: d distance to the nearest lattice point of the other side, s sign (-1 inside), D = s d;
// v values of F at the lattice points, the unknowns; c control points.
//
//   band    lattice points with d <= 4.5 (volume/fit/mask_band.h); beside it v = ±4
//   start   v = s (d - 1/2), filtered by a Gauss function of sigma 1
//   smooth  accelerated projected gradient: z = clip(y - g/144); y = z + (t - 1)/t' (z - v), t' = (1 + sqrt(1 + 4 t^2))/2
//           (Beck and Teboulle: "A fast iterative shrinkage-thresholding algorithm", 4.1)
//   shift   in the second half of the passes, every tenth, and at the end: v -= what blocks lack in volume; then t = 1
//   between where the corners of a lattice edge, face or cell agree, F in its middle has their sign: |v| grows at the corners
//   weigh   c interpolates v on I: quasi-interpolation, then corrections
//   repair  as every fit; has nothing to do in all shapes that were tried
// invariant of start, smooth, shift and between: v is within its bounds, |v| in [max(0.05, d - 1), d] with the mask's sign.

namespace isowave {

using namespace fitting;

namespace {

constexpr float kLeast = 0.05f;  // |v|
constexpr float kClamp = 4;      // of v, and what becomes K
constexpr int kShiftEvery = 10;  // passes
constexpr int kLastShifts = 2;
constexpr int kCorrections = 4;
// F between lattice points that agree: where it has their sign by less than the first, it shall by the second. The spline swings where v turns
// from its least to d: so two slabs with one voxel between them were joined at their corners.
constexpr float kBetweenFloor = 0.01f, kBetweenTarget = 0.02f;
constexpr int kBetweenRounds = 3;

const LeafValues kPlus = allOf(kClamp), kMinus = allOf(-kClamp), kNone = allOf(kNoValue),
                 kFarOutside = allOf(kBeyondBand), kFarInside = allOf(-kBeyondBand);

// v within its bounds, without branches: for D > 0 the lower is max(0.05, D - 1) and the upper D, for D < 0 the other way
// round; |D| >= 1. No value stays none.
inline float clipped(float v, float D) {
    const float low = std::min(D, std::max(kLeast, D - 1)), high = std::max(D, std::min(-kLeast, D + 1));
    const float atLeast = v < low ? low : v;
    return high < atLeast ? high : atLeast;
}

// exp(-k^2/2) for k = 0 .. 4, so that all nine weights sum to 1.
std::array<float, kBandReach + 1> gaussWeights() {
    std::array<double, kBandReach + 1> w;
    double sum = 0;
    for (int k = 0; k <= kBandReach; ++k) sum += (k == 0 ? 1 : 2) * (w[k] = std::exp(-0.5 * k * k));
    std::array<float, kBandReach + 1> weights;
    for (int k = 0; k <= kBandReach; ++k) weights[k] = static_cast<float>(w[k] / sum);
    return weights;
}

// out: `count` places; in: the first of 9 taps of each, `stride` apart.
void gaussAlong(const float* in, int stride, int count, float* out) {
    static const auto kWeights = gaussWeights();
    for (int i = 0; i < count; ++i) {
        const float* p = in + i;
        float sum = kWeights[0] * p[kBandReach * stride];
        for (int k = 1; k <= kBandReach; ++k)
            sum += kWeights[k] * (p[(kBandReach - k) * stride] + p[(kBandReach + k) * stride]);
        out[i] = sum;
    }
}

void gauss(const PaddedLeaf<float, kBandReach, kBandReach>& block, LeafValues& out) {
    constexpr int n = PaddedLeaf<float, kBandReach, kBandReach>::kSize;
    std::array<float, 8 * n * n> x;
    gaussAlong(block.values.data(), n * n, 8 * n * n, x.data());
    for (int i = 0; i < 8; ++i) {
        std::array<float, 8 * n> y;
        gaussAlong(&x[static_cast<std::size_t>(i * n * n)], n, 8 * n, y.data());
        for (int j = 0; j < 8; ++j)
            gaussAlong(&y[static_cast<std::size_t>(j * n)], 1, 8,
                       &out[static_cast<std::size_t>(64 * i + 8 * j)]);
    }
}

class MaskFit {
  public:
    // known: I; signs, known: in the source's coordinates.
    MaskFit(const openvdb::BoolTree& signs, const openvdb::MaskTree& known)
        : band_(bandAround(signs)),
          known_(band_.leafCount()),
          v_(band_.leafCount()),
          y_(band_.leafCount()),
          other_(band_.leafCount()) {
        forEachLeaf([&](std::size_t i) {
            if (const auto* leaf = known.probeConstLeaf(band_.origins[i]))
                known_[i] = wordsOf(leaf->getValueMask());
            else
                known_[i] = {};
            start(i);
        });
    }

    void run(int passes, const Progress& progress) {
        restart();
        for (int k = 0; k < passes; ++k) {
            progress("fitting", 0.5 * k / passes);
            pass();
            if (2 * k >= passes && (k + 1) % kShiftEvery == 0) shift();
        }
        for (int k = 0; k < kLastShifts; ++k) shift();
        for (int k = 0; k < kBetweenRounds && keepBetween(); ++k) continue;
    }

    // On I of a field whose lattice point i + shift is point i here.
    void putControlPoints(openvdb::FloatTree& tree, const openvdb::Coord& shift, double K) {
        interpolate();
        const auto scale = static_cast<float>(K / kClamp);
        forEachLeaf([&](std::size_t i) {
            if (isEmpty(known_[i])) return;
            auto* leaf = tree.probeLeaf(band_.origins[i] + shift);
            for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
                leaf->setValueOnly(voxel.pos(), scale * y_[i][voxel.pos()]);
        });
    }

  private:
    template <class Work>
    void forEachLeaf(const Work& work) const {
        tbb::parallel_for(std::size_t{0}, band_.leafCount(), work);
    }

    static bool isBand(float D) { return std::abs(D) < kBeyondBand; }

    void start(std::size_t i) {
        PaddedLeaf<float, kBandReach, kBandReach> block;
        gather(band_, band_.distance, i, kFarInside, kFarOutside, block);
        for (float& D : block.values) D -= std::copysign(0.5f, D);
        gauss(block, v_[i]);
        for (int p = 0; p < 512; ++p) {
            const float D = band_.distance[i][p];
            v_[i][p] = isBand(D) ? clipped(v_[i][p], D) : std::copysign(kClamp, D);
        }
    }

    // y = v, without acceleration.
    void restart() {
        forEachLeaf([&](std::size_t i) {
            for (int p = 0; p < 512; ++p) y_[i][p] = isBand(band_.distance[i][p]) ? v_[i][p] : kNoValue;
        });
        t_ = 1;
    }

    void pass() {
        const double next = (1 + std::sqrt(1 + 4 * t_ * t_)) / 2;
        const auto momentum = static_cast<float>((t_ - 1) / next);
        forEachLeaf([&](std::size_t i) {
            PaddedLeaf<float, 2, 2> block;
            gather(band_, y_, i, kNone, kNone, block);
            LeafValues g;
            gradientOfEnergy(block, g);
            const LeafValues &D = band_.distance[i], &y = y_[i];
            LeafValues &v = v_[i], &out = other_[i];
            for (int p = 0; p < 512; ++p) {
                const float z = clipped(y[p] - g[p] * (1 / kLargestEigenvalue), D[p]);
                out[p] = z + momentum * (z - v[p]);
                v[p] = z == z ? z : v[p];
            }
        });
        y_.swap(other_);
        t_ = next;
    }

    // y_ = the control points that interpolate v, clamped, on I; ±4 elsewhere.
    void interpolate() {
        forEachLeaf([&](std::size_t i) {
            for (int p = 0; p < 512; ++p)
                y_[i][p] = other_[i][p] = std::copysign(kClamp, band_.distance[i][p]);
            quasiInterpolate(i);
        });
        y_.swap(other_);
        for (int k = 0; k < kCorrections; ++k) {
            forEachLeaf([&](std::size_t i) { correct(i); });
            y_.swap(other_);
        }
    }

    // The three-tap filter on each axis of values clamped to ±limit; then put(place, filtered) on I.
    template <class Put>
    void filter(std::size_t i, const std::vector<LeafValues>& values, float limit, double centre, double side,
                const Put& put) {
        if (isEmpty(known_[i])) return;
        PaddedLeaf<float, 1, 1> block;
        gather(band_, values, i, kMinus, kPlus, block);
        PaddedLeaf<double, 1, 1> wide;
        for (std::size_t p = 0; p < wide.values.size(); ++p)
            wide.values[p] = std::clamp(block.values[p], -limit, limit);
        std::array<double, 512> filtered;
        filterThreeTaps(wide, centre, side, filtered);
        for (int x = 0; x < 8; ++x)
            for (std::uint64_t bits = known_[i][x]; bits; bits &= bits - 1) {
                const int p = 64 * x + std::countr_zero(bits);
                put(p, static_cast<float>(filtered[p]));
            }
    }

    void quasiInterpolate(std::size_t i) {
        filter(i, v_, kClamp, 8.0 / 6, -1.0 / 6, [&](int p, float c) { other_[i][p] = c; });
    }

    void correct(std::size_t i) {
        constexpr float kNoLimit = std::numeric_limits<float>::infinity();
        filter(i, y_, kNoLimit, 4.0 / 6, 1.0 / 6, [&](int p, float F) {
            other_[i][p] = y_[i][p] + 1.5f * (std::clamp(v_[i][p], -kClamp, kClamp) - F);
        });
    }

    // Leaves that have no control point of I have no surface.
    NearShares sharesOfLeaf(std::size_t i) const {
        if (isEmpty(known_[i])) return {};
        PaddedLeaf<float, 2, 2> block;
        gather(band_, y_, i, kMinus, kPlus, block);
        return sharesOf(block, band_.distance[i]);
    }

    // The sum of what the leaves around hand out to leaf i.
    BlockShare sumAt(const std::vector<NearShares>& shares, std::size_t i) const {
        BlockShare sum;
        for (std::size_t b = 0; b < 27; ++b) {
            const std::int32_t from = band_.beside[i][b];
            if (from < 0) continue;
            const BlockShare& share = shares[static_cast<std::size_t>(from)][26 - b];
            sum.missing += share.missing;
            sum.area += share.area;
        }
        return sum;
    }

    void shift() {
        interpolate();
        std::vector<NearShares> shares(band_.leafCount());
        forEachLeaf([&](std::size_t i) { shares[i] = sharesOfLeaf(i); });
        std::vector<BlockShare> sums(band_.leafCount());
        forEachLeaf([&](std::size_t i) { sums[i] = sumAt(shares, i); });
        forEachLeaf([&](std::size_t i) {
            NearShares blocks;
            for (std::size_t b = 0; b < 27; ++b) {
                const std::int32_t at = band_.beside[i][b];
                blocks[b] = at < 0 ? BlockShare{} : sums[static_cast<std::size_t>(at)];
            }
            LeafValues delta;
            shiftOf(blocks, delta);
            for (int p = 0; p < 512; ++p) {
                const float D = band_.distance[i][p];
                if (isBand(D)) v_[i][p] = clipped(v_[i][p] - delta[p], D);
            }
        });
        restart();
    }

    // -> whether something was lacking; where nothing was, more rounds would change nothing.
    bool keepBetween() {
        std::atomic<bool> lacked = false;
        interpolate();
        forEachLeaf([&](std::size_t i) {
            if (isEmpty(known_[i])) return;
            PaddedLeaf<float, 2, 2> c, D;
            gather(band_, y_, i, kMinus, kPlus, c);
            gather(band_, band_.distance, i, kFarInside, kFarOutside, D);
            LeafValues lacking;
            lackingBetween(c, D, kBetweenFloor, kBetweenTarget, lacking);
            for (int p = 0; p < 512; ++p)
                if (lacking[p] > 0) {
                    lacked = true;
                    const float D0 = band_.distance[i][p];
                    v_[i][p] = clipped(v_[i][p] + std::copysign(lacking[p], D0), D0);
                }
        });
        return lacked;
    }

    MaskBand band_;
    std::vector<LeafWords> known_;
    std::vector<LeafValues> v_;  // ±4 beside the band
    std::vector<LeafValues> y_,
        other_;  // no value beside the band; while v is shifted and at the end, control points
    double t_ = 1;
};

// Everything before the repair; a source's lattice point i is i + shiftOf(known) of the field.
template <class ShiftOf>
BSplineField smoothestWithin(const NodeCollection& nodes, const MaskFitOptions& options,
                             const ShiftOf& shiftOf, const Progress& progress) {
    progress("fitting", 0);
    const openvdb::BoolTree& signs = nodes.grid->constTree();
    openvdb::MaskTree known = knownAround(openvdb::MaskTree(signs, false, openvdb::TopologyCopy()));
    MaskFit fit(signs, known);
    fit.run(options.passes, progress);
    const openvdb::Coord shift = shiftOf(known);
    const auto makeInside = [&signs, &shift] { return Signs(signs, shift); };
    BSplineField field = makeField(makeShape(known, signs, shift, makeInside), options.K,
                                   *shiftedTransform(nodes.grid->transform(), shift));
    fit.putControlPoints(field.controlPoints->tree(), shift, options.K);
    return field;
}

constexpr double kMaskTarget = kDistanceTarget / kClamp;

}  // namespace

BSplineField fitMask(const NodeCollection& nodes, const MaskFitOptions& options, FitReport* report,
                     const Progress& progress) {
    BSplineField field = smoothestWithin(nodes, options, moveOrigin, progress);
    FitReport result;
    result.gradientPasses = options.passes;
    finish(field, kMaskFloor, kMaskTarget, options.mostRepairPasses, result, report, progress);
    return field;
}

BSplineField fitMaskPart(const NodeCollection& nodes, const MaskFitOptions& options,
                         const openvdb::CoordBBox& box, PartRepair& repair, const Progress& progress) {
    BSplineField part = smoothestWithin(
        nodes, options, [](const openvdb::MaskTree&) { return openvdb::Coord(0); }, progress);
    repair = finishPart(part, kMaskFloor, kMaskTarget, options.mostRepairPasses, box, progress);
    return part;
}

}  // namespace isowave
