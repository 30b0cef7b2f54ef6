#include "volume/distance/crossings.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "volume/distance/lanes.h"

// A leaf's rows lie along the third axis; "lines" below are the 16 places -4 .. 11 that crossings in reach start from.

namespace isowave {
namespace {

constexpr int kSize = LeafSamples::kSize, kBefore = LeafSamples::kBefore, kReach = CrossingDistances::kReach;
constexpr int kLine = 8 + 2 * kReach;  // places -4 .. 11

// A key: squared distance in 1/1024 (17 bits) | offset + 5 to the start of the edge on the third, second, first axis
// (4 bits each) | the edge's axis (2 bits). kNone and the two steps that follow stay below 2^31.
using Key = std::int32_t;
constexpr int kPlaceBits = 14, kShift[3] = {2, 6, 10};
constexpr Key kUnit = 1 << (10 + kPlaceBits), kNone = 64 * kUnit;
constexpr float kPerUnit = 1024;
static_assert(std::int64_t(kNone) + 2 * kReach * kReach * std::int64_t(kUnit) < (std::int64_t(1) << 31));

constexpr Key placeOf(int offset, int axis) { return (offset + kBefore) << kShift[axis]; }
constexpr Key step(int offset, int axis) { return offset * offset * kUnit + placeOf(offset, axis); }

// Bit n: the sample at n - 5 is outside.
using Signs = std::uint32_t;

// Which edges along a row cross: bit n, from n - 5 on.
Signs changesIn(Signs row) { return (row ^ row >> 1) & ((1u << (kSize - 1)) - 1); }

// Bits a .. a + 8 of a mask of 16 places: those within reach of place a - 4 ... of the leaf's point a.
std::uint32_t inReach(std::uint32_t places, int point) {
    return places >> point & ((1u << (2 * kReach + 1)) - 1);
}

template <class Do>
ISOWAVE_INLINE void eachBit(std::uint32_t bits, const Do& act) {
    for (; bits; bits &= bits - 1) act(std::countr_zero(bits));
}

}  // namespace

struct CrossingDistances::Scratch {
    Signs outside[kSize][kSize];
    // The nearest crossing so far. Of edges along the first axis: [i][j + 4][k + 4]; along the second: [j][i + 4][k + 4]; along
    // the third: [j + 4][i + 4][k], then [i][j + 4][k].
    alignas(64) Key first[8][kLine][kLine], second[8][kLine][kLine], third[kLine][kLine][8],
        third2[8][kLine][8];
    alignas(64) Key all[8][8][8];
    // Which rows of these hold something: bit j + 4 of [i], i + 4 of [j], i + 4 of [j + 4], j + 4 of [i].
    std::uint32_t firstRows[8], secondRows[8], thirdRows[kLine], third2Rows[8];
};

namespace {

template <int N>
struct Passes {
    using L = Lanes<N>;
    using Floats = typename L::Floats;
    using Ints = typename L::Ints;
    using S = CrossingDistances::Scratch;

    ISOWAVE_INLINE static Ints keyOf(Floats distance) {
        // Rounded, so that a whisker more or less does not tell what is as near as another.
        const Floats squared = distance * distance * kPerUnit + 0.5f;
        const Ints none = L::all(kNone);
        // An edge that starts 5 away may cross within 4; what is farther would not fit its place's 4 bits.
        return squared < kBefore * kBefore * kPerUnit ? __builtin_convertvector(squared, Ints) << kPlaceBits
                                                      : none;
    }

    // Where edges cross, from their starts; far away where they do not.
    ISOWAVE_INLINE static Floats crossing(Floats a, Floats b) {
        const Floats none = L::all(100.0f);
        return (a > 0) != (b > 0) ? a / (a - b) : none;
    }

    // Edges along `axis`, across the rows: rowAt(e) is the row of samples at e, outsideAt(e) its signs.
    // out[i][other]: the nearest along the axis for the row's 16 places. Returns which i have found any.
    template <class OutsideAt, class RowAt>
    ISOWAVE_INLINE static std::uint32_t acrossRows(int axis, const OutsideAt& outsideAt, const RowAt& rowAt,
                                                   Key (*out)[kLine][kLine], int other) {
        std::uint32_t used = 0;
        for (int e = -kBefore; e < 7 + kBefore; ++e) {
            if (!((outsideAt(e) ^ outsideAt(e + 1)) & (0xffffu << 1))) continue;
            const float *a = rowAt(e) + 1, *b = rowAt(e + 1) + 1;
            const int from = std::max(0, e - kReach), to = std::min(7, e + kBefore);
            for (int part = 0; part < kLine; part += N) {
                const Floats t = crossing(L::load(a + part), L::load(b + part));
                for (int i = from; i <= to; ++i) {
                    Key* row = out[i][other] + part;
                    const Ints key = keyOf(t + float(e - i)) + (placeOf(e - i, axis) + axis);
                    L::store(row, used >> i & 1 ? least(L::load(row), key) : key);
                }
            }
            for (int i = from; i <= to; ++i) used |= 1u << i;
        }
        return used;
    }

