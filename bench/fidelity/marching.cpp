#include "marching.h"

#include <openvdb/tools/Dense.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "polygonize/cell_table.h"

namespace isowave::bench {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr double kMargin = 1e-3;  // of an edge
constexpr std::uint32_t kNone = ~0u;

Coord unit(int axis) { return {axis == 0, axis == 1, axis == 2}; }

bool inside(const DenseField& field, const Coord& c) { return field.at(c) < 0; }

// The vertex on the edge from c along an axis whose ends differ.
Point crossing(const DenseField& field, const Coord& c, int axis) {
    const double a = field.at(c), b = field.at(c + unit(axis));
    const double t = std::clamp(a / (a - b), kMargin, 1 - kMargin);
    const Vec3d p = field.place(c) + field.spacing * t * unit(axis).asVec3d();
    return {p[0], p[1], p[2]};
}

unsigned patternOf(const DenseField& field, const Coord& cell) {
    unsigned pattern = 0;
    for (unsigned corner = 0; corner < 8; ++corner)
        pattern |=
            unsigned{inside(field, cell.offsetBy(int(corner & 1), int(corner >> 1 & 1), int(corner >> 2)))}
            << corner;
    return pattern;
}

}  // namespace

DenseField denseField(const openvdb::FloatGrid& grid) {
    DenseField field;
    field.box = grid.evalActiveVoxelBoundingBox();
    field.box.expand(2);
    openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(field.box, grid.background());
    openvdb::tools::copyToDense(grid, dense);
    field.values.assign(dense.data(), dense.data() + dense.valueCount());
    return field;
}

DenseField meanPooled(const DenseField& fine) {
    // One more coarse point around, which is outside: the border stays closed.
    DenseField coarse;
    coarse.box = CoordBBox((fine.box.min() >> 1).offsetBy(-1), (fine.box.max() >> 1).offsetBy(1));
    coarse.spacing = 2 * fine.spacing;
    coarse.origin = fine.origin + Vec3d(0.5 * fine.spacing);
    coarse.values.resize(coarse.box.volume());
    const float outside = fine.at(fine.box.min());
    tbb::parallel_for(coarse.box.min()[0], coarse.box.max()[0] + 1, [&](int x) {
        for (int y = coarse.box.min()[1]; y <= coarse.box.max()[1]; ++y)
            for (int z = coarse.box.min()[2]; z <= coarse.box.max()[2]; ++z) {
                float sum = 0;
                for (int k = 0; k < 8; ++k) {
                    const Coord c(2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2));
                    sum += fine.box.isInside(c) ? fine.at(c) : outside;
                }
                coarse.values[coarse.index({x, y, z})] = sum / 8;
            }
    });
    return coarse;
}

TriangleMesh marchingCubes(const DenseField& field) {
    TriangleMesh mesh;
    std::vector<std::array<std::uint32_t, 3>> vertexOf(field.values.size(), {kNone, kNone, kNone});
    const CoordBBox cells(field.box.min(), field.box.max().offsetBy(-1));
    for (auto c = field.box.begin(); c; ++c)
        for (int axis = 0; axis < 3; ++axis) {
            if ((*c)[axis] == field.box.max()[axis]) continue;
            if (inside(field, *c) == inside(field, *c + unit(axis))) continue;
            vertexOf[field.index(*c)][axis] = static_cast<std::uint32_t>(mesh.points.size());
            mesh.points.push_back(crossing(field, *c, axis));
        }
    const CellTable& table = cellTable();
    for (auto cell = cells.begin(); cell; ++cell) {
        // Ambiguous faces separate, and no loops are joined by tunnels, whose vertices lie inside the cell.
        const unsigned pattern = patternOf(field, *cell);
        const CellCase* found = &table.at(pattern, {0, false});
        if (found->rays != 0) found = &table.at(pattern, {0, true});
        for (const auto& corners : found->triangles) {
            Triangle triangle;
            for (int i = 0; i < 3; ++i) {
                const CellEdge& edge = table.edge(corners[i]);
                triangle[i] = vertexOf[field.index((*cell).offsetBy(edge.x, edge.y, edge.z))][edge.axis];
            }
            mesh.triangles.push_back(triangle);
        }
    }
    return mesh;
}

}  // namespace isowave::bench
