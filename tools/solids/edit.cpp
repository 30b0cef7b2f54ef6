// isowave edit PYRAMID --add BALL ... -o FILE: a part of a solid changed at a level, all else as it was.
#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/report/edit_report.h"
#include "tools/solids/edit_options.h"

namespace isowave::tools {
namespace {

constexpr int kExitDefective = 4;

class EditCommand : public Command {
  public:
    EditCommand();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void checkOutput() const;

    EditChoices choices_;
};

EditCommand::EditCommand()
    : Command({"edit", "PYRAMID", "add to a solid, cut off it or move a part of it, at a level -> a pyramid",
               "Edits are made in the order in which they stand on the line. TOOL is ball:X,Y,Z,R, a box "
               "(two opposite corners, "
               "X,Y,Z:X,Y,Z) or the file of a closed mesh, in world coordinates. Away from the tools level 0 "
               "stays what it was, to the bit. --with the old pyramid undoes all."}) {
    declareOutput("the pyramid's file, .vdb, or a packed one, .iwz");
    choices_.declare(options_);
    declareJson();
    declareThreads();
    declareTalk();
}

void EditCommand::checkOutput() const {
    if (output_->extension() != ".vdb" && output_->extension() != ".iwz")
        throw UsageError(
            "-o: a pyramid is a .vdb file, a packed one an .iwz; name it for example new.pyramid.vdb");
    std::vector<std::filesystem::path> files;
    for (const Edit& edit : choices_.edits) {
        const EditTool* tool = nullptr;
        if (const auto* add = std::get_if<EditAdd>(&edit)) tool = &add->tool;
        if (const auto* cut = std::get_if<EditCut>(&edit)) tool = &cut->tool;
        if (const auto* with = std::get_if<EditWith>(&edit))
            files.push_back(std::get<std::filesystem::path>(with->other));
        const auto* path = tool ? std::get_if<std::filesystem::path>(tool) : nullptr;
        if (path) files.push_back(*path);
    }
    const Inputs inputs(files);
    inputs.refuse(*output_);
    if (jsonToFile()) inputs.refuse(*json_);
}

int EditCommand::run(Console& console) {
    checkOutput();
    openJson();
    OutputFile out(*output_);
    EditTale tale{arguments[0].string(), output_->string(), {}, {}};
    Progress progress = console.progress();
    progress.remark = [&tale, say = progress.remark](std::string_view line) {
        tale.remarks.emplace_back(line);
        if (say) say(line);
    };
    EditedPyramid edited =
        edit(Pyramid::open(arguments[0], 0, progress), choices_.edits, choices_.how, progress);
    tale.report = std::move(edited.report);
    readyToTell(console, jsonOf(tale));
    edited.pyramid.save(*output_);
    out.commit();
    tell(console, textOf(tale), jsonOf(tale));
    return tale.report.closedSteps == tale.report.checkedSteps ? 0 : kExitDefective;
}

}  // namespace

std::unique_ptr<Command> editCommand() { return std::make_unique<EditCommand>(); }

}  // namespace isowave::tools