    // Edges along the rows.
    ISOWAVE_INLINE static void alongRow(const float* samples, Signs edges, Key* out) {
        for (int part = 0; part < 8; part += N) {
            Ints nearest = L::all(kNone);
            eachBit(edges, [&](int e) {
                const float at = samples[e] / (samples[e] - samples[e + 1]) + float(e - kBefore);
                Floats distance;
                Ints place;
                for (int k = 0; k < N; ++k) {
                    distance[k] = at - float(part + k);
                    place[k] = placeOf(e - kBefore - part - k, 2) + 2;
                }
                nearest = least(nearest, keyOf(distance) + place);
            });
            L::store(out + part, nearest);
        }
    }

    // The least over the rows at -4 .. 4 from `point` that hold something. rowAt(n): row n of 16.
    template <class RowAt>
    ISOWAVE_INLINE static void acrossTo(Ints& nearest, std::uint32_t rows, int point, int axis,
                                        const RowAt& rowAt) {
        eachBit(inReach(rows, point),
                [&](int n) { nearest = least(nearest, L::load(rowAt(n + point)) + step(n - kReach, axis)); });
    }

    ISOWAVE_INLINE static void ownAxes(const LeafSamples& samples, S& s) {
        std::fill_n(s.firstRows, 8, 0u);
        std::fill_n(s.secondRows, 8, 0u);
        std::fill_n(s.thirdRows, kLine, 0u);
        for (int j = 0; j < kLine; ++j) {
            const std::uint32_t used = acrossRows(
                0, [&](int e) { return s.outside[e + kBefore][j + 1]; },
                [&](int e) { return samples.values[e + kBefore][j + 1]; }, s.first, j);
            for (int i = 0; i < 8; ++i) s.firstRows[i] |= (used >> i & 1) << j;
        }
        for (int i = 0; i < kLine; ++i) {
            const std::uint32_t used = acrossRows(
                1, [&](int e) { return s.outside[i + 1][e + kBefore]; },
                [&](int e) { return samples.values[i + 1][e + kBefore]; }, s.second, i);
            for (int j = 0; j < 8; ++j) s.secondRows[j] |= (used >> j & 1) << i;
        }
        for (int i = 0; i < kLine; ++i)
            for (int j = 0; j < kLine; ++j)
                if (const Signs edges = changesIn(s.outside[i + 1][j + 1])) {
                    s.thirdRows[j] |= 1u << i;
                    alongRow(samples.values[i + 1][j + 1], edges, s.third[j][i]);
                }
    }

    // The first axis of edges along the third.
    ISOWAVE_INLINE static void thirdAlongFirst(S& s) {
        std::fill_n(s.third2Rows, 8, 0u);
        for (int j = 0; j < kLine; ++j) {
            if (!s.thirdRows[j]) continue;
            for (int i = 0; i < 8; ++i) {
                if (!inReach(s.thirdRows[j], i)) continue;
                s.third2Rows[i] |= 1u << j;
                for (int part = 0; part < 8; part += N) {
                    Ints nearest = L::all(kNone);
                    acrossTo(nearest, s.thirdRows[j], i, 0, [&](int n) { return s.third[j][n] + part; });
                    L::store(s.third2[i][j] + part, nearest);
                }
            }
        }
    }

