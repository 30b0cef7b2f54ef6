#include "tools/solids/edit_options.h"

#include "isowave/error.h"
#include "tools/option_values.h"

namespace isowave::tools {

void EditChoices::declare(OptionList& options) {
    declareEdits(options);
    options.value("--level", "L", "0",
                  "tools are sampled on this level's lattice: their edges are as round as its surfaces are",
                  [this](const std::string& v) { how.level = static_cast<int>(integer(v, 0, kMostSteps)); });
    options.value("--blend", "R", "sharp",
                  "where a tool of --add or --cut meets the surface the edge becomes a fillet of radius R "
                  "(world units)",
                  [this](const std::string& v) { how.blend = lengthIn(v, kWorldUnits); });
    options.value("--max-memory", "GB", "70 % of this computer's",
                  "refuse tools that would take more, as far as can be told beforehand",
                  [this](const std::string& v) { how.maxMemory = positive(v) * kBytesPerGigabyte; });
    options.flag("--check", "make every step's mesh; exit code 4 where one is not closed and 2-manifold",
                 how.checkSteps);
}

void EditChoices::declareEdits(OptionList& options) {
    options.values("--add", "TOOL", "the solid and the tool together",
                   [this](const std::string& v) { edits.push_back(EditAdd{editTool(v)}); });
    options.values("--cut", "TOOL", "the solid without the tool",
                   [this](const std::string& v) { edits.push_back(EditCut{editTool(v)}); });
    options.values("--move", "BOX",
                   "what of the solid lies in the box is moved, with its details; by how much says --by",
                   [this](const std::string& v) { edits.push_back(EditMove{box(v)}); });
    options.values("--by", "X,Y,Z", "by how much the --move before it moves (world units)",
                   [this](const std::string& v) { moveLast(v); });
    options.values(
        "--with", "FILE",
        "the level's control points as in FILE, a .vdb of isowave field that was changed; or, of a "
        "pyramid, its level 0, which undoes edits",
        [this](const std::string& v) { edits.push_back(EditWith{place(v)}); });
}

void EditChoices::moveLast(const std::string& by) {
    auto* move = edits.empty() ? nullptr : std::get_if<EditMove>(&edits.back());
    if (!move) throw UsageError("stands behind a --move");
    move->by = point(by);
}

}  // namespace isowave::tools
