// The function whose zero set is a surface: a uniform cubic tensor-product B-spline, negative inside.
//
//   Field field = fieldOf(open("part.stl"), 3);     // step 3 = level 1 of cubic voxels
//   double f = field.value({12.5, 3, 7});           // near the surface: about K / halfWidth a voxel
//   TriangleMesh mesh = field.polygonize();
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/solid.h"
#include "isowave/version.h"

namespace isowave {

struct FieldMeshOptions {
    int refine = 1;  // samples of a node along each axis: 1, 2 or 4
    double iso =
        0;  // the surface is where the field has this value, -K < iso < K; above 0 the solid is thicker
};

// Cheap to copy: copies share the control points.
class ISOWAVE_EXPORT Field {
  public:
    struct State;  // lod/field_state.h

    double K() const;
    std::int64_t controlPointCount() const;
    // Between lattice points along its three axes, world units.
    std::array<double, 3> spacing() const;

    // At a point of the world; ±K far from the surface. O(64) look-ups: for single points.
    double value(const Point& world) const;
    // By world units.
    Point gradient(const Point& world) const;

    // The closed, oriented 2-manifold mesh of the zero set, with normals. Throws OperationError past 2^31 - 1 triangles,
    // UsageError for another refine or iso.
    TriangleMesh polygonize(const FieldMeshOptions& options = {}, const Progress& progress = {}) const;

    // As the one grid "field" of a .vdb: control points, negative inside, for Houdini, Blender and other tools. Throws
    // OperationError.
    void save(const std::filesystem::path& path) const;

  private:
    explicit Field(std::shared_ptr<const State> state) : state_(std::move(state)) {}
    friend struct FieldAccess;
    std::shared_ptr<const State> state_;
};

// The field of a step of a solid (level l is step Solid::order().stepOf(l)). Throws InputError where the solid does not go so far.
ISOWAVE_EXPORT Field fieldOf(Solid solid, int step = 0, const Progress& progress = {});

}  // namespace isowave
