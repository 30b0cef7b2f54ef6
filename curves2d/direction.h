// One direction of the planar transform: every row of a field, each of its intervals analysed on its own
// (wavelets/interval/interval.h), in parallel over rows. The 3D twin is wavelets/direction.h.
#pragma once

#include "curves2d/row_field.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// What a step took out of one row: where the finer control points were, and the details of its intervals, one
// behind the other.
template <class Real>
struct StepRow {
    std::int32_t row;
    std::vector<KnownRun> runs;
    std::vector<Real> details;
    friend bool operator==(const StepRow&, const StepRow&) = default;
};

template <class Real>
struct Step {
    int axis = 0;                     // the direction that was halved
    std::vector<StepRow<Real>> rows;  // ascending

    std::int64_t detailCount() const {
        std::int64_t count = 0;
        for (const auto& row : rows) count += static_cast<std::int64_t>(row.details.size());
        return count;
    }
};

template <class Real>
struct DirectionResult {
    RowField<Real> coarse;  // rows along the same axis; spacing doubled along it, origin unchanged
    Step<Real> step;
};

// Halves the direction that the rows run along.
// Throws InputError when a run is shorter than 4: known control points are a union of 4x4 blocks, and a step
// keeps them so.
template <class Real>
DirectionResult<Real> analyseDirection(const RowField<Real>& fine, const Progress& progress = {});

// The inverse. Throws InputError when the parts do not belong together.
template <class Real>
RowField<Real> synthesiseDirection(const RowField<Real>& coarse, const Step<Real>& step,
                                   const Progress& progress = {});

}  // namespace isowave::curves2d
