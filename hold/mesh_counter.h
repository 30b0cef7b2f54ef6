// Parts, handles and cavities of a level's mesh, again and again while the field changes in a few places: what is far from a change is
// not looked at twice.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hold/solid_limits.h"
#include "hold/surface_pieces.h"
#include "volume/field.h"

namespace isowave {

class MeshCounter {
  public:
    // Of polygonize(field, refine) without the components smaller than `smallestPart` (world units^3): what meshedCounts() gives.
    // REQUIRES: refine is 1, 2 or 4.
    MeshCounter(const BSplineField& field, int refine, double smallestPart, const Progress& progress = {});

    SolidCounts counts() const;

    // The field is now `changed`, which differs in the control points of the boxes at most. The transform is the same.
    void change(const BSplineField& changed, const std::vector<openvdb::CoordBBox>& boxes);
    // Back to the field before the last change().
    void undo();

  private:
    // Pieces of this block and of the one ahead on an axis that share a vertex.
    using Links = std::vector<std::pair<std::uint16_t, std::uint16_t>>;
    struct Block {
        openvdb::Coord origin;
        SurfacePieces surface;
        std::array<Links, 3> ahead;
    };
    static constexpr std::size_t kNone = ~std::size_t{0};

    std::size_t find(const openvdb::Coord& origin) const;
    std::size_t findOrAdd(const openvdb::Coord& origin);
    void link(std::size_t block);
    void remember(std::size_t block);
    void replaceIn(const BSplineField& changed, const openvdb::CoordBBox& box,
                   std::vector<std::size_t>& touched);

    int refine_;
    double smallest_;  // lattice cells
    std::vector<Block> blocks_;
    std::unordered_map<openvdb::Coord, std::size_t> byOrigin_;
    std::unordered_map<std::size_t, Block> before_;  // the last change
};

}  // namespace isowave
