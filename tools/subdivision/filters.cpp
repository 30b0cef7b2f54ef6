// isowave filters SUBDIVISION: A, B, P and Q of a subdivision, in rationals, with proof.
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "subdivision/filter_catalogue.h"
#include "subdivision/filters/masks.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/filters.h"
#include "tools/report/filters_svg.h"
#include "tools/subdivision/filter_options.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

std::string known() {
    std::string list;
    for (const auto& name : maskNames()) list += (list.empty() ? "" : ", ") + name;
    return list;
}

class FiltersCommand : public Command {
  public:
    FiltersCommand();
    int run(Console& console) override;

  private:
    Filters wanted() const;
    void draw(const Filters& filters) const;

    std::optional<std::string> mask_;
    Lattice lattice_ = Lattice::Line;
    std::optional<int> width_;
    bool boundary_ = false;
    std::optional<std::filesystem::path> svg_;
};

FiltersCommand::FiltersCommand()
    : Command({"filters", "[SUBDIVISION]",
               "a subdivision -> its four filters A, B, P, Q, exactly, with proof",
               "SUBDIVISION is chaikin, cubic, dlg, dlg-refined, bspline-D, butterfly, loop, "
               "loop-like:ALPHA,GAMMA or "
               "catmull-clark; or give your own --mask. Prints the diagrams as rationals: rows on the line, "
               "pictures of "
               "the lattice else. AP = I, BP = 0, AQ = 0 and BQ = I are checked in rationals."}) {
    declareJson();
    declareMask(options_, mask_);
    options_.value(
        "--lattice", "line|triangular|quad", "line", "where the mask lives", [this](const std::string& v) {
            lattice_ = choice<Lattice>(
                v, {{"line", Lattice::Line}, {"triangular", Lattice::Triangular}, {"quad", Lattice::Quad}});
        });
    declareWidth(options_, width_);
    options_.flag("--boundary",
                  "the rows beside an end of a curve, or beside a side of a triangular patch; goes with no "
                  "other option",
                  boundary_);
    options_.result("--svg", "FILE", "draw the diagrams into this file", svg_);
    declareTalk();
}

Filters FiltersCommand::wanted() const {
    if (arguments.empty() == !mask_)
        throw UsageError("filters: name a subdivision (" + known() +
                         ") or give your own with --mask, not both");
    if (!mask_ && lattice_ != Lattice::Line)
        throw UsageError("--lattice: says where a --mask lives; " + arguments[0].string() + " has its own");
    if (!mask_) return asked("filters", [&] { return namedFilters(arguments[0].string(), width_); });
    return maskFilters(customMask(lattice_, parseRationals(*mask_)), width_);
}

void FiltersCommand::draw(const Filters& filters) const {
    OutputFile out(*svg_);
    AtomicFile file(*svg_);
    file.stream() << svg(filters);
    file.commit();
    out.commit();
}

int FiltersCommand::run(Console& console) {
    if (boundary_) {
        if (arguments.empty() || json_ || svg_ || width_)
            throw UsageError(
                "--boundary: takes the name of a scheme (cubic-7, dlg-refined, butterfly-3) and goes with no "
                "other option");
        console.print(textOf(boundaryFilters(arguments[0].string())));
        return 0;
    }
    const Filters filters = wanted();
    const Proof proof = prove(filters);
    readyToTell(console, jsonOf(filters, proof));
    if (svg_) draw(filters);
    tell(console, textOf(filters, proof), jsonOf(filters, proof));
    return 0;
}

}  // namespace

std::unique_ptr<Command> filtersCommand() { return std::make_unique<FiltersCommand>(); }

}  // namespace isowave::tools
