// isowave pack INPUT -o FILE.iwz: level 0 in as few bytes as possible.
#include "isowave/pyramid.h"

#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/pack_report.h"
#include "tools/solids/solid_options.h"

namespace isowave::tools {
namespace {

class Pack : public Command {
  public:
    Pack()
        : Command({"pack", "INPUT", "a solid or a pyramid -> a small file, .iwz, lossless or within a bound",
                   "Keeps the control points of level 0, from which every step is computed again. Every "
                   "command that takes a "
                   "pyramid takes a packed one. With --bound all lattice signs and the triangles of level 0 "
                   "stay the same."}) {
        declareOutput("the packed file, .iwz");
        options_.value("--bound", "LEN", "lossless",
                       "how far the field may move at the surface, as a distance: 0.1voxel or 0.05mm (mm: "
                       "the unit of the "
                       "coordinates, whatever it is)",
                       [this](const std::string& v) { how_.bound = length(v); });
        options_.value(
            "--max-distance", "LEN", "no limit",
            "how far vertices of level 0's mesh may move; the bound is made smaller until they do not",
            [this](const std::string& v) { how_.maxDistance = length(v); });
        declareJson();
        declareSolid(options_, solid_);
        declareThreads();
        declareMaxMemory(options_, solid_);
        declareSlabs(options_, solid_);
        declareTalk();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        if (output_->extension() != ".iwz")
            throw UsageError("-o: a packed solid is an .iwz file; name it for example part.iwz");
        openJson();
        OutputFile out(*output_);
        PackStory story{arguments[0].string(), output_->string(), how_, {}};
        story.report = pack(open(arguments[0], withSlabsBeside(solid_, *output_), console.progress()),
                            *output_, how_, console.progress());
        out.commit();
        tell(console, textOf(story), jsonOf(story));
        return 0;
    }

  private:
    SolidOptions solid_;
    PackOptions how_;
};

}  // namespace

std::unique_ptr<Command> packCommand() { return std::make_unique<Pack>(); }

}  // namespace isowave::tools
