// isowave field INPUT --step S -o FILE.vdb: the control points of one step, for other tools.
#include <fmt/format.h>

#include "base/number_text.h"
#include "isowave/error.h"
#include "isowave/field.h"
#include "isowave/ladder.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
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
        options_.value("--hold", "local|none", "none",
                       "the wavelet field of the step; or with what keeps thin walls whole and handles from "
                       "becoming more put in, as `isowave mesh` has it",
                       [&](const std::string& v) {
                           hold_ = choice<Holding>(v, {{"local", Holding::local}, {"none", Holding::none}});
                       });
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareSlabs(options_, solid_);
        declareTalk();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        if (output_->extension() != ".vdb") throw UsageError("-o: a field is a .vdb file; name it so");
        step_.check();
        if (hold_ == Holding::none) {
            step_.limitReading(solid_);
            solid_.fieldOnly = true;
        }
        OutputFile out(*output_);
        Solid solid = open(arguments[0], withSlabsBeside(solid_, *output_), console.progress());
        const int step = step_.of(solid);
        const Field field = made(std::move(solid), step, console.progress());
        field.save(*output_);
        out.commit();

        const auto spacing = field.spacing();
        console.print(fmt::format("{}: step {}, {} control points, voxel {:.4g} x {:.4g} x {:.4g}, K {:g}\n",
                                  output_->string(), step, grouped(field.controlPointCount()), spacing[0],
                                  spacing[1], spacing[2], field.K()));
        return 0;
    }

  private:
    Field made(Solid solid, int step, const Progress& progress) const {
        if (hold_ == Holding::local) return makeLevelField(std::move(solid), step, {}, progress);
        return fieldOf(std::move(solid), step, progress);
    }

    StepChoice step_;
    Holding hold_ = Holding::none;
    SolidOptions solid_;
};

}  // namespace

std::unique_ptr<Command> fieldCommand() { return std::make_unique<FieldCommand>(); }

}  // namespace isowave::tools
