// Lines through points (isowave/mesh.h), as files hold them.
#pragma once

#include <algorithm>
#include <cstddef>

#include "isowave/mesh.h"

namespace isowave {

// Files close a line by writing its first point again: takes that copy away, if there is one and another point, and
// calls the line closed.
inline void dropClosingCopy(Polyline& line) {
    auto& c = line.coordinates;
    if (line.size() < 3 || !std::equal(c.begin(), c.begin() + line.dimension, c.end() - line.dimension))
        return;
    c.resize(c.size() - static_cast<std::size_t>(line.dimension));
    line.closed = true;
}

}  // namespace isowave
