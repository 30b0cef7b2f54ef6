// A plain wavelet level -> the level that is written: thin parts held, parts and holes no more than the level before had.
#pragma once

#include <vector>

#include "curves2d/hold/outline.h"
#include "curves2d/hold/thin.h"
#include "curves2d/row_field.h"
#include "isowave/curves.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

struct HeldLevel {
    RowField<float> field;  // the plain one, to the bit, where there was nothing to do
    Curves traced;          // a point wherever a curve crosses the field's lattice
    Curves
        curves;  // the same with fewer points where the field is the plain one: as sampled at the level's pixels
    HoldFacts facts;
};

// Takes the levels of one input one after the other, from level 1 on.
class LevelHolder {
  public:
    // Level 0, which is what the others are held to.
    LevelHolder(const RowField<float>& field, const Curves& curves);

    // REQUIRES: `plain` is the level that follows the one before; square pixels.
    HeldLevel hold(const RowField<float>& plain, const Progress& progress = {});

  private:
    Outline outline_;
    std::vector<ThinSample> samples_;
    Curves before_;  // of the level before, as written
    double beforeSpacing_ = 1;
    double pixel_;  // of level 0, in the input's unit
};

}  // namespace isowave::curves2d
