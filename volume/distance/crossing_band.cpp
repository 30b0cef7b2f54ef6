#include "volume/distance/crossing_band.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "volume/leaf_words.h"
#include "volume/tiles.h"

namespace isowave {
namespace {

using openvdb::Coord;
using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;

// ---- leaves

// First and last bit of a byte that is not 0.
struct Span {
    int low, high;
    explicit Span(unsigned bits) : low(std::countr_zero(bits)), high(std::bit_width(bits) - 1) {}
};

// A leaf's active nodes lie in this box, on each axis.
std::array<Span, 3> boxOf(const BoolLeaf& leaf) {
    const LeafWords words = wordsOf(leaf.valueMask());
    unsigned x = 0, y = 0, z = 0;
    std::uint64_t all = 0;
    for (unsigned i = 0; i < 8; ++i) {
        x |= unsigned(words[i] != 0) << i;
        all |= words[i];
    }
    for (unsigned j = 0; j < 8; ++j) {
        const auto row = static_cast<unsigned>(all >> 8 * j & 0xff);
        y |= unsigned(row != 0) << j;
        z |= row;
    }
    return {Span(x), Span(y), Span(z)};
}

// Leaves by one number each, whose order is by z, y, x.
constexpr std::int64_t kOffset = 1 << 20;
std::uint64_t numberOf(const Coord& origin) {
    const auto part = [&](int a) { return static_cast<std::uint64_t>((origin[a] >> 3) + kOffset); };
    return part(2) << 42 | part(1) << 21 | part(0);
}
Coord originOf(std::uint64_t number) {
    const auto part = [&](int shift) {
        return static_cast<int>(static_cast<std::int64_t>(number >> shift & (2 * kOffset - 1)) - kOffset) * 8;
    };
    return {part(0), part(21), part(42)};
}

// Adds the numbers of the leaves within reach of a leaf's nodes. A node at i ends at i + 1.
void addBeside(const BoolLeaf& leaf, int reach, std::vector<std::uint64_t>& numbers) {
    const auto box = boxOf(leaf);
    std::array<int, 3> first, last;
    for (std::size_t a = 0; a < 3; ++a) {
        first[a] = (box[a].low - reach + 1) >> 3;
        last[a] = (box[a].high + reach) >> 3;
    }
    for (int x = first[0]; x <= last[0]; ++x)
        for (int y = first[1]; y <= last[1]; ++y)
            for (int z = first[2]; z <= last[2]; ++z)
                numbers.push_back(numberOf(leaf.origin().offsetBy(8 * x, 8 * y, 8 * z)));
}

// ---- wider

// Values to ±w by sign of `inside` where they are farther or unknown, and tiles likewise.
void clampTo(openvdb::FloatTree& tree, const openvdb::BoolTree& inside, float w) {
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(tree);
    leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
        const openvdb::tree::ValueAccessor<const openvdb::BoolTree> signs(inside);
        for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i) {
            const float d = leaf.isValueOn(i) ? std::min(std::abs(leaf.getValue(i)), w) : w;
            leaf.setValueOnly(i, signs.getValue(leaf.offsetToGlobalCoord(i)) ? -std::max(d, 1e-6f) : d);
            leaf.setActiveState(i, d < w);
        }
    });
    tree.root().setBackground(w, false);
    fillTiles(tree, [&] {
        return [signs = openvdb::tree::ValueAccessor<const openvdb::BoolTree>(inside), w](const Coord& c) {
            return signs.getValue(c) ? -w : w;
        };
    });
}

// Crossings are ratios of samples: a power of two changes no bit of them, and squares of 1e-30 or 1e30 are no floats. Zero keeps its
// sign.
void bringNearOne(LeafSamples& samples) {
    constexpr float kSmall = 1e-9f, kLarge = 1e9f;
    float most = 0;
    float* const first = &samples.values[0][0][0];
    constexpr int kCount = LeafSamples::kSize * LeafSamples::kSize * LeafSamples::kSize;
    for (int i = 0; i < kCount; ++i) most = std::max(most, std::abs(first[i]));
    if (!(most > 0) || (most > kSmall && most < kLarge) || std::isinf(most)) return;
    const int exponent = -std::ilogb(most);
    for (int i = 0; i < kCount; ++i) first[i] = std::ldexp(first[i], exponent);
}

}  // namespace

std::vector<Coord> leavesWithin(const NodeCollection& nodes, int reach) {
    std::vector<const BoolLeaf*> leaves;
    nodes.grid->constTree().getNodes(leaves);
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (!leaves[i]->valueMask().isOff()) addBeside(*leaves[i], reach, found.local());
    });
    std::vector<std::uint64_t> numbers;
    for (const auto& some : found) numbers.insert(numbers.end(), some.begin(), some.end());
    tbb::parallel_sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<Coord> origins(numbers.size());
    std::transform(numbers.begin(), numbers.end(), origins.begin(), originOf);
    return origins;
}

LeafMaker::LeafMaker(double halfWidth)
    : halfWidth_(static_cast<float>(std::min(halfWidth, double(CrossingDistances::kReach)))) {}

FloatLeafPtr LeafMaker::make(const Coord& origin, bool xFastest) {
    std::array<float, 512> values;
    bringNearOne(samples_);
    if (!distances_.compute(samples_, halfWidth_, values.data())) return nullptr;
    auto leaf = std::make_unique<FloatLeaf>(origin, 0.0f, false);
    float* out = leaf->buffer().data();
    LeafWords active{};
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z, ++out) {
                *out = values[static_cast<std::size_t>(xFastest ? z << 6 | y << 3 | x : x << 6 | y << 3 | z)];
                active[static_cast<std::size_t>(x)] |= std::uint64_t(std::abs(*out) < halfWidth_)
                                                       << (8 * y + z);
            }
    leaf->setValueMask(maskOf(active));
    return leaf;
}

openvdb::FloatGrid::Ptr bandGrid(std::vector<FloatLeafPtr> leaves, const NodeCollection& signs,
                                 double halfWidth) {
    const auto w = static_cast<float>(halfWidth), known = std::min(w, float(CrossingDistances::kReach));
    const openvdb::BoolTree& inside = signs.grid->constTree();
    auto grid = openvdb::FloatGrid::create(known);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    hangLeaves(leaves, grid->tree());
    fillInsideTiles(grid->tree(), inside, -1, -known);
    if (w > known) {
        grid = openvdb::tools::dilateSdf(*grid, static_cast<int>(std::ceil(w - known)) + 1,
                                         openvdb::tools::NN_FACE_EDGE_VERTEX);
        clampTo(grid->tree(), inside, w);
    }
    return grid;
}

}  // namespace isowave
