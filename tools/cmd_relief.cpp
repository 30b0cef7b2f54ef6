// isowave relief INPUT -o DIR: a height field at coarser levels of a triangular subdivision.
#include "isowave/error.h"
#include "subdivision/lattice/picture_files.h"
#include "subdivision/lattice/relief_report.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {

int runRelief(const Settings& settings, Console& console) {
    using namespace subdivision;
    if (settings.scheme) surfaceScheme(*settings.scheme);  // a wrong name is not the file's fault
    OutputFolder out(*settings.output, Inputs(settings.files));
    const auto& input = settings.files[0];
    const Grid grid = readPictureOrGrid(input);
    ReliefReportOptions options;
    options.scheme = settings.scheme.value_or(options.scheme);
    options.levels = settings.depth.value_or(options.levels);
    options.layout = settings.quincunx ? ReliefLayout::Quincunx : ReliefLayout::Rows;
    options.compare = settings.table;
    const ReliefReport report = [&] {
        try {
            return reportRelief(grid, options);
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    writeFiles(out, report.files);
    out.commit();
    console.print(settings.json ? json(report) : text(report));
    return 0;
}

}  // namespace isowave::tools
