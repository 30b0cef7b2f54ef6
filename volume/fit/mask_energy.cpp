#include "volume/fit/mask_energy.h"

namespace isowave::fitting {
namespace {

using Block = PaddedLeaf<float, 2, 2>;
constexpr int kX = Block::kSize * Block::kSize, kY = Block::kSize, kZ = 1;

// A difference, or 0 if one of its points has no value.
inline float kept(float difference) { return difference == difference ? difference : 0; }

// Differences at the lattice points of a box that starts at (x0, y0, z0) of a block; z fastest.
template <int NX, int NY, int NZ>
struct Differences {
    std::array<float, NX * NY * NZ> q;

    // at(p): the difference at the place *p.
    template <class At>
    void fill(const Block& v, int x0, int y0, int z0, const At& at) {
        for (int x = 0; x < NX; ++x)
            for (int y = 0; y < NY; ++y) {
                const float* p = &v.values[v.index(x0 + x, y0 + y, z0)];
                float* row = &q[(x * NY + y) * NZ];
                for (int z = 0; z < NZ; ++z) row[z] = kept(at(p + z));
            }
    }

    // gradient += transposed(place of the leaf's point in q).
    template <class Transposed>
    void addTo(LeafValues& gradient, const Transposed& transposed) const {
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                const float* row = &q[(x * NY + y) * NZ];
                float* g = &gradient[64 * x + 8 * y];
                for (int z = 0; z < 8; ++z) g[z] += transposed(row + z);
            }
    }
};

// q = v(i+a) + v(i-a) - 2 v(i) from -1 to 8 along a; dE/dv = q(i+a) + q(i-a) - 2 q(i).
template <int Along>
void addSecond(const Block& v, LeafValues& gradient) {
    constexpr int nx = Along == kX ? 10 : 8, ny = Along == kY ? 10 : 8, nz = Along == kZ ? 10 : 8;
    constexpr int step = Along == kX ? ny * nz : Along == kY ? nz : 1;
    Differences<nx, ny, nz> d;
    d.fill(v, (8 - nx) / 2, (8 - ny) / 2, (8 - nz) / 2,
           [](const float* p) { return p[Along] + p[-Along] - 2 * p[0]; });
    d.addTo(gradient, [](const float* q) { return q[0] + q[2 * step] - 2 * q[step]; });
}

// q = v(i) - v(i+a) - v(i+b) + v(i+a+b) from -1 to 7 along a and b; dE/dv = 2 (q(i) - q(i-a) - q(i-b) + q(i-a-b)).
template <int A, int B>
void addMixed(const Block& v, LeafValues& gradient) {
    constexpr auto has = [](int axis) { return A == axis || B == axis; };
    constexpr int nx = has(kX) ? 9 : 8, ny = has(kY) ? 9 : 8, nz = has(kZ) ? 9 : 8;
    constexpr auto stepOf = [](int axis) { return axis == kX ? ny * nz : axis == kY ? nz : 1; };
    constexpr int a = stepOf(A), b = stepOf(B);
    Differences<nx, ny, nz> d;
    d.fill(v, 8 - nx, 8 - ny, 8 - nz, [](const float* p) { return (p[0] - p[A]) - (p[B] - p[A + B]); });
    d.addTo(gradient, [](const float* q) { return 2 * ((q[a + b] - q[b]) - (q[a] - q[0])); });
}

}  // namespace

void gradientOfEnergy(const PaddedLeaf<float, 2, 2>& v, LeafValues& gradient) {
    gradient.fill(0);
    addSecond<kX>(v, gradient);
    addSecond<kY>(v, gradient);
    addSecond<kZ>(v, gradient);
    addMixed<kX, kY>(v, gradient);
    addMixed<kX, kZ>(v, gradient);
    addMixed<kY, kZ>(v, gradient);
}

}  // namespace isowave::fitting
