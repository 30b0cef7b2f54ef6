// What is behind a Solid, for isowave's own sources.
#pragma once

#include <memory>

#include "isowave/mesh.h"
#include "isowave/solid.h"
#include "lod/slabs/slabbed_field.h"
#include "volume/field.h"
#include "wavelets/pyramid.h"

namespace isowave {

namespace lod {

// With an open border: where the image ends, and meshes with it.
struct Border {
    openvdb::Mat4d worldToIndex;
    openvdb::Vec3d low, high;  // the first and the last voxel
};

}  // namespace lod

struct Solid::State {
    // One of the three.
    std::optional<BSplineField> field;
    std::shared_ptr<const lod::SlabbedField> slabs;
    std::optional<wavelets::Pyramid> pyramid;
    StepOrder order;  // of its steps, made or to be made
    Space space = Space::unspecified;
    std::optional<lod::Border> openBorder;
    InputReport input;
    // The mesh that was read, mended, where it bounds the solid: closed, no part in another.
    std::shared_ptr<const TriangleMesh> surface;
    std::optional<FitSummary> fit;
    std::vector<StageSeconds> stages;
    double seconds = 0;

    // Edges of a voxel of the field.
    std::array<double, 3> voxel() const {
        const openvdb::Vec3d size = (slabs ? slabs->transform() : field->transform()).voxelSize();
        return {size.x(), size.y(), size.z()};
    }
    // What messages call it.
    const std::string& name() const { return input.path; }
};

struct SolidAccess {
    static Solid make(Solid::State state) { return Solid(std::make_shared<Solid::State>(std::move(state))); }
    static const Solid::State& of(const Solid& solid) { return *solid.state_; }
    // The field, moved out where nobody else holds the solid. REQUIRES: it has one, or one in slabs.
    static BSplineField takeField(Solid solid) {
        if (solid.state_->slabs) return solid.state_->slabs->whole();
        return solid.state_.use_count() == 1 ? *std::exchange(solid.state_->field, {}) : *solid.state_->field;
    }
};

}  // namespace isowave
