// The pyramid: a field decomposed, step by step, down to one node. The field of every step can be restored.
//
// step s is the field after s directions have been halved; step 0 is the field itself. The order (isowave/solid.h: StepOrder)
// says which axis each step halves and which steps are levels: x, y, z in turn and level l at step 3 l, unless voxels are no cubes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "isowave/solid.h"
#include "wavelets/direction.h"

namespace isowave::wavelets {

// What turned the field of step s into that of step s + 1. shape and details are null where a reader left
// them out (pyramid_file.h).
struct Step {
    int axis = 0;      // the direction that was halved
    Shape::Ptr shape;  // of step s
    DetailGrid::Ptr details;
};

struct Pyramid {
    BSplineField coarsest;    // the field of step steps.size()
    std::vector<Step> steps;  // finest first
    double K = 1.0;
    StepOrder order = {};  // steps[s].axis is order.axisAfter(s); of files from elsewhere any
    // Of step 0, where synthesis misses them by rounding (wavelets/exact.h); null: nothing is known of that.
    openvdb::FloatGrid::Ptr exact = {};
    // Where the solid came from: "input.path", "input.kind", "fit", ... Written into the file; free text.
    std::map<std::string, std::string> source;

    int stepCount() const { return static_cast<int>(steps.size()); }
    // The field of a step, 0 <= step <= stepCount(). REQUIRES: shape and details of that step and all after
    // it.
    BSplineField field(int step, const Progress& progress = {}) const;
    // Details of all steps plus the control points of the coarsest field.
    std::int64_t coefficientsStored() const;
};

// How far a field has come down.
struct Halved {
    int step = 0;
    int unchanged =
        0;  // a bit for each axis whose halving changed neither domain nor size since something last changed
};

// Of a field: what tells whether a step changes anything. Domains end at 64 control points, or at a size that halving does not
// change.
struct FieldExtent {
    std::int64_t controlPoints = 0;
    openvdb::CoordBBox box;  // of control points

    // Of a part the extent of the whole is the sum of those of all parts.
    static FieldExtent of(const BSplineField& field);
    void add(const FieldExtent& part);
    friend bool operator==(const FieldExtent&, const FieldExtent&) = default;
};
// Whether there is another step; and where it leads: from an extent to the next along an axis.
bool goesOn(const Halved& halved, const FieldExtent& extent);
Halved halvedAlong(int axis, Halved halved, const FieldExtent& from, const FieldExtent& to);

struct AnalyseOptions {
    StepOrder order = {};
    Halved from = {};        // what the field is; steps are counted from there
    int maxSteps = 1 << 20;  // stop after so many steps, or when one node (4^3 control points) is left
};

// Takes the field apart. onStep(step, field) is called with every field on the way, step 0 first: levels can
// be polygonized without keeping them all.
Pyramid analyse(const BSplineField& field, const AnalyseOptions& options = {}, const Progress& progress = {},
                const std::function<void(int step, const BSplineField&)>& onStep = {});

// The same way down without a pyramid: details are counted and let go. Memory: two fields, that of a step and
// the next coarser one with its details; step 0 goes too, unless somebody else holds on to it.
struct Descent {
    BSplineField coarsest;
    int steps = 0;
    std::int64_t coefficientsStored = 0;  // by the pyramid that was not kept
};
Descent descend(BSplineField field, const AnalyseOptions& options = {}, const Progress& progress = {},
                const std::function<void(int step, const BSplineField&)>& onStep = {});

}  // namespace isowave::wavelets
