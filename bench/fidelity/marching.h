// Marching cubes as everybody knows it: values on a dense lattice, vertices where the values, interpolated linearly, are 0.
#pragma once

#include <functional>
#include <vector>

#include "isowave/mesh.h"
#include "volume/vdb.h"

namespace isowave::bench {

// Values at the points of a box, z fastest; lattice point i lies at origin + spacing * i.
struct DenseField {
    openvdb::CoordBBox box;
    std::vector<float> values;
    openvdb::Vec3d origin{0.0};
    double spacing = 1;

    std::size_t index(const openvdb::Coord& c) const {
        const openvdb::Coord size = box.dim(), d = c - box.min();
        return (static_cast<std::size_t>(d[0]) * size[1] + d[1]) * size[2] + d[2];
    }
    float at(const openvdb::Coord& c) const { return values[index(c)]; }
    openvdb::Vec3d place(const openvdb::Coord& c) const { return origin + spacing * c.asVec3d(); }
};

DenseField denseField(const openvdb::FloatGrid& grid);

// Means of 2x2x2: coarse point j stands for 2j and 2j + 1 on each axis, and lies between them.
DenseField meanPooled(const DenseField& fine);

// Negative is inside. Closed where the box's outermost layer is outside. Vertices stay a thousandth of an edge away from
// lattice points, as isowave's do.
TriangleMesh marchingCubes(const DenseField& field);

}  // namespace isowave::bench
