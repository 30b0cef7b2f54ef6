// The signs of everything above the leaves of a narrow-band grid.
#pragma once

#include "volume/tiles.h"
#include "volume/vdb.h"

namespace isowave {

// Tiles become -width where inside(first lattice point) and +width elsewhere. Right wherever no surface
// passes through a slot that has no child: then the sign of one lattice point is the sign of all. Nested
// voids and solids need nothing more, unlike in a flood fill, which carries the sign of the last leaf on.
// box: lattice points beyond it are outside. inside may be called by several threads at once.
// REQUIRES: background +width; no active tiles.
template <class Inside>
void signTiles(openvdb::FloatTree& tree, const openvdb::CoordBBox& box, float width, const Inside& inside) {
    fillTiles(tree, [&] { return [&](const openvdb::Coord& p) { return inside(p) ? -width : width; }; });

    // The root has no slots: where it knows of no child it is background, so inside tiles must be put there.
    using Child = openvdb::FloatTree::RootNodeType::ChildNodeType;
    if (box.empty()) return;
    const auto corner = [](const openvdb::Coord& p) { return p & ~std::int32_t(Child::DIM - 1); };
    const openvdb::Coord low = corner(box.min()), high = corner(box.max());
    for (std::int64_t x = low.x(); x <= high.x(); x += Child::DIM) {
        for (std::int64_t y = low.y(); y <= high.y(); y += Child::DIM) {
            for (std::int64_t z = low.z(); z <= high.z(); z += Child::DIM) {
                const openvdb::Coord origin{std::int32_t(x), std::int32_t(y), std::int32_t(z)};
                const bool hasChild = tree.root().template probeConstNode<Child>(origin) != nullptr;
                if (!hasChild && inside(origin)) tree.root().addTile(origin, -width, false);
            }
        }
    }
}

}  // namespace isowave
