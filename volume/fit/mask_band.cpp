#include "volume/fit/mask_band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

// candidates  leaves with a stabbed node and those beside them: a point of the band and the nearest point of the other
//             side differ by at most 4 along each axis, and some lattice edge between them changes sign, so a stabbed
//             node starts no farther away
// measure     exact distances, axis by axis; leaves without a point of the band go
// link        leaves to their neighbours

namespace isowave::fitting {
namespace {

using openvdb::Coord;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using Accessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>;

std::vector<Coord> candidates(const openvdb::BoolTree& inside) {
    std::vector<Coord> origins;
    for (auto leaf = inside.cbeginLeaf(); leaf; ++leaf)
        if (!leaf->isEmpty())
            for (int b = 0; b < 27; ++b)
                origins.push_back(
                    leaf->origin().offsetBy(8 * (b / 9 - 1), 8 * (b / 3 % 3 - 1), 8 * (b % 3 - 1)));
    std::sort(origins.begin(), origins.end());
    origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
    return origins;
}

// 1: inside.
using Sides = PaddedLeaf<std::uint8_t, kBandReach, kBandReach>;

void gatherSides(const openvdb::BoolTree& inside, const Coord& origin, Sides& sides) {
    sides.gatherRows(Accessor(inside), origin, [](const BoolLeaf& leaf) {
        return [words = insideWordsOf(leaf)](openvdb::Index offset, int count, std::uint8_t* out) {
            const std::uint64_t row = words[offset >> 6] >> (offset & 63);
            for (int i = 0; i < count; ++i) out[i] = row >> i & 1;
        };
    });
}

// Squares of distances, as far as offsets of kBandReach along each axis find them; kFar, or more, where they do not.
using Squares = std::array<std::uint8_t, 512>;
constexpr std::uint8_t kFar = 64;

// min over k of in[k * stride] + k^2 for `count` places; in: the first of 2 kBandReach + 1.
void nearestAlong(const std::uint8_t* in, int stride, int count, std::uint8_t* out) {
    std::fill_n(out, count, std::uint8_t{255});
    for (int k = -kBandReach; k <= kBandReach; ++k, in += stride)
        for (int i = 0; i < count; ++i) out[i] = std::min(out[i], static_cast<std::uint8_t>(in[i] + k * k));
}

// To the nearest point whose side is `to`. Axis by axis, as the distance's square is a sum.
Squares squaresTo(std::uint8_t to, const Sides& sides) {
    constexpr int n = Sides::kSize;
    std::array<std::uint8_t, n * n * n> start;
    for (std::size_t i = 0; i < start.size(); ++i) start[i] = sides.values[i] == to ? 0 : kFar;
    std::array<std::uint8_t, n * n * 8> z;
    for (int xy = 0; xy < n * n; ++xy) nearestAlong(&start[n * xy], 1, 8, &z[8 * xy]);
    std::array<std::uint8_t, n * 64> y;
    for (int x = 0; x < n; ++x) nearestAlong(&z[n * 8 * x], 8, 64, &y[64 * x]);
    Squares squares;
    for (int x = 0; x < 8; ++x) nearestAlong(&y[64 * x], 64, 64, &squares[64 * x]);
    return squares;
}

// Whether any point is of the band.
bool measure(const openvdb::BoolTree& inside, const Coord& origin, LeafValues& distance) {
    static const auto kRoots = [] {
        std::array<float, kBandSquared + 1> roots;
        for (int i = 0; i <= kBandSquared; ++i) roots[i] = static_cast<float>(std::sqrt(i));
        return roots;
    }();
    Sides sides;
    gatherSides(inside, origin, sides);
    const Squares toInside = squaresTo(1, sides), toOutside = squaresTo(0, sides);
    bool any = false;
    for (int i = 0; i < 512; ++i) {
        const bool isInside = sides.at(i >> 6, i >> 3 & 7, i & 7) == 1;
        const int square = isInside ? toOutside[i] : toInside[i];
        const bool near = square <= kBandSquared;
        any |= near;
        distance[i] = (isInside ? -1.0f : 1.0f) * (near ? kRoots[square] : kBeyondBand);
    }
    return any;
}

void link(MaskBand& band, const openvdb::BoolTree& inside) {
    band.beside.resize(band.leafCount());
    const auto& origins = band.origins;
    tbb::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t i) {
        const Accessor accessor(inside);
        for (int b = 0; b < 27; ++b) {
            const Coord at = origins[i].offsetBy(8 * (b / 9 - 1), 8 * (b / 3 % 3 - 1), 8 * (b % 3 - 1));
            const auto found = std::lower_bound(origins.begin(), origins.end(), at);
            const bool isLeaf = found != origins.end() && *found == at;
            band.beside[i][static_cast<std::size_t>(b)] =
                isLeaf ? static_cast<std::int32_t>(found - origins.begin())
                       : (accessor.getValue(at) ? MaskBand::kInside : MaskBand::kOutside);
        }
    });
}

}  // namespace

MaskBand bandAround(const openvdb::BoolTree& inside) {
    MaskBand band;
    band.origins = candidates(inside);
    band.distance.resize(band.origins.size());
    std::vector<char> kept(band.origins.size());
    tbb::parallel_for(std::size_t{0}, kept.size(),
                      [&](std::size_t i) { kept[i] = measure(inside, band.origins[i], band.distance[i]); });
    std::size_t count = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i]) {
            band.origins[count] = band.origins[i];
            if (count != i) band.distance[count] = band.distance[i];
            ++count;
        }
    band.origins.resize(count);
    band.distance.resize(count);
    band.distance.shrink_to_fit();
    link(band, inside);
    return band;
}

}  // namespace isowave::fitting
