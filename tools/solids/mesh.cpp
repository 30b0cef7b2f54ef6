// isowave mesh INPUT --step S -o FILE: one step as a mesh; of several inputs, a file each.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/solids/parts.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class MeshCommand : public Command {
  public:
    MeshCommand()
        : Command(
              {"mesh", "INPUT...", "any step of a pyramid (or of a solid) -> a mesh file",
               "The format follows from the name of the output, or from --format. Several inputs, -o out: "
               "out/NAME.ply each; one that fails does not stop the others."}) {
        declareOutput("the mesh's file");
        parts_.declare(options_);
        step_.declare(options_);
        declareFormat(options_, format_);
        space_.declare(options_);
        declareMesh(options_, level_, /*features=*/false);
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareSlabs(options_, solid_);
        declareTalk();
    }
    bool needsOutput() const override { return true; }

    bool hasOtherInputs() const override { return parts_.list.has_value(); }

    int run(Console& console) override {
        step_.check();
        if (!needsLevel0(level_)) step_.limitReading(solid_);
        if (parts_.asksForParts(arguments)) return runParts(console);
        const Part all{arguments[0], *output_};
        console.print(
            fmt::format("{}: {}\n", output_->string(), write(all, formatWanted(), console.progress())));
        return 0;
    }

  private:
    int runParts(Console& console) const {
        const MeshFormat format = format_.value_or(MeshFormat::ply);
        PartsRun all(partsOf(parts_.inputs(arguments), *output_, extensionOf(format)), console);
        const int code = all.run(
            [&](const Part& part, const Progress& progress) {
                return PartStory{.text = write(part, format, progress)};
            },
            /*silent=*/false);
        if (code != kInterrupted) console.print(all.text());
        return code;
    }
    // Returns what there is to tell of the mesh.
    std::string write(const Part& part, MeshFormat format, const Progress& progress) const {
        OutputFile out(part.output);
        Solid solid = open(part.input, withSlabsBeside(solid_, part.output), progress);
        const Space space = space_.of(solid);
        const double metresPerUnit = metresPerUnitOf(solid);
        const int step = step_.of(solid);
        const Level level = makeLevel(std::move(solid), step, level_, progress);
        writeMesh(part.output, level.mesh, format, {space, metresPerUnit});
        out.commit();
        return textOf(level.report);
    }
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
            "step {}, {}, {}, genus {}, volume {}, {}{}{}", level.step,
            counted(topology.triangles, "triangle"), counted(topology.components, "component"),
            grouped(topology.genus), shortNumber(topology.volume),
            topology.closed() && topology.manifold() ? "closed" : "NOT closed",
            level.isoShift == 0 ? "" : fmt::format(", iso {:+.3f} K", level.isoShift),
            level.refine == level_.refine.value_or(1) ? "" : fmt::format(", refine {}", level.refine));
        if (level_.deviation)
            text += fmt::format("\ntriangles are at most {} from the zero set, rms {}",
                                shortNumber(*level.maxDeviation), shortNumber(*level.rmsDeviation));
        return text;
    }

    StepChoice step_;
    PartsChoice parts_;
    std::optional<MeshFormat> format_;
    SpaceChoice space_;
    LevelOptions level_;
    SolidOptions solid_;
};

}  // namespace

std::unique_ptr<Command> meshCommand() { return std::make_unique<MeshCommand>(); }

}  // namespace isowave::tools
