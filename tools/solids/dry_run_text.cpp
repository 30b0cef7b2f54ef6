#include "tools/solids/dry_run_text.h"

#include <fmt/format.h>

#include "base/number_text.h"
#include "lod/fit_solid.h"
#include "lod/source.h"
#include "tools/solids/parts.h"

namespace isowave::tools {
namespace {

std::string memoryText(const lod::DryRun& run) {
    const std::string needed = bytesText(run.memoryBytes), limit = bytesText(run.memoryLimit);
    const char* what = run.fieldOnly ? "for the pyramid" : "for the fit";
    if (run.memoryBytes > run.memoryLimit)
        return fmt::format("about {} {}, more than the limit of {}: it would be refused", needed, what,
                           limit);
    return fmt::format("about {} {} (limit {}){}", needed, what, limit,
                       run.fieldOnly ? "" : "; levels take up to about twice that");
}

std::string wallText(const lod::DryRun& run) {
    if (run.kind == InputReport::Kind::levelSet) return "not looked for in a level set";
    if (run.walls.empty()) return "nothing lies opposite anything";
    std::string shares, voxels, held;
    for (const lod::DryRun::Wall& wall : run.walls) {
        const char* comma = shares.empty() ? "" : ", ";
        shares += fmt::format("{}{:g}", comma, 100 * wall.share);
        voxels += fmt::format("{}{:.3g}", comma, wall.voxels);
        held += comma + (wall.heldUpTo ? std::to_string(*wall.heldUpTo) : std::string("none"));
    }
    return fmt::format(
        "the thinnest {} % are {}{} voxels thick; kept as they are up to level {}, then thickened", shares,
        run.wallsAreBounds ? "at most " : "", voxels, held);
}

}  // namespace

std::string textOf(const lod::DryRun& run, const std::string& name) {
    return fmt::format(
        "{}: {}, {} x {} x {} voxels of {:.4g} x {:.4g} x {:.4g}, {} fit\n"
        "  memory  {}\n"
        "  levels  0 to at most {}, fewer where the solid vanishes before\n"
        "  walls   {}\n",
        name, lod::nameOf(run.kind), run.voxels[0], run.voxels[1], run.voxels[2], run.spacing[0],
        run.spacing[1], run.spacing[2], lod::nameOf(run.fit), memoryText(run), run.lastLevel, wallText(run));
}

int tellDryRuns(const std::vector<std::filesystem::path>& inputs, const SolidOptions& options,
                Console& console) {
    const auto tell = [&](const std::filesystem::path& input, const Progress& progress) {
        const lod::DryRun run = lod::dryRun(input, options, progress);
        console.print(textOf(run, input.string()));
    };
    if (inputs.size() == 1) {
        tell(inputs[0], console.progress());
        return 0;
    }
    std::vector<Part> parts;
    for (const auto& input : inputs) parts.push_back({input, {}});
    PartsRun all(std::move(parts), console);
    return all.run(
        [&](const Part& part, const Progress& progress) {
            tell(part.input, progress);
            return PartStory{};
        },
        /*silent=*/true);
}

}  // namespace isowave::tools
