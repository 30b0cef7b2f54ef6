// isowave reverse MESH -o BASE: a mesh with subdivision connectivity, as a coarse base and details.
#include "base/atomic_file.h"
#include "isowave/error.h"
#include "subdivision/meshes/hierarchy_report.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {
namespace {

// The base and, when asked for, the details: both or none.
void write(const Settings& settings, const subdivision::Hierarchy& hierarchy) {
    using namespace subdivision;
    OutputFile baseFolders(*settings.output);
    std::optional<OutputFile> detailsFolders;
    if (settings.details) detailsFolders.emplace(*settings.details);
    AtomicFile base(*settings.output);
    std::optional<AtomicFile> details;
    if (settings.details) details.emplace(*settings.details);
    try {
        base.stream() << polygonMeshBytes(hierarchy.base, polygonFormatOf(*settings.output));
        if (details) writeHierarchy(details->stream(), hierarchy);
    } catch (const std::ios_base::failure&) {
        throw OperationError(settings.output->string(),
                             "writing failed; is the disk full? Nothing was left behind");
    }
    if (details) details->commit();
    base.commit();
    baseFolders.commit();
    if (detailsFolders) detailsFolders->commit();
}

}  // namespace

int runReverse(const Settings& settings, Console& console) {
    using namespace subdivision;
    const auto& input = settings.files[0];
    const MeshScheme& scheme = meshScheme(settings.scheme.value_or("catmull-clark"));
    DecomposeOptions options;
    options.variant = meshVariant(scheme, settings.variant.value_or(""));
    options.levels = settings.depth.value_or(kAllLevels);
    options.creaseAngle = settings.creaseAngle;
    if (settings.creaseAngle && scheme.name != "catmull-clark")
        throw UsageError("--crease: belongs to --scheme catmull-clark; " + std::string(scheme.name) +
                         " has no creases");
    polygonFormatOf(*settings.output);  // a wrong name is found before the work
    if (settings.details) {
        Inputs(settings.files).refuse(*settings.details);
        refuseSamePlace(*settings.output, *settings.details);
    }
    const Progress progress = console.progress();
    const PolygonMesh mesh = readPolygonMesh(input);
    const Hierarchy hierarchy = [&] {
        try {
            return decompose(mesh, scheme, options, progress);
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    const DecompositionReport report = reportDecomposition(hierarchy, mesh, progress);
    write(settings, hierarchy);
    if (report.roundTrip > kMeshRoundTrip * report.diagonal)
        console.say("the mesh comes back to " + std::to_string(report.roundTrip / report.diagonal) +
                    " of its diagonal only");
    if (!settings.details && hierarchy.steps() > 0)
        console.say("the details are not kept; --details FILE writes them");
    console.print(settings.json ? json(report) : text(report));
    return 0;
}

}  // namespace isowave::tools
