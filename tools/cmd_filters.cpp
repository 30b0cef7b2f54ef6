// isowave filters SUBDIVISION: A, B, P and Q of a subdivision, in rationals, with proof.
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "subdivision/filters/diagram_print.h"
#include "subdivision/named_filters.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

Lattice latticeOf(const Settings& settings) {
    if (settings.lattice == "triangular") return Lattice::Triangular;
    return settings.lattice == "quad" ? Lattice::Quad : Lattice::Line;
}

std::string known() {
    std::string list;
    for (const auto& name : maskNames()) list += (list.empty() ? "" : ", ") + name;
    return list;
}

Filters wanted(const Settings& settings) {
    if (settings.files.empty() == !settings.mask)
        throw UsageError("filters: name a subdivision (" + known() +
                         ") or give your own with --mask, not both");
    if (!settings.mask && settings.lattice != "line")
        throw UsageError("--lattice: says where a --mask lives; " + settings.files[0].string() +
                         " has its own");
    if (!settings.mask) return namedFilters(settings.files[0].string(), settings.width);
    return maskFilters(customMask(latticeOf(settings), parseRationals(*settings.mask)), settings.width);
}

}  // namespace

int runFilters(const Settings& settings, Console& console) {
    if (settings.boundary) {
        if (settings.files.empty() || settings.json || settings.svg || settings.width)
            throw UsageError(
                "--boundary: takes the name of a scheme (cubic-7, dlg-refined, butterfly-3) and goes with no "
                "other option");
        console.print(boundaryPictures(settings.files[0].string()));
        return 0;
    }
    const Filters filters = wanted(settings);
    if (settings.svg) {
        OutputFile out(*settings.svg);
        AtomicFile file(*settings.svg);
        file.stream() << svg(filters);
        file.commit();
        out.commit();
    }
    console.print(settings.json ? json(filters) : picture(filters));
    return 0;
}

}  // namespace isowave::tools
