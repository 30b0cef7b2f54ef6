#include "tools/solids/mesh_colours.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/mesh/distance/recolour_glb.h"
#include "isowave/error.h"
#include "tools/option_values.h"

namespace isowave::tools {

void ColourChoice::declare(OptionList& options) {
    options.value(
        "--colour", "none|distance", "none",
        "each vertex's distance to level 0 in PLY, GLB and VTP (distance_to_level0), in GLB as a colour "
        "too",
        [this](const std::string& v) {
            distance = choice<bool>(v, {{"none", false}, {"distance", true}});
        });
}

void ColourChoice::requireFormat(MeshFormat format) const {
    if (!distance || format == MeshFormat::ply || format == MeshFormat::glb || format == MeshFormat::vtp)
        return;
    throw UsageError(
        fmt::format("--colour distance needs a format with numbers at vertices, which {} has not; give "
                    "--format ply, glb or vtp",
                    extensionOf(format) + 1));
}

void ColourChoice::requireLevel0(const LevelOptions& levels, const BudgetOptions& budgets) const {
    if (!distance) return;
    const std::optional<StepRange>& range = levels.steps ? levels.steps : levels.levels;
    if (range ? range->first == 0 : !budgets.any()) return;
    throw UsageError(
        fmt::format("--colour distance is measured to level 0, which is not made here; {}",
                    range ? "let the levels begin with 0" : "with a budget give --levels 0..0 too"));
}

void MeshColours::setLevel0(const TriangleMesh& mesh) {
    if (choice_.distance) level0_ = std::make_unique<view::SurfaceDistance>(mesh);
}

MeshWriteOptions MeshColours::with(MeshWriteOptions plain, const TriangleMesh& mesh, bool isLevel0,
                                   const Progress& progress) {
    if (!choice_.distance) return plain;
    plain.distanceToLevel0 =
        isLevel0 ? std::vector<float>(mesh.points.size(), 0.0F) : level0_->ofVertices(mesh, progress);
    for (const float d : plain.distanceToLevel0) largest_ = std::max(largest_, d);
    return plain;
}

std::optional<double> MeshColours::range() const {
    return choice_.distance ? std::optional<double>(largest_) : std::nullopt;
}

void MeshColours::recolour(const std::filesystem::path& file, MeshFormat format) const {
    if (choice_.distance && format == MeshFormat::glb) recolourGlb(file, largest_);
}

}  // namespace isowave::tools
