// isowave curve-levels INPUT -o DIR: polylines at coarser levels, with the error of each.
#include "isowave/error.h"
#include "subdivision/curves/curve_report.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {

int runCurveLevels(const Settings& settings, Console& console) {
    using namespace subdivision;
    if (settings.mask && settings.scheme)
        throw UsageError("--mask: is a scheme of its own; leave --scheme out");
    if (settings.width && !settings.mask)
        throw UsageError("--width: belongs to --mask; write --scheme cubic-7 otherwise");
    if (settings.scheme) curveScheme(*settings.scheme);  // a wrong name is not the file's fault
    OutputFolder out(*settings.output, Inputs(settings.files));
    const auto& input = settings.files[0];
    const CurveFile file = CurveFile::read(input);
    CurveReportOptions options;
    options.scheme = settings.scheme.value_or(options.scheme);
    options.mask = settings.mask.value_or("");
    options.width = settings.width.value_or(0);
    options.levels = settings.depth.value_or(options.levels);
    options.resample = settings.points;
    options.threshold = settings.threshold;
    options.keep = settings.keep;
    options.compare = settings.table;
    const CurveReport report = [&] {
        try {
            return reportCurves(file, input.extension().string(), options);
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    writeFiles(out, report.files);
    out.commit();
    for (const auto& remark : report.remarks) console.say(remark);
    console.print(settings.json ? json(report) : text(report));
    return 0;
}

}  // namespace isowave::tools
