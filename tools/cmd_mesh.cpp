// isowave mesh INPUT --step S -o FILE: one step as a mesh.
#include <fmt/format.h>

#include "isowave/error.h"
#include "polygonize/zero_set.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/level_mesh.h"
#include "tools/output.h"
#include "tools/steps.h"

namespace isowave::tools {
namespace {

// A wrong extension is a wrong command line here, not bad data.
MeshFormat formatOf(const Settings& settings) {
    if (settings.format) return *settings.format;
    try {
        return meshFormatOf(*settings.output);
    } catch (const InputError& error) {
        throw UsageError(std::string("-o: ") + error.what());
    }
}

}  // namespace

int runMesh(const Settings& settings, Console& console) {
    StageClock clock;
    const MeshFormat format = formatOf(settings);
    const int step = wantedStep(settings);
    const std::string name = settings.files[0].string();
    OutputFile out(*settings.output);
    const int finestStep = LevelMesher::needsLevel0(settings) ? 0 : step;
    Solid solid = loadSolid(settings.files[0], settings, console, clock, finestStep);
    const Space space = outputSpace(solid, settings);
    LevelMesher mesher(settings, solid.openBorder, LevelMesher::Facts::few, console, clock);
    if (step != 0 && mesher.needsLevel0())
        mesher.make(0, solid.field ? *solid.field : solid.pyramid->field(0, console.progress()));
    const auto [field, mesh, topology, iso, refine, facts] =
        mesher.make(step, fieldAtStep(std::move(solid), step, name, console, clock));
    if (mesh.triangles.empty())
        throw InputError(name,
                         fmt::format("the whole solid has vanished at step {}; take a smaller one", step));
    writeMesh(*settings.output, mesh, format, {.space = space});
    out.commit();

    console.print(fmt::format("{}: step {}, {}, {}, genus {}, volume {}, {}{}{}\n", settings.output->string(),
                              step, counted(topology.triangles, "triangle"),
                              counted(topology.components, "component"), grouped(topology.genus),
                              shortNumber(topology.volume),
                              topology.closed() && topology.manifold() ? "closed" : "NOT closed",
                              iso == 0 ? "" : fmt::format(", iso {:+.3f} K", iso / field.K),
                              refine == settings.refine ? "" : fmt::format(", refine {}", refine)));
    if (settings.deviation) {
        const Deviation d = deviationFrom(ZeroSet(field, iso), mesh, console.progress());
        console.print(fmt::format("triangles are at most {} from the zero set, rms {}\n", shortNumber(d.max),
                                  shortNumber(d.rms)));
    }
    return 0;
}

}  // namespace isowave::tools
