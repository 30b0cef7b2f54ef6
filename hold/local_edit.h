// A change of a field near a few lattice points that makes them inside or outside and keeps the signs of all others as far as it can: tried
// on a copy of the control points around, so that its effect on mesh and volume is known before the field is touched.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "hold/lattice_patch.h"
#include "volume/field.h"
#include "volume/row_ascent.h"

namespace isowave {

struct EditPlan {
    bool fill = true;                    // the points become inside; else outside
    std::vector<openvdb::Coord> points;  // lattice points of the mesh: index space times refine
    std::vector<openvdb::Vec3d> places;  // and places between them, index space: where faces are decided
    bool whole = false;  // the points are all of a part or cavity: their control points start beyond 0
};

// How a plan is carried out.
struct EditManner {
    double margin =
        0.25;  // how far |F| is beyond 0 there, in mean differences of F over crossed lattice edges
    // Lattice points nearer than a control point to the plan's may change with them: a plug or a cut may become thicker, which a
    // lattice finer than the control points often needs. Of all others the signs should be kept.
    bool thicker = false;
};

struct LocalEdit {
    openvdb::CoordBBox box;  // of the control points that may change, index space
    std::vector<std::pair<openvdb::Coord, float>> controlPoints;  // new values, where they differ
    double moved =
        0;  // world units^3 that go to the other side, by lattice points: gains and losses do not cancel
};

// One plan on its surroundings, tried in several manners.
class EditTrial {
  public:
    // The plan outlives this. The field is read here only.
    EditTrial(const BSplineField& field, int refine, const EditPlan& plan);

    // The least change (volume/row_ascent.h) of the control points within reach of the plan's points; nothing where no change is needed, or
    // where the Euler number of the mesh of polygonize(field, refine) does not change by `euler`; where that is positive, less that of
    // the specks and bubbles around. The Euler number is exact: the surroundings before and after are cut out in the same way.
    std::optional<LocalEdit> attempt(const EditManner& manner, std::optional<int> euler = {});

    // World units^3 that the whole mesh gains by an edit that was made for this plan and field. It takes several times as long as
    // an attempt: for edits that are made.
    double volumeGained(const LocalEdit& edit) const;

  private:
    void collectPlaces();
    void cutOut(const BSplineField& field);
    LatticePatch patch() const;
    openvdb::CoordBBox rowBox() const;
    double meanStep() const;

    void foresee();
    std::size_t markIndex(const openvdb::Coord& c) const;
    bool mustKeep(const openvdb::Coord& c, bool thicker) const;

    void startBeyond(double margin);
    bool solve(const EditManner& manner, double far);
    bool keepsFar(const EditManner& manner, double far) const;
    bool changesEulerBy(int euler) const;
    double moved() const;
    std::vector<FieldRow> rows(const EditManner& manner, double far) const;
    FieldRow keptSign(const openvdb::Vec3d& at, double f) const;
    void addCell(const openvdb::Coord& low, bool thicker, std::vector<FieldRow>& rows) const;
    void addKept(const openvdb::Vec3d& latticePlace, std::vector<FieldRow>& rows) const;

    int refine_;
    const EditPlan& plan_;
    std::vector<openvdb::Vec3d> places_;
    openvdb::CoordBBox box_;
    BSplineField local_;
    openvdb::FloatGrid::Ptr before_;
    LatticePatch patchBefore_, patchAfter_;
    openvdb::CoordBBox planned_;       // of marks_
    std::vector<std::uint8_t> marks_;  // signs to come, and which of them are the plan's
    double step_ = 0, tolerance_ = 0;
};

// Puts an edit in. Control points outside I that it moves become known, four on each axis at a time, in both
// grids; the shape takes F's sign at the lattice points within reach.
void apply(const LocalEdit& edit, BSplineField& field);

}  // namespace isowave
