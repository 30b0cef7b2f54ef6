#include "volume/distance/leaves.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace isowave {
namespace {

using openvdb::Coord;
using Upper = openvdb::FloatTree::RootNodeType::ChildNodeType;
using Lower = Upper::ChildNodeType;

// Leaves of a region, which is one internal node.
using Region = std::vector<FloatLeafPtr*>;

std::vector<Region> regionsOf(std::vector<FloatLeafPtr>& leaves) {
    std::vector<FloatLeafPtr*> order;
    for (FloatLeafPtr& leaf : leaves)
        if (leaf) order.push_back(&leaf);
    const auto regionOf = [](const FloatLeafPtr* leaf) {
        return (*leaf)->origin() & ~std::int32_t(Lower::DIM - 1);
    };
    tbb::parallel_sort(order.begin(), order.end(), [&](const FloatLeafPtr* a, const FloatLeafPtr* b) {
        const Coord p = regionOf(a), q = regionOf(b);
        return p != q ? p < q : (*a)->origin() < (*b)->origin();
    });
    std::vector<Region> regions;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || regionOf(order[i]) != regionOf(order[i - 1])) regions.emplace_back();
        regions.back().push_back(order[i]);
    }
    return regions;
}

}  // namespace

void hangLeaves(std::vector<FloatLeafPtr>& leaves, openvdb::FloatTree& tree) {
    std::vector<Region> regions = regionsOf(leaves);
    std::vector<std::unique_ptr<Lower>> nodes(regions.size());
    tbb::parallel_for(std::size_t(0), regions.size(), [&](std::size_t i) {
        nodes[i] = std::make_unique<Lower>((*regions[i].front())->origin(), tree.background());
        for (FloatLeafPtr* leaf : regions[i]) nodes[i]->addChild(leaf->release());
    });
    for (auto& node : nodes) {
        const Coord origin = node->origin();
        if (!tree.root().probeNode<Upper>(origin)) tree.root().addChild(new Upper(origin, tree.background()));
        tree.root().probeNode<Upper>(origin)->addChild(node.release());
    }
}

}  // namespace isowave
