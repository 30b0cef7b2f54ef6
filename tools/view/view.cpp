// isowave view INPUT... -o FILE.html: levels as one page to look at.
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/number_text.h"
#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/view/pages.h"

namespace isowave::tools {
namespace {

class View : public Command {
  public:
    View()
        : Command(
              {"view", "INPUT...", "levels -> one html file to look at, which needs no network",
               "INPUT is a folder of lod or curves, a pyramid (analyse, pack), the details of reverse, or "
               "one or "
               "several meshes or curves. The page has a slider over the levels, two of them side by side or "
               "overlaid, colours by distance to the first level, a cut plane, a table and plots. It opens "
               "from the disk in any browser of 2023 or later that has WebGL. "
               "Coordinates in it are rounded to 1/65535 of the longest side."}) {
        declareOutput("the page, a .html file");
        declareThreads();
        declareTalk();
    }
    bool needsOutput() const override { return true; }

    int run(Console& console) override {
        if (output_->extension() != ".html" && output_->extension() != ".htm")
            throw UsageError("-o: a page is an .html file; name it for example part.html");
        view::requirePages();
        OutputFile out(*output_);
        Inputs(arguments).refuse(*output_);
        AtomicFile file(*output_);
        const auto page = pageOf(arguments, console);
        const std::string html = page->html();
        writeWhole(file, html);
        console.progress().check();
        file.commit();
        out.commit();
        console.print(fmt::format("{}: {}, {}; open it in a browser\n", output_->string(),
                                  counted(static_cast<std::int64_t>(page->levelCount()), "level"),
                                  bytesText(static_cast<double>(html.size()))));
        return 0;
    }
};

}  // namespace

std::unique_ptr<Command> viewCommand() { return std::make_unique<View>(); }

}  // namespace isowave::tools
