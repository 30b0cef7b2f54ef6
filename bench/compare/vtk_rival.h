// The CT user's default: FlyingEdges on the dense grid, then quadric decimation to given numbers of triangles.
#pragma once

#include <cstdint>
#include <vector>

namespace isowave::bench {

struct VtkLevels {
    std::vector<std::int64_t> triangles;  // of each level
    double contourSeconds = 0, decimateSeconds = 0;
};

// values: size^3, x fastest; iso surface at 0. wanted: numbers of triangles of levels 1, 2, ...; each is decimated from
// the one before, which is the fastest way to have them all.
VtkLevels vtkLevels(std::vector<float>& values, int size, const std::vector<std::int64_t>& wanted);

}  // namespace isowave::bench
