// Options of `curves` that say what the curves are, not where they go.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "isowave/curves.h"
#include "isowave/ladder.h"
#include "tools/command.h"

namespace isowave::tools {

inline constexpr int kStepsPerPlaneLevel = 2;

// What curves are made of, by the file's name.
enum class CurveInput { image, polygons, pyramid };
CurveInput curveInputOf(const std::filesystem::path& path);

struct CurveOptions {
    std::optional<StepRange> levels, steps;  // one of the two; neither: all levels
    curves2d::Hold hold = curves2d::Hold::local;
    curves2d::DrawOptions draw;
    std::optional<double> iso;
    std::optional<std::int32_t> pixels;
    bool invert = false;
    std::optional<curves2d::Fit> fit;
    std::optional<double> halfWidth, band;
    std::optional<std::filesystem::path> pyramid;
    struct Edit {
        bool cut;
        std::filesystem::path file;
    };
    std::vector<Edit> edits;  // in their order
    std::optional<int> editLevel;

    void declareLevels(OptionList& options);   // --levels, --steps, --hold
    void declareDrawing(OptionList& options);  // --smooth, --flatness
    void declareInput(OptionList& options);    // --iso, --pixels, --invert
    void declareFit(OptionList& options);      // --fit, --half-width, --band
    void declareEdits(OptionList& options);    // --add, --cut, --edit-level
    void declarePyramid(OptionList& options);  // --pyramid

    curves2d::InputOptions input() const;
    // Throws UsageError: --band is wider than --half-width, --levels beside --steps, --edit-level without an edit, --pyramid has
    // another name than .iwc.
    curves2d::LadderOptions ladder() const;
    // Whether a step that the ladder visits is a result: those between levels are with --steps alone.
    bool isWanted(const curves2d::LadderStep& step) const { return steps || step.level(); }
    // What the input has no use for is refused, as lod does. name: of the input. Throws UsageError.
    void refuseForeign(const std::string& name, CurveInput kind) const;
    // The input itself and the tools.
    std::vector<std::filesystem::path> inputs(const std::filesystem::path& input) const;
    // The input, fitted where it is edited or its pyramid is wanted, with all edits made. Throws InputError: a tool that is no
    // polygons, that changes nothing or that leaves nothing.
    curves2d::Input prepared(curves2d::Input input, const Progress& progress) const;
    // What a reader should know of the steps that were asked for.
    std::vector<std::string> remarks() const;
};

// REQUIRES: the ladder was made with options.ladder(). Throws InputError where it ends before the first level or step asked for.
void requireFirstLevel(const CurveOptions& options, const curves2d::Ladder& ladder, const std::string& name);

}  // namespace isowave::tools
