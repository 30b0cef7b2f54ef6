// isowave analyse INPUT -o FILE.vdb: the whole pyramid, lossless.
#include <fmt/format.h>

#include "tools/commands.h"
#include "tools/input.h"
#include "tools/output.h"
#include "tools/steps.h"
#include "wavelets/pyramid_file.h"

namespace isowave::tools {

int runAnalyse(const Settings& settings, Console& console) {
    StageClock clock;
    if (settings.output->extension() != ".vdb")
        throw UsageError("-o: a pyramid is a .vdb file; name it for example part.pyramid.vdb");
    OutputFile out(*settings.output);
    Solid solid = loadSolid(settings.files[0], settings, console, clock);
    if (solid.pyramid) throw UsageError(settings.files[0].string() + " is a pyramid already");

    const auto source = solid.source();
    wavelets::Pyramid pyramid = [&] {
        const StageClock::Scope scope(clock, "analyse");
        return wavelets::analyse(*solid.field, {}, console.progress());
    }();
    solid.field.reset();
    pyramid.source = source;
    wavelets::writePyramid(*settings.output, pyramid);
    out.commit();

    const std::int64_t points = finestControlPoints(pyramid), stored = pyramid.coefficientsStored();
    console.print(fmt::format("{}: {} steps, {} coefficients stored for {} control points (x{:.3f})\n",
                              settings.output->string(), pyramid.stepCount(), grouped(stored),
                              grouped(points), static_cast<double>(stored) / static_cast<double>(points)));
    return 0;
}

}  // namespace isowave::tools
