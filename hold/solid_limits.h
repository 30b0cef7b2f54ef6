// How many parts, handles and cavities a level may have, and how many it has.
#pragma once

#include <cstdint>
#include <optional>

#include "isowave/ladder.h"
#include "volume/field.h"

namespace isowave {

// At most so many; what is not given is not limited.
struct SolidLimits {
    std::optional<std::int64_t> parts = {}, handles = {}, cavities = {};

    bool any() const { return parts || handles || cavities; }
    bool allow(const SolidCounts& counts) const;
};

// Of the mesh that polygonize() makes of F = 0 at this refinement, without the components that are smaller
// than `smallestPart` (world units^3; removeSpecks()). REQUIRES: refine is 1, 2 or 4. Throws as polygonize().
SolidCounts meshedCounts(const BSplineField& field, int refine, double smallestPart,
                         const Progress& progress = {});

}  // namespace isowave
