#include "lod/slabs/slab_cuts.h"

namespace isowave::lod {
namespace {

constexpr int kLeaf = 8;
constexpr int kFar = 1 << 29;  // further than any lattice point, and a multiple of 8

// At the nearest place between leaves, unless that is not beyond 0 and the last one.
void addCut(std::vector<int>& at, int cut) {
    const int rounded = (cut + kLeaf / 2) & ~(kLeaf - 1);
    if (rounded > (at.empty() ? 0 : at.back())) at.push_back(rounded);
}

}  // namespace

SlabCuts SlabCuts::even(int axis, std::int64_t size, int slabs) {
    SlabCuts cuts{axis, {}};
    for (int i = 1; i < slabs; ++i) {
        const auto cut = static_cast<int>(size * i / slabs);
        if (cut + kLeaf / 2 < size) addCut(cuts.at, cut);
    }
    return cuts;
}

LeafBox SlabCuts::box(int slab) const {
    LeafBox box(openvdb::Coord(-kFar), openvdb::Coord(kFar - 1));
    if (slab > 0) box.min()[axis] = at[static_cast<std::size_t>(slab - 1)];
    if (slab + 1 < count()) box.max()[axis] = at[static_cast<std::size_t>(slab)] - 1;
    return box;
}

SlabCuts SlabCuts::halved() const {
    SlabCuts cuts{axis, {}};
    for (const int cut : at) addCut(cuts.at, cut / 2);
    return cuts;
}

}  // namespace isowave::lod
