#include "volume/fit/mask_volume.h"

#include <algorithm>
#include <cmath>

namespace isowave::fitting {
namespace {

// Means over [0, 1/2] of the cubic B-spline's weights of the control points at -1, 0, 1, 2; over [1/2, 1] they are the
// same in reverse. 2 * the integrals of (1-t)^3/6, (3t^3-6t^2+4)/6, (-3t^3+3t^2+3t+1)/6, t^3/6.
constexpr std::array<float, 4> kLowMean = {15.0f / 192, 115.0f / 192, 61.0f / 192, 1.0f / 192};

// Cell means of the two halves of each voxel -1 .. 8. Per axis n = 9 lower halves, of the voxels 0 .. 8, and n upper
// ones, of the voxels -1 .. 7, from control points -2 .. 9: the half of voxel i below its middle lies between lattice
// points i - 1 and i.
constexpr int n = 9;
constexpr int kPoints = 12;
// p: control point i - 2 of the i-th lower half; stride: between control points.
inline float lowerHalf(const float* p, int stride) {
    return kLowMean[3] * p[0] + kLowMean[2] * p[stride] + kLowMean[1] * p[2 * stride] +
           kLowMean[0] * p[3 * stride];
}
// p: control point i - 1 of the upper half of voxel i.
inline float upperHalf(const float* p, int stride) {
    return kLowMean[0] * p[0] + kLowMean[1] * p[stride] + kLowMean[2] * p[2 * stride] +
           kLowMean[3] * p[3 * stride];
}

// Along the slower of two indices, in: kPoints rows of `width`; out: 2n rows, halves in order of place: upper of voxel
// -1, lower of 0, upper of 0, ..., lower of 8.
void halveRows(const float* in, int width, float* out) {
    for (int i = 0; i < n; ++i)
        for (int w = 0; w < width; ++w) {
            out[(2 * i) * width + w] = upperHalf(in + i * width + w, width);
            out[(2 * i + 1) * width + w] = lowerHalf(in + i * width + w, width);
        }
}

struct CellMeans {
    // Row (x, y): 2n by 2n cells in order of place. Within a row the n upper halves of voxels -1 .. 7, then the n lower
    // halves of voxels 0 .. 8, so that a row is computed without shuffling.
    std::array<float, 4 * n * n * 2 * n> f;
    const float* row(int x, int y) const { return &f[static_cast<std::size_t>((x * 2 * n + y) * 2 * n)]; }
};

void cellMeansOf(const PaddedLeaf<float, 2, 2>& c, CellMeans& means) {
    std::array<float, 2 * n * kPoints * kPoints> alongX;
    halveRows(c.values.data(), kPoints * kPoints, alongX.data());
    std::array<float, 2 * n * kPoints> alongY;
    for (int x = 0; x < 2 * n; ++x) {
        halveRows(&alongX[static_cast<std::size_t>(x * kPoints * kPoints)], kPoints, alongY.data());
        for (int y = 0; y < 2 * n; ++y) {
            const float* in = &alongY[static_cast<std::size_t>(y * kPoints)];
            float* out = &means.f[static_cast<std::size_t>((x * 2 * n + y) * 2 * n)];
            for (int z = 0; z < n; ++z) out[z] = upperHalf(in + z, 1);
            for (int z = 0; z < n; ++z) out[n + z] = lowerHalf(in + z, 1);
        }
    }
}

// Sums over the 2^3 cells of each voxel.
struct VoxelSums {
    LeafValues share{}, area{};

