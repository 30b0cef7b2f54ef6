// isowave edit PYRAMID --add BALL ... -o FILE: a part of a solid changed at a level, all else as it was.
#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/edit_report.h"

namespace isowave::tools {
namespace {

constexpr int kExitDefective = 4;

class EditCommand : public Command {
  public:
    EditCommand();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void declareEdits();
    void moveLast(const std::string& by);
    void checkOutput() const;

    std::vector<Edit> edits_;
    EditingOptions how_;
};

EditCommand::EditCommand()
    : Command({"edit", "PYRAMID", "add to a solid, cut off it or move a part of it, at a level -> a pyramid",
               "Edits are made in the order in which they stand on the line. TOOL is ball:X,Y,Z,R, a box "
               "(two opposite corners, "
               "X,Y,Z:X,Y,Z) or the file of a closed mesh, in world coordinates. Away from the tools level 0 "
               "stays what it was, to the bit. --with the old pyramid undoes all."}) {
    declareOutput("the pyramid's file, .vdb, or a packed one, .iwz");
    declareEdits();
    options_.value(
        "--level", "L", "0",
        "tools are sampled on this level's lattice: their edges are as round as its surfaces are",
        [this](const std::string& v) { how_.level = static_cast<int>(integer(v, 0, kMostSteps)); });
    options_.value("--blend", "R", "sharp",
                   "where a tool of --add or --cut meets the surface the edge becomes a fillet of radius R "
                   "(world units)",
                   [this](const std::string& v) { how_.blend = positive(v); });
    options_.flag("--check", "make every step's mesh; exit code 4 where one is not closed and 2-manifold",
                  how_.checkSteps);
    declareJson();
    declareThreads();
    declareTalk();
}

void EditCommand::declareEdits() {
    options_.values("--add", "TOOL", "the solid and the tool together",
                    [this](const std::string& v) { edits_.push_back(EditAdd{editTool(v)}); });
    options_.values("--cut", "TOOL", "the solid without the tool",
                    [this](const std::string& v) { edits_.push_back(EditCut{editTool(v)}); });
    options_.values("--move", "BOX",
                    "what of the solid lies in the box is moved, with its details; by how much says --by",
                    [this](const std::string& v) { edits_.push_back(EditMove{box(v)}); });
    options_.values("--by", "X,Y,Z", "by how much the --move before it moves (world units)",
                    [this](const std::string& v) { moveLast(v); });
    options_.values(
        "--with", "FILE",
        "the level's control points as in FILE, a .vdb of isowave field that was changed; or, of a "
        "pyramid, its level 0, which undoes edits",
        [this](const std::string& v) { edits_.push_back(EditWith{place(v)}); });
}

void EditCommand::moveLast(const std::string& by) {
    auto* move = edits_.empty() ? nullptr : std::get_if<EditMove>(&edits_.back());
    if (!move) throw UsageError("stands behind a --move");
    move->by = point(by);
}

void EditCommand::checkOutput() const {
    if (output_->extension() != ".vdb" && output_->extension() != ".iwz")
        throw UsageError(
            "-o: a pyramid is a .vdb file, a packed one an .iwz; name it for example new.pyramid.vdb");
    std::vector<std::filesystem::path> files;
    for (const Edit& edit : edits_) {
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
    EditedPyramid edited = edit(Pyramid::open(arguments[0], 0, progress), edits_, how_, progress);
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
