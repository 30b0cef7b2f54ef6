// A scheme's filters for open and for closed curves, made when the first such curve comes.
#pragma once

#include <optional>
#include <utility>

#include "subdivision/curves/curve_schemes.h"

namespace isowave::subdivision {

class FiltersOnDemand {
  public:
    explicit FiltersOnDemand(CurveScheme scheme) : scheme_(std::move(scheme)) {}
    const CurveFilters& operator()(bool closed) {
        auto& filters = closed ? closed_ : open_;
        if (!filters) filters.emplace(scheme_, closed);
        return *filters;
    }

  private:
    CurveScheme scheme_;
    std::optional<CurveFilters> open_, closed_;
};

}  // namespace isowave::subdivision
