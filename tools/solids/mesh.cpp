// isowave mesh INPUT --step S -o FILE: one step as a mesh.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class MeshCommand : public Command {
  public:
    MeshCommand()
        : Command({"mesh", "INPUT", "any step of a pyramid (or of a solid) -> a mesh file",
                   "The format follows from the name of the output, or from --format."}) {
        declareOutput("the mesh's file");
        step_.declare(options_);
        declareFormat(options_, format_);
        space_.declare(options_);
        declareMesh(options_, level_, /*features=*/false);
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareQuiet();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        const MeshFormat format = formatWanted();
        const int step = step_.wanted();
        OutputFile out(*output_);
        if (!needsLevel0(level_)) solid_.finestStep = step;
        Solid solid = open(arguments[0], solid_, console.progress());
        const Space space = space_.of(solid);
        const double metresPerUnit = metresPerUnitOf(solid);
        const Level level = makeLevel(std::move(solid), step, level_, console.progress());
        writeMesh(*output_, level.mesh, format, {space, metresPerUnit});
        out.commit();
        console.print(textOf(level.report));
        return 0;
    }

  private:
    // --format, or what the name says; the two may not say different things. A name may say nothing: part.tmp.
    MeshFormat formatWanted() const {
        if (!format_) return formatOfOutput();
        std::optional<MeshFormat> named;
        try {
            named = meshFormatOf(*output_);
        } catch (const InputError&) {
            return *format_;
        }
        if (*named != *format_)
            throw UsageError(fmt::format(
                "-o {} and --format {} contradict each other; leave out --format or name the file {}",
                output_->string(), extensionOf(*format_) + 1, extensionOf(*format_)));
        return *format_;
    }
    // A wrong extension is a wrong command line here, not bad data.
    MeshFormat formatOfOutput() const {
        try {
            return meshFormatOf(*output_);
        } catch (const InputError& error) {
            throw UsageError(std::string("-o: ") + error.what());
        }
    }

    std::string textOf(const LevelReport& level) const {
        const MeshTopology& topology = level.topology;
        std::string text = fmt::format(
            "{}: step {}, {}, {}, genus {}, volume {}, {}{}{}\n", output_->string(), level.step,
            counted(topology.triangles, "triangle"), counted(topology.components, "component"),
            grouped(topology.genus), shortNumber(topology.volume),
            topology.closed() && topology.manifold() ? "closed" : "NOT closed",
            level.isoShift == 0 ? "" : fmt::format(", iso {:+.3f} K", level.isoShift),
            level.refine == level_.refine.value_or(1) ? "" : fmt::format(", refine {}", level.refine));
        if (level_.deviation)
            text += fmt::format("triangles are at most {} from the zero set, rms {}\n",
                                shortNumber(*level.maxDeviation), shortNumber(*level.rmsDeviation));
        return text;
    }

    StepChoice step_;
    std::optional<MeshFormat> format_;
    SpaceChoice space_;
    LevelOptions level_;
    SolidOptions solid_;
};

}  // namespace

std::unique_ptr<Command> meshCommand() { return std::make_unique<MeshCommand>(); }

}  // namespace isowave::tools
