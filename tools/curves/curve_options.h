// Options of `curves` that say what the curves are, not where they go.
#pragma once

#include <filesystem>
#include <optional>

#include "isowave/curves.h"
#include "isowave/ladder.h"
#include "tools/command.h"

namespace isowave::tools {

inline constexpr int kStepsPerPlaneLevel = 2;

struct CurveOptions {
    std::optional<StepRange> levels;
    curves2d::Hold hold = curves2d::Hold::local;
    curves2d::DrawOptions draw;
    std::optional<double> iso;
    std::optional<std::int32_t> pixels;
    bool invert = false;
    std::optional<curves2d::Fit> fit;
    std::optional<double> halfWidth, band;

    void declareLevels(OptionList& options);   // --levels, --hold
    void declareDrawing(OptionList& options);  // --smooth, --flatness
    void declareInput(OptionList& options);    // --iso, --pixels, --invert
    void declareFit(OptionList& options);      // --fit, --half-width, --band

    curves2d::InputOptions input() const;
    // Throws UsageError: --band is wider than --half-width.
    curves2d::LadderOptions ladder() const;
    // What the input has no use for is refused, as lod does. name: of the input. Throws UsageError.
    void refuseForeign(const std::string& name, bool polygons) const;
};

// REQUIRES: the ladder was made with options.ladder(). Throws InputError where it ends before the first level asked for.
void requireFirstLevel(const CurveOptions& options, const curves2d::Ladder& ladder, const std::string& name);

}  // namespace isowave::tools
