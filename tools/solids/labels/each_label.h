// --each-label: of a label image every label is a solid of its own, and an object of its own in each level's file.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "io/mesh/xml/three_mf_writer.h"
#include "isowave/ladder.h"
#include "tools/command.h"
#include "tools/report/ladder_report.h"
#include "tools/solids/mesh_names.h"

namespace isowave::tools {

struct LabelChoice {
    bool each = false;

    void declare(OptionList& options);
    // Throws UsageError where files of that format have no objects, and for what is one a solid.
    void check(MeshFormat format, const BudgetOptions& budgets, bool view, bool lods, bool tiles) const;
};

// A label that is asked for. Its name and colour are those that the image's file gives it, else "label 3", and the next of eight.
struct NamedLabel {
    double label = 0;
    std::string name;
    ModelColour colour{};
};
// Those of options.label and labels, else all but 0. Throws InputError: no label image.
std::vector<NamedLabel> namedLabels(const std::filesystem::path& input, const SolidOptions& options,
                                    const Progress& progress);

// The ladders of all labels, and the files that hold their meshes.
struct LabelLadders {
    std::vector<NamedLabel> labels;
    std::vector<Ladder> ladders;
    std::vector<LadderFiles> files;  // of each ladder
    std::vector<std::string> written;
    std::string unit;  // " [mm]"
};
// place(name): where the file of that name goes to. options(solid): how it is written.
LabelLadders makeEachLabel(const std::filesystem::path& input, const SolidOptions& solid,
                           const LevelOptions& levels, const MeshNames& names,
                           const std::function<MeshWriteOptions(const Solid&)>& options,
                           const std::function<std::filesystem::path(const std::string&)>& place,
                           const Progress& progress);

// report.json: for each label its number, name, colour and the report of a ladder of its own.
std::string jsonOf(const LabelLadders& made);
// A heading for each label, then the text of its ladder.
std::string textOf(const LabelLadders& made);

}  // namespace isowave::tools
