// What of a solid lies in a box, somewhere else: max(F(x - by), B(x - by)), as an operand.
#pragma once

#include "lod/edit/tool.h"

namespace isowave::lod {

// F is evaluated where its control points are, so that all details move along. field is referred to, not copied.
class MovedPart : public Operand {
  public:
    // box: already moved. by: world units.
    MovedPart(const BSplineField& field, const ToolFunction& box, const Point& by, double voxelsPerK);

    std::vector<openvdb::Coord> leaves(const Progress& progress) const override;
    Side values(const openvdb::Coord& origin, LeafValues& values) const override;

  private:
    const BSplineField& field_;
    const ToolFunction& box_;
    openvdb::Vec3d back_;  // index space
    double w_, scale_;     // voxels; K a voxel
};

}  // namespace isowave::lod