    // voxels: the first of eight; f: a cell of each, the other pointers the cells beside.
    void add(int voxels, const float* f, const float* const (&below)[3], const float* const (&above)[3]) {
        float *s = &share[static_cast<std::size_t>(voxels)], *a = &area[static_cast<std::size_t>(voxels)];
        for (int z = 0; z < 8; ++z) {
            float squared = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float difference = above[axis][z] - below[axis][z];
                squared += difference * difference;
            }
            // The cells beside are two edges apart, each half a voxel.
            const float g = std::max(0.5f * std::sqrt(squared), 0.125f), inverse = 1 / g;
            const float inside = 0.5f - f[z] * inverse;
            s[z] += std::min(std::max(inside, 0.0f), 1.0f);
            a[z] += inside > 0 && inside < 1 ? inverse : 0.0f;
        }
    }
};

void addCells(const PaddedLeaf<float, 2, 2>& c, VoxelSums& sums) {
    CellMeans m;
    cellMeansOf(c, m);
    for (int x = 1; x <= 16; ++x)
        for (int y = 1; y <= 16; ++y) {
            const float *at = m.row(x, y), *left = m.row(x - 1, y), *right = m.row(x + 1, y),
                        *front = m.row(x, y - 1), *back = m.row(x, y + 1);
            const int voxels = 64 * ((x - 1) / 2) + 8 * ((y - 1) / 2);
            // Lower halves of the voxels 0 .. 7 lie between the upper halves of the voxels -1 .. 7.
            sums.add(voxels, at + n, {left + n, front + n, at}, {right + n, back + n, at + 1});
            sums.add(voxels, at + 1, {left + 1, front + 1, at + n}, {right + 1, back + 1, at + n + 1});
        }
}

// Voxel i of a block lies at (i - 3.5)/8 of the way from its centre to the next one's: weights of the blocks below, here
// and above.
constexpr auto kWeights = [] {
    std::array<std::array<float, 3>, 8> weights{};
    for (int i = 0; i < 8; ++i) {
        const float u = (static_cast<float>(i) - 3.5f) / 8;
        weights[i] = {u < 0 ? -u : 0, u < 0 ? 1 + u : 1 - u, u < 0 ? 0 : u};
    }
    return weights;
}();

}  // namespace

NearShares sharesOf(const PaddedLeaf<float, 2, 2>& c, const LeafValues& distance) {
    VoxelSums sums;
    addCells(c, sums);
    struct {
        std::array<std::array<float, 8>, 9> missing{}, area{};
    } lanes;
    NearShares near{};
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            // First lane by lane, so that eight voxels are added at once.
            const std::size_t row = static_cast<std::size_t>(64 * x + 8 * y);
            for (int b = 0; b < 9; ++b) {
                const float w = kWeights[x][b / 3] * kWeights[y][b % 3];
                if (w == 0) continue;
                for (int z = 0; z < 8; ++z) {
                    lanes.missing[b][z] += w * ((distance[row + z] < 0 ? 8.0f : 0.0f) - sums.share[row + z]);
                    lanes.area[b][z] += w * sums.area[row + z];
                }
            }
        }
    for (int b = 0; b < 27; ++b)
        for (int z = 0; z < 8; ++z) {
            near[b].missing += kWeights[z][b % 3] * lanes.missing[b / 3][z] / 8;
            near[b].area += kWeights[z][b % 3] * lanes.area[b / 3][z] / 8;
        }
    return near;
}

void shiftOf(const NearShares& blocks, LeafValues& shift) {
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            std::array<BlockShare, 3> along{};
            for (int b = 0; b < 27; ++b) {
                const float w = kWeights[x][b / 9] * kWeights[y][b / 3 % 3];
                along[b % 3].missing += w * blocks[b].missing;
                along[b % 3].area += w * blocks[b].area;
            }
            for (int z = 0; z < 8; ++z) {
                const auto& w = kWeights[z];
                const float missing =
                    w[0] * along[0].missing + w[1] * along[1].missing + w[2] * along[2].missing;
                const float area = w[0] * along[0].area + w[1] * along[1].area + w[2] * along[2].area;
                shift[64 * x + 8 * y + z] = std::clamp(missing / std::max(area, 0.5f), -0.25f, 0.25f);
            }
        }
}

}  // namespace isowave::fitting
