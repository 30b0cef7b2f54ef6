#include "isowave/field.h"

#include <fmt/format.h>

#include <cmath>

#include "isowave/openvdb.h"
#include "lod/field_state.h"
#include "lod/option_checks.h"
#include "lod/steps.h"
#include "polygonize/polygonize.h"
#include "volume/vdb_file.h"

namespace isowave {
namespace {

openvdb::Vec3d vectorOf(const Point& p) { return {p[0], p[1], p[2]}; }

}  // namespace

double Field::K() const { return state_->field.K; }
std::int64_t Field::controlPointCount() const { return state_->field.controlPointCount(); }

std::array<double, 3> Field::spacing() const {
    const openvdb::Vec3d spacing = state_->field.transform().voxelSize();
    return {spacing.x(), spacing.y(), spacing.z()};
}

double Field::value(const Point& world) const {
    const BSplineField& field = state_->field;
    return evaluate(field, field.transform().worldToIndex(vectorOf(world)));
}

// F(x(i)) by the chain rule: the gradient in the world is the inverse transposed Jacobian times that in index space.
Point Field::gradient(const Point& world) const {
    const BSplineField& field = state_->field;
    const openvdb::Vec3d index = evaluateGradient(field, field.transform().worldToIndex(vectorOf(world)));
    const openvdb::Vec3d g = field.transform().baseMap()->applyIJT(index);
    return {g.x(), g.y(), g.z()};
}

TriangleMesh Field::polygonize(const FieldMeshOptions& options, const Progress& progress) const {
    lod::requireRefine(options.refine);
    if (!(std::abs(options.iso) < K()))
        throw UsageError(fmt::format(
            "iso {:g} is not between -{:g} and {:g}, the least and the greatest value of the field",
            options.iso, K(), K()));
    return isowave::polygonize(state_->field, {.refine = options.refine, .iso = options.iso}, progress);
}

void Field::save(const std::filesystem::path& path) const { writeField(path, state_->field); }

Field fieldOf(Solid solid, int step, const Progress& progress) {
    StageClock unused;
    return FieldAccess::make(lod::fieldAtStep(std::move(solid), step, progress, unused));
}

openvdb::FloatGrid::ConstPtr gridOf(const Field& field) { return FieldAccess::of(field).controlPoints; }

Field fieldOf(openvdb::FloatGrid::Ptr controlPoints, openvdb::BoolGrid::Ptr inside, double K) {
    return FieldAccess::make({std::move(controlPoints), std::move(inside), K});
}

}  // namespace isowave
