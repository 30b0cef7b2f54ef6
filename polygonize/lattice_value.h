// F as a mesh knows it: from its values at lattice points.
#pragma once

#include <array>
#include <cmath>

#include "volume/vdb.h"

namespace isowave {

// The trilinear interpolation, at index-space point x, of F at the 8 lattice points around it. The mesh sees
// the field at lattice points only: a wall, or a hole, between two of them is not in the mesh, although F has
// it.
// c: control points. On an axis, t beyond lattice point i of the cell:
//   (1-t) (c[i-1] + 4 c[i] + c[i+1])/6 + t (c[i] + 4 c[i+1] + c[i+2])/6
inline double latticeInterpolated(const openvdb::FloatGrid::ConstUnsafeAccessor& c, const openvdb::Vec3d& x) {
    std::array<std::array<double, 4>, 3> w;
    openvdb::Coord first;
    for (int a = 0; a < 3; ++a) {
        const double cell = std::floor(x[a]), t = x[a] - cell, u = 1 - t;
        first[a] = static_cast<int>(cell) - 1;
        w[a] = {u / 6, (4 * u + t) / 6, (u + 4 * t) / 6, t / 6};
    }
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k)
                sum += w[0][i] * w[1][j] * w[2][k] * c.getValue(first.offsetBy(i, j, k));
    return sum;
}

}  // namespace isowave
