// isowave field INPUT --step S -o FILE.vdb: the control points of one step, for other tools.
#include <fmt/format.h>

#include "tools/commands.h"
#include "tools/input.h"
#include "tools/output.h"
#include "tools/steps.h"
#include "volume/vdb_file.h"

namespace isowave::tools {

int runField(const Settings& settings, Console& console) {
    StageClock clock;
    if (settings.output->extension() != ".vdb") throw UsageError("-o: a field is a .vdb file; name it so");
    const int step = wantedStep(settings);
    OutputFile out(*settings.output);
    Solid solid = loadSolid(settings.files[0], settings, console, clock, step);
    const BSplineField field =
        fieldAtStep(std::move(solid), step, settings.files[0].string(), console, clock);
    writeField(*settings.output, field);
    out.commit();

    const auto spacing = field.transform().voxelSize();
    console.print(fmt::format("{}: step {}, {} control points, voxel {:.4g} x {:.4g} x {:.4g}, K {:g}\n",
                              settings.output->string(), step, grouped(field.controlPointCount()),
                              spacing.x(), spacing.y(), spacing.z(), field.K));
    return 0;
}

}  // namespace isowave::tools
