// isowave analyse INPUT -o FILE.vdb: the whole pyramid, lossless.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class Analyse : public Command {
  public:
    Analyse()
        : Command({"analyse", "INPUT", "a solid -> its pyramid, lossless, in one .vdb",
                   "Takes what lod takes. Every step of the pyramid can be had back with mesh and field."}) {
        declareOutput("the pyramid's file");
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareQuiet();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        if (output_->extension() != ".vdb")
            throw UsageError("-o: a pyramid is a .vdb file; name it for example part.pyramid.vdb");
        OutputFile out(*output_);
        const Pyramid pyramid = analyse(open(arguments[0], solid_, console.progress()), console.progress());
        pyramid.save(*output_);
        out.commit();

        const std::int64_t points = pyramid.controlPoints(), stored = pyramid.coefficientsStored();
        console.print(fmt::format("{}: {} steps, {} coefficients stored for {} control points (x{:.3f})\n",
                                  output_->string(), pyramid.stepCount(), grouped(stored), grouped(points),
                                  static_cast<double>(stored) / static_cast<double>(points)));
        return 0;
    }

  private:
    SolidOptions solid_;
};

}  // namespace

std::unique_ptr<Command> analyseCommand() { return std::make_unique<Analyse>(); }

}  // namespace isowave::tools