    // A row of the leaf: first and second family meet before the pass along the third axis, the third joins behind it.
    ISOWAVE_INLINE static void row(S& s, int i, int j) {
        const bool across = inReach(s.firstRows[i], j) | inReach(s.secondRows[j], i);
        alignas(64) Key line[kLine];
        if (across)
            for (int part = 0; part < kLine; part += N) {
                Ints nearest = L::all(kNone);
                acrossTo(nearest, s.firstRows[i], j, 1, [&](int n) { return s.first[i][n] + part; });
                acrossTo(nearest, s.secondRows[j], i, 0, [&](int n) { return s.second[j][n] + part; });
                L::store(line + part, nearest);
            }
        for (int part = 0; part < 8; part += N) {
            Ints nearest = L::all(kNone);
            if (across)
                for (int k = -kReach; k <= kReach; ++k)
                    nearest = least(nearest, L::load(line + part + k + kReach) + step(k, 2));
            acrossTo(nearest, s.third2Rows[i], j, 1, [&](int n) { return s.third2[i][n] + part; });
            L::store(s.all[i][j] + part, nearest);
        }
    }
};

// Signs by rows. Whether any two samples differ.
bool collectSigns(const LeafSamples& samples, CrossingDistances::Scratch& s) {
    Signs differ = 0;
    constexpr Signs kRow = (1u << kSize) - 1;
    const Signs first = std::bit_cast<std::uint32_t>(samples.values[0][0][0]) >> 31 ? kRow : 0;
    for (int i = 0; i < kSize; ++i)
        for (int j = 0; j < kSize; ++j) {
            const float* row = samples.values[i][j];
            Signs bits = 0;
            for (int k = 0; k < kSize; ++k) bits |= (std::bit_cast<std::uint32_t>(row[k]) >> 31) << k;
            s.outside[i][j] = bits;
            differ |= bits ^ first;
        }
    return differ;
}

// ---- discs

constexpr float kDisc = 0.87f;
constexpr int kStride[3] = {kSize * kSize, kSize, 1};

ISOWAVE_INLINE bool crosses(const float* v, int stride) { return (*v > 0) != (v[stride] > 0); }

// How hard the edge from v is: 0 where the grey goes on beyond one of its ends as steeply as between them, 1 where less than
// half as steeply, so that its ends tell little of where between them the surface is.
ISOWAVE_INLINE float hardnessOf(const float* v, int s) {
    const float beyond = std::max(std::abs(v[0] - v[-s]), std::abs(v[2 * s] - v[s]));
    return std::clamp(2 - 2 * beyond / std::abs(v[s] - v[0]), 0.0f, 1.0f);
}

// The hardest of a lattice point's edges that cross; negative where none does.
ISOWAVE_INLINE float hardnessAt(const float* v) {
    float most = -1;
    for (const int s : kStride) {
        if (crosses(v, s)) most = std::max(most, hardnessOf(v, s));
        if (crosses(v, -s)) most = std::max(most, hardnessOf(v - s, s));
    }
    return most;
}

// Distance of a lattice point with edges that cross, from all of them: (1) of the header.
float besideSurface(const float* v) {
    float inverse = 0, crossing = 0, all = 0;
    for (const int s : kStride) {
        float slope = std::abs(v[s] - v[-s]), nearest = 2;
        for (const int to : {s, -s})
            if (crosses(v, to)) {
                const float difference = *v - v[to];
                nearest = std::min(nearest, *v / difference);
                slope = std::max(slope, std::abs(difference));
            }
        all += slope * slope;
        if (nearest > 1) continue;
        crossing += slope * slope;
        inverse += 1 / (nearest * nearest);
    }
    return std::sqrt(crossing / all / inverse);
}

}  // namespace

// Distances of lattice points beside the surface, each computed when it is first asked for.
class CrossingDistances::Beside {
  public:
    void forget() { std::fill_n(values_, kSize * kSize * kSize, -1.0f); }
    float at(const LeafSamples& samples, const float* v) {
        float& value = values_[v - &samples.values[0][0][0]];
        if (value < 0) value = besideSurface(v);
        return value;
    }

