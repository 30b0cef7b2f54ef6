#include "volume/fit/mask_between.h"

#include <algorithm>

namespace isowave::fitting {
namespace {

constexpr int kIn = PaddedLeaf<float, 2, 2>::kSize;  // control points -2 .. 9
constexpr int kOut = 19;                             // lattice points -1 .. 8 and the middles between them

// One line of an array along an axis: control point k at in + k s, place k at out + k t.
inline void alongLine(const float* in, int s, float* out, int t) {
    for (int k = 0; k + 2 < kIn; ++k, in += s, out += 2 * t) {
        out[0] = (in[0] + 4 * in[s] + in[2 * s]) / 6;
        if (k + 3 < kIn) out[t] = (in[0] + 23 * (in[s] + in[2 * s]) + in[3 * s]) / 48;
    }
}

using Halfway = std::array<float, kOut * kOut * kOut>;
constexpr int at(int x, int y, int z) { return (x * kOut + y) * kOut + z; }

void valuesHalfway(const PaddedLeaf<float, 2, 2>& c, Halfway& f) {
    std::array<float, kIn * kIn * kOut> z;
    for (int i = 0; i < kIn * kIn; ++i) alongLine(&c.values[i * kIn], 1, &z[i * kOut], 1);
    std::array<float, kIn * kOut * kOut> y;
    for (int x = 0; x < kIn; ++x)
        for (int k = 0; k < kOut; ++k) alongLine(&z[x * kIn * kOut + k], kOut, &y[x * kOut * kOut + k], kOut);
    for (int i = 0; i < kOut * kOut; ++i) alongLine(&y[i], kOut * kOut, &f[i], kOut * kOut);
}

// Whether the lattice points around place (x, y, z) all have the sign of `inside`: the one before and the one after on
// each axis where it lies between two.
bool agree(const PaddedLeaf<float, 2, 2>& D, int x, int y, int z, bool inside) {
    for (int i = x / 2; i <= (x + 1) / 2; ++i)
        for (int j = y / 2; j <= (y + 1) / 2; ++j)
            for (int k = z / 2; k <= (z + 1) / 2; ++k)
                if ((D.at(i - 1, j - 1, k - 1) < 0) != inside) return false;
    return true;
}

}  // namespace

void lackingBetween(const PaddedLeaf<float, 2, 2>& c, const PaddedLeaf<float, 2, 2>& D, float floor,
                    float target, LeafValues& lacking) {
    lacking.fill(0);
    Halfway f;
    valuesHalfway(c, f);
    for (int x = 1; x < kOut - 1; ++x)
        for (int y = 1; y < kOut - 1; ++y)
            for (int z = 1; z < kOut - 1; ++z) {
                if (x % 2 == 0 && y % 2 == 0 && z % 2 == 0) continue;  // a lattice point
                const bool inside = D.at(x / 2 - 1, y / 2 - 1, z / 2 - 1) < 0;
                const float sF = inside ? -f[at(x, y, z)] : f[at(x, y, z)];
                if (sF >= floor || !agree(D, x, y, z, inside)) continue;
                for (int i = x / 2; i <= (x + 1) / 2; ++i)
                    for (int j = y / 2; j <= (y + 1) / 2; ++j)
                        for (int k = z / 2; k <= (z + 1) / 2; ++k) {
                            if (i < 1 || i > 8 || j < 1 || j > 8 || k < 1 || k > 8) continue;
                            float& here = lacking[64 * (i - 1) + 8 * (j - 1) + k - 1];
                            here = std::max(here, target - sF);
                        }
            }
}

}  // namespace isowave::fitting
