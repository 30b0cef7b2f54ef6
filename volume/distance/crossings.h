// Distances to the zero set of a sampled function, a leaf at a time, from where it crosses the lattice's edges.
//
//   signs      which samples are inside, as bits: an edge crosses where neighbours differ
//   own axis   t = a/(a - b) along every edge that crosses; the nearest one of each line, for every point of the line
//   others     the least over -4 .. 4 along each of the two other axes
//   discs      the distance to a disc on the surface around the nearest crossing
//
// Nearest crossing. Crossings of edges along one axis, a family, lie at lattice points but for a fraction on that axis.
// So the squared distance from a lattice point is (e + t)^2 + j^2 + k^2 with whole j, k, and its least value over a family is
// found axis by axis, exactly (Felzenszwalb, Huttenlocher: "Distance transforms of sampled functions"). The squared distance
// in 1/1024 and the place of the crossing share one integer, so that a step is one addition and one minimum, and the
// place comes along. What differs by less than 1/1024 counts as equally near and is settled by the place.
//
// Disc. The crossing's tangent plane has the normal g: along its edge the difference of the ends, along the others central
// differences, interpolated along the edge. With p from the crossing to the lattice point, m = g.p / |g| and
// o = max(0, sqrt(p^2 - m^2) - r), the distance is sqrt(m^2 + o^2). Exact for planes whose samples are linear: a foot is at most
// sqrt(3)/2 from the nearest crossing (planes x + y = 0), and r = 0.87. Of a sphere of radius 20 in 8 bits it is 0.006 voxel off (rms).
//
// Hard edges. Where grey jumps within a voxel, both ends of an edge are saturated and t is a half, whatever the truth; what
// is left of it shows as steps in the next coarser level. There a lattice point v beside the surface has its distance from
// all of its edges that cross, at t_a along axis a (the nearer one), and from the slopes g of the samples at v:
//
// (1) d = sqrt(f / sum_a 1/t_a^2), f = (sum of g_a^2 over these axes) / |g|^2
//
// For planes 1/t_a = |n_a| / d, so (1) is exact, and errors of three t_a partly cancel. A crossing lies where the distances of
// its ends say, d_v / (d_v + d_w). Between grey that goes on as steeply beyond an edge and grey that ends with it, both
// meet smoothly. Rejected: fast sweeping's start values, (1) with f = 1 (0.39 voxel off on a sphere, an axis may cross farther
// away); (1) everywhere (rounds corners that the samples know); wider gradients (what is off are the places, not the normals).
//
// Nothing is handed on from leaf to leaf: the result depends on the samples around a leaf alone.
#pragma once

#include <cstdint>
#include <memory>

#include "base/vectors.h"

namespace isowave {

// Samples at -5 .. 12 around a leaf on each axis, the last one fastest: positive inside, negative outside, never 0.
struct LeafSamples {
    static constexpr int kBefore = 5, kSize = 8 + 2 * kBefore;
    alignas(64) float values[kSize][kSize][kSize];

    // i, j, k: -5 .. 12.
    float& at(int i, int j, int k) { return values[i + kBefore][j + kBefore][k + kBefore]; }
};

// For one thread.
class CrossingDistances {
  public:
    // How far crossings are looked for, in voxels: distances are right below it.
    static constexpr int kReach = 4;

    explicit CrossingDistances(Vectors widest = widestVectors());
    ~CrossingDistances();
    CrossingDistances(CrossingDistances&&) noexcept;

    // values[64 i + 8 j + k], 0 <= i, j, k < 8: signed distances in voxels, negative inside (never nearer than 1e-6 there:
    // a point on the surface is outside), clamped to ±halfWidth, halfWidth <= kReach. Whether any is nearer.
    bool compute(const LeafSamples& samples, float halfWidth, float* values);

    struct Scratch;
    class Beside;

  private:
    template <int N>
    bool computeBy(const LeafSamples& samples, float halfWidth, float* values);
    bool computeByEight(const LeafSamples& samples, float halfWidth, float* values);

    Vectors vectors_;
    std::unique_ptr<Scratch> scratch_;
    std::unique_ptr<Beside> beside_;
};

}  // namespace isowave