  private:
    float values_[kSize * kSize * kSize];
};

namespace {

// A crossing: where on its edge, and the surface's normal there, of any length.
struct Crossing {
    float t;
    float normal[3];
};

ISOWAVE_INLINE Crossing crossingOf(const float* v, int axis) {
    const float* w = v + kStride[axis];
    Crossing c;
    c.t = *v / (*v - *w);
    for (int a = 0; a < 3; ++a) {
        const int s = kStride[a];
        c.normal[a] = a == axis ? 2 * (*w - *v) : (1 - c.t) * (v[s] - v[-s]) + c.t * (w[s] - w[-s]);
    }
    return c;
}

// Turns the crossing of a hard edge into what the distances of its ends say.
ISOWAVE_INLINE void soften(Crossing& c, float hardness, const LeafSamples& samples, const float* v, int axis,
                           CrossingDistances::Beside& beside) {
    const int s = kStride[axis];
    const float* w = v + s;
    const float from = beside.at(samples, v), to = beside.at(samples, w);
    if (!(from + to > 0)) return;
    const float t = from / (from + to), up = *w > *v ? 1.0f : -1.0f;
    const float central = up * ((1 - t) * (*w - v[-s]) + t * (w[s] - *v));
    const float along = up * std::max(std::abs(*w - *v), central);
    c.t += hardness * (t - c.t);
    c.normal[axis] += hardness * (along - c.normal[axis]);
}

// From a point to the disc around a crossing, the point given from there.
ISOWAVE_INLINE float toDisc(const float (&g)[3], const float (&p)[3]) {
    const float gg = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    const float gp = g[0] * p[0] + g[1] * p[1] + g[2] * p[2];
    const float mm = gg > 0 ? gp * gp / gg : pp;
    const float beyond = std::max(0.0f, std::sqrt(std::max(0.0f, pp - mm)) - kDisc);
    return std::sqrt(mm + beyond * beyond);
}

// From lattice point (i, j, k) of the leaf to its nearest crossing's disc.
ISOWAVE_INLINE float toNearest(const LeafSamples& samples, Key key, const int (&point)[3],
                               CrossingDistances::Beside& beside) {
    const int axis = key & 3;
    int start[3];  // of the edge, from the first sample on
    for (int a = 0; a < 3; ++a) start[a] = point[a] + (key >> kShift[a] & 15);
    const float* v = &samples.values[start[0]][start[1]][start[2]];
    Crossing c = crossingOf(v, axis);
    // An edge at the block's border has no samples beyond it; it is at least 4 away.
    if (start[axis] > 0 && start[axis] < kSize - 2)
        if (const float hardness = hardnessOf(v, kStride[axis]); hardness > 0)
            soften(c, hardness, samples, v, axis, beside);
    float p[3];
    for (int a = 0; a < 3; ++a) p[a] = float(point[a] + kBefore - start[a]) - (a == axis ? c.t : 0.0f);
    return toDisc(c.normal, p);
}

ISOWAVE_INLINE float distanceAt(const LeafSamples& samples, Key key, int i, int j, int k,
                                CrossingDistances::Beside& beside) {
    float distance = toNearest(samples, key, {i, j, k}, beside);
    const float* v = &samples.values[i + kBefore][j + kBefore][k + kBefore];
    if (const float hardness = hardnessAt(v); hardness > 0)
        distance += hardness * (beside.at(samples, v) - distance);
    return distance;
}

ISOWAVE_INLINE bool fillDistances(const LeafSamples& samples, const Key (&nearest)[8][8][8], float halfWidth,
                                  CrossingDistances::Beside& beside, float* values) {
    // The plane around a crossing may be nearer than the crossing.
    constexpr Key kFar = (kReach * kReach + 2) * kUnit;
    constexpr float kLeast = 1e-6f;
    beside.forget();
    bool any = false;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
            for (int k = 0; k < 8; ++k) {
                const Key key = nearest[i][j][k];
                float d = halfWidth;
                if (key < kFar) d = std::min(d, distanceAt(samples, key, i, j, k, beside));
                any |= d < halfWidth;
                const bool inside = samples.values[i + kBefore][j + kBefore][k + kBefore] > 0;
                *values++ = inside ? -std::max(d, kLeast) : d;
            }
    return any;
}

}  // namespace

CrossingDistances::CrossingDistances(Vectors widest)
    : vectors_(widest), scratch_(std::make_unique<Scratch>()), beside_(std::make_unique<Beside>()) {}
CrossingDistances::~CrossingDistances() = default;
CrossingDistances::CrossingDistances(CrossingDistances&&) noexcept = default;

template <int N>
ISOWAVE_INLINE bool CrossingDistances::computeBy(const LeafSamples& samples, float halfWidth, float* values) {
    using P = Passes<N>;
    Scratch& s = *scratch_;
    if (!collectSigns(samples, s)) return false;
    P::ownAxes(samples, s);
    P::thirdAlongFirst(s);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) P::row(s, i, j);
    return fillDistances(samples, s.all, halfWidth, *beside_, values);
}

ISOWAVE_FOUR bool CrossingDistances::computeByEight(const LeafSamples& samples, float halfWidth,
                                                    float* values) {
    return computeBy<8>(samples, halfWidth, values);
}

bool CrossingDistances::compute(const LeafSamples& samples, float halfWidth, float* values) {
    if (vectors_ == Vectors::two) return computeBy<4>(samples, halfWidth, values);
    return computeByEight(samples, halfWidth, values);
}

}  // namespace isowave
