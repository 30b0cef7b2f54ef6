// isowave analyse INPUT -o FILE.vdb: the whole pyramid, lossless; of several inputs, a file each.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/solids/dry_run_text.h"
#include "tools/solids/parts.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class Analyse : public Command {
  public:
    Analyse();
    bool needsOutput() const override { return !dryRun_; }
    bool hasOtherInputs() const override { return parts_.list.has_value(); }
    int run(Console& console) override;

  private:
    int runParts(Console& console) const;
    // Returns "12 steps, ...".
    std::string write(const Part& part, const Progress& progress) const;

    SolidOptions solid_;
    PartsChoice parts_;
    bool dryRun_ = false;
};

Analyse::Analyse()
    : Command({"analyse", "INPUT...", "a solid -> its pyramid, lossless, in one .vdb",
               "Takes what lod takes. Every step of the pyramid can be had back with mesh and field. Several "
               "inputs, -o out: out/NAME.pyramid.vdb each; one that fails does not stop the others."}) {
    declareOutput("the pyramid's file");
    parts_.declare(options_);
    options_.flag("--dry-run",
                  "make nothing; say voxels, memory, levels, and how many voxels thin the thinnest walls are",
                  dryRun_);
    solid_.fieldOnly = true;
    declareSolid(options_, solid_);
    declareThreads();
    declareMaxMemory(options_, solid_);
    declareSlabs(options_, solid_);
    declareTalk();
}

int Analyse::run(Console& console) {
    if (dryRun_) return tellDryRuns(parts_.inputs(arguments), solid_, console);
    if (parts_.asksForParts(arguments)) return runParts(console);
    if (output_->extension() != ".vdb")
        throw UsageError("-o: a pyramid is a .vdb file; name it for example part.pyramid.vdb");
    console.print(
        fmt::format("{}: {}\n", output_->string(), write({arguments[0], *output_}, console.progress())));
    return 0;
}

int Analyse::runParts(Console& console) const {
    PartsRun all(partsOf(parts_.inputs(arguments), *output_, ".pyramid.vdb"), console);
    const int code =
        all.run([this](const Part& part,
                       const Progress& progress) { return PartStory{.text = write(part, progress)}; },
                /*silent=*/false);
    if (code != kInterrupted) console.print(all.text());
    return code;
}

std::string Analyse::write(const Part& part, const Progress& progress) const {
    OutputFile out(part.output);
    const PyramidCounts counts =
        analyseTo(part.output, open(part.input, withSlabsBeside(solid_, part.output), progress), progress);
    out.commit();
    return fmt::format(
        "{} steps, {} coefficients stored for {} control points (x{:.3f})", counts.steps,
        grouped(counts.coefficientsStored), grouped(counts.controlPoints),
        static_cast<double>(counts.coefficientsStored) / static_cast<double>(counts.controlPoints));
}

}  // namespace

std::unique_ptr<Command> analyseCommand() { return std::make_unique<Analyse>(); }

}  // namespace isowave::tools
