#include "volume/distance/buried.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "volume/distance/sign_changes.h"
#include "volume/leaf_words.h"
#include "volume/mesh_nearest.h"
#include "volume/tiles.h"

namespace isowave {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using openvdb::Coord;

constexpr double kBeyond = 1.2;

// toChange: D, or more than halfWidth + kBeyond.
template <class Value>
void raise(const Value& value, double toChange, double halfWidth) {
    const auto least = static_cast<float>(toChange - kBeyond);
    if (least <= -*value) return;
    value.setValue(-std::min(least, static_cast<float>(halfWidth)));
    if (least >= static_cast<float>(halfWidth)) value.setValueOff();
}

// Middles of the lattice edges from an inside point to an outside one, as triangles of one point each.
struct SignChanges {
    std::vector<openvdb::Vec3d> middles;
    std::vector<Triangle> triangles;
};

SignChanges signChangesOf(const openvdb::FloatTree& tree, const std::vector<Leaf*>& leaves) {
    SignChanges changes;
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(tree);
    for (const Leaf* leaf : leaves) {
        for (auto value = leaf->cbeginValueOn(); value; ++value) {
            for (int axis = 0; axis < 3; ++axis) {
                openvdb::Coord next = value.getCoord();
                ++next[axis];
                if (std::signbit(*value) == std::signbit(values.getValue(next))) continue;
                const auto index = static_cast<std::uint32_t>(changes.middles.size());
                changes.middles.push_back((value.getCoord().asVec3d() + next.asVec3d()) * 0.5);
                changes.triangles.push_back({index, index, index});
            }
        }
    }
    return changes;
}

// As liftFromBuried(), asking a hierarchy point by point.
void liftFar(const openvdb::FloatTree& tree, const std::vector<Leaf*>& leaves, double halfWidth,
             const Progress& progress) {
    const SignChanges changes = signChangesOf(tree, leaves);
    if (changes.triangles.empty()) return;
    const TriangleHierarchy edges(changes.middles, changes.triangles);
    const double reach = halfWidth + kBeyond;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 16), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (auto value = leaves[i]->beginValueOn(); value; ++value) {
                if (*value > 0) continue;
                const double bound =
                    std::sqrt(edges.nearest(value.getCoord().asVec3d(), {reach * reach, -1}).squared);
                raise(value, bound, halfWidth);
            }
        }
    });
}

// ---- by leaves

// The signs of all places, in a tree of their own: threads read them while others raise values.
openvdb::BoolTree signsOf(const openvdb::FloatTree& tree) {
    openvdb::BoolTree inside(tree, false, openvdb::TopologyCopy());
    std::vector<openvdb::BoolTree::LeafNodeType*> leaves;
    inside.getNodes(leaves);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        setInside(*leaves[i], negativeWordsOf(tree.probeConstLeaf(leaves[i]->origin())->buffer().data()));
    });
    fillTiles(inside, [&tree] {
        return [values = openvdb::tree::ValueAccessor<const openvdb::FloatTree>(tree)](const Coord& c) {
            return values.getValue(c) < 0;
        };
    });
    return inside;
}

using SignAccessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>;

LeafSigns signsAround(const SignAccessor& accessor, const Coord& origin) {
    constexpr int kBefore = LeafSigns::kBefore;
    LeafSigns signs{};
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const Coord at = origin.offsetBy(8 * x, 8 * y, 8 * z);
                LeafWords words;
                if (const auto* leaf = accessor.probeConstNode<openvdb::BoolTree::LeafNodeType>(at))
                    words = insideWordsOf(*leaf);
                else
                    words.fill(accessor.getValue(at) ? ~std::uint64_t(0) : 0);
                for (int i = std::max(-kBefore, 8 * x); i < std::min(8 + kBefore, 8 * x + 8); ++i)
                    for (int j = std::max(-kBefore, 8 * y); j < std::min(8 + kBefore, 8 * y + 8); ++j) {
                        const auto row = static_cast<std::uint32_t>(
                            words[static_cast<std::size_t>(i & 7)] >> 8 * (j & 7) & 0xff);
                        const int shift = 8 * z + kBefore;
                        signs.rows[static_cast<std::size_t>(i + kBefore)]
                                  [static_cast<std::size_t>(j + kBefore)] |=
                            (shift < 0 ? row >> -shift : row << shift) & ((1u << LeafSigns::kSize) - 1);
                    }
            }
    return signs;
}

void liftNear(const openvdb::FloatTree& tree, const std::vector<Leaf*>& leaves, double halfWidth,
              const Progress& progress) {
    const openvdb::BoolTree inside = signsOf(tree);
    const double far = halfWidth + kBeyond;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 16), [&](const auto& range) {
        progress.check();
        const SignAccessor accessor(inside);
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            Leaf& leaf = *leaves[i];
            if (isEmpty(negativeWordsOf(leaf.buffer().data()))) continue;
            const auto fourfold = toSignChanges(signsAround(accessor, leaf.origin()));
            for (auto value = leaf.beginValueOn(); value; ++value)
                if (*value < 0)
                    raise(value, std::min(std::sqrt(fourfold[value.pos()] / 4.0), far), halfWidth);
        }
    });
}

}  // namespace

void liftFromBuried(openvdb::FloatTree& tree, double halfWidth, const Progress& progress) {
    std::vector<Leaf*> leaves;
    tree.getNodes(leaves);
    const double reach = halfWidth + kBeyond;
    (4 * reach * reach <= kFourfoldReach ? liftNear : liftFar)(tree, leaves, halfWidth, progress);
}

}  // namespace isowave
