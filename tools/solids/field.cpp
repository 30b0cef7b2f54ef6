// isowave field INPUT --step S -o FILE.vdb: the control points of one step, for other tools.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/field.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class FieldCommand : public Command {
  public:
    FieldCommand()
        : Command(
              {"field", "INPUT",
               "any step of a pyramid (or of a solid) -> its B-spline field as .vdb for other tools",
               "The grid 'field' holds control points, negative inside; outside the band they are plus or "
               "minus K."}) {
        declareOutput("the field's file");
        step_.declare(options_);
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareTalk();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        if (output_->extension() != ".vdb") throw UsageError("-o: a field is a .vdb file; name it so");
        const int step = step_.wanted();
        OutputFile out(*output_);
        solid_.finestStep = step;
        const Field field = fieldOf(open(arguments[0], solid_, console.progress()), step, console.progress());
        field.save(*output_);
        out.commit();

        const auto spacing = field.spacing();
        console.print(fmt::format("{}: step {}, {} control points, voxel {:.4g} x {:.4g} x {:.4g}, K {:g}\n",
                                  output_->string(), step, grouped(field.controlPointCount()), spacing[0],
                                  spacing[1], spacing[2], field.K()));
        return 0;
    }

  private:
    StepChoice step_;
    SolidOptions solid_;
};

}  // namespace

std::unique_ptr<Command> fieldCommand() { return std::make_unique<FieldCommand>(); }

}  // namespace isowave::tools
