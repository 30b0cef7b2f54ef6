// The promises of volume/tiles.h.
#include "volume/tiles.h"

#include <gtest/gtest.h>

#include <random>

namespace isowave {
namespace {

using openvdb::BoolTree;
using openvdb::Coord;
using openvdb::FloatTree;

constexpr int kLower = 128, kUpper = 4096;

// Leaves, and tiles of every size, some inside, on both sides of the origin. What is in a leaf's slot has one
// value.
BoolTree randomShape(std::mt19937& rng) {
    BoolTree shape(false);
    const auto at = [&](int reach) {
        Coord c;
        for (int a = 0; a < 3; ++a) c[a] = static_cast<int>(rng() % (2 * reach)) - reach;
        return c;
    };
    for (int i = 0; i < 4; ++i) shape.addTile(3, at(2 * kUpper), true, false);          // of 4096^3
    for (int i = 0; i < 2000; ++i) shape.addTile(2, at(kUpper / 2), rng() % 3, false);  // of 128^3
    for (int i = 0; i < 400; ++i) shape.addTile(1, at(kLower), rng() % 3, false);       // of 8^3
    for (int i = 0; i < 300; ++i) {
        const Coord c = at(i % 2 ? kLower : kUpper);
        shape.touchLeaf(c)->fill(shape.getValue(c));
    }
    return shape;
}

// A tree with some leaves; its other slots are tiles of the background.
template <class Tree>
Tree someLeaves(std::mt19937& rng, typename Tree::ValueType background) {
    Tree tree(background);
    for (int i = 0; i < 200; ++i) {
        Coord c;
        for (int a = 0; a < 3; ++a) c[a] = static_cast<int>(rng() % 3000) - 1500;
        tree.touchLeaf(c);
    }
    return tree;
}

template <class Tree>
void expectTilesOf(const Tree& tree, const BoolTree& shape, int halved, typename Tree::ValueType inside) {
    int tiles = 0, insideTiles = 0;
    for (auto it = tree.cbeginValueAll(); it; ++it) {
        if (it.getDepth() == 3) continue;  // not leaves'
        Coord c = it.getCoord();
        if (halved >= 0) c[halved] *= 2;
        const bool expected = shape.getValue(c);
        ASSERT_EQ(*it, expected ? inside : tree.background()) << it.getCoord() << ' ' << halved;
        ++tiles;
        insideTiles += expected;
    }
    EXPECT_GT(insideTiles, 100);  // seen 600 and more
    EXPECT_GT(tiles - insideTiles, 100);
}

TEST(FillInsideTiles, GivesWhatALookIntoTheShapeDoes) {
    std::mt19937 rng(1);
    for (int trial = 0; trial < 3; ++trial) {
        const BoolTree shape = randomShape(rng);
        for (int halved = -1; halved < 3; ++halved) {
            auto field = someLeaves<FloatTree>(rng, 4.0f);
            fillInsideTiles(field, shape, halved, -4.0f);
            expectTilesOf(field, shape, halved, -4.0f);
            auto coarse = someLeaves<BoolTree>(rng, false);
            fillInsideTiles(coarse, shape, halved, true);
            expectTilesOf(coarse, shape, halved, true);
        }
    }
}

TEST(FillInsideTiles, LeavesAreLeftAlone) {
    std::mt19937 rng(2);
    const BoolTree shape = randomShape(rng);
    auto field = someLeaves<FloatTree>(rng, 4.0f);
    for (auto leaf = field.beginLeaf(); leaf; ++leaf)
        for (openvdb::Index i = 0; i < 512; ++i)
            leaf->setValueOnly(i, static_cast<float>(leaf->origin().x()) + static_cast<float>(i) / 1024);
    const auto leaves = field.leafCount();
    fillInsideTiles(field, shape, 1, -4.0f);
    EXPECT_EQ(field.leafCount(), leaves);
    for (auto leaf = field.cbeginLeaf(); leaf; ++leaf)
        for (openvdb::Index i = 0; i < 512; ++i)
            ASSERT_EQ(leaf->getValue(i),
                      static_cast<float>(leaf->origin().x()) + static_cast<float>(i) / 1024);
}

}  // namespace
}  // namespace isowave
