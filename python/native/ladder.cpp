#include "python/native/ladder.h"

#include <map>
#include <memory>
#include <tuple>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "lod/budgets.h"
#include "python/native/arrays.h"
#include "python/native/options.h"
#include "python/native/watch.h"
#include "tools/output.h"
#include "tools/report/json.h"
#include "tools/report/ladder_report.h"
#include "tools/solids/labels/each_label.h"
#include "tools/solids/mesh_colours.h"
#include "tools/solids/mesh_names.h"
#include "tools/solids/solid_options.h"
#include "tools/solids/tiles/tile_choice.h"

namespace isowave::python {
namespace {

// A ladder, and what writing its meshes takes.
struct MadeLadder {
    Ladder ladder;
    SolidChoices choices;
    Space space = Space::unspecified;
    double metresPerUnit = 0.001;

    // Levels that have not vanished, then budgets.
    std::size_t levelCount() const {
        std::size_t count = ladder.levels.size();
        while (count > 0 && ladder.levels[count - 1].report.vanished()) --count;
        return count;
    }
    std::size_t size() const { return levelCount() + ladder.budgets.size(); }
    const TriangleMesh& mesh(std::size_t i) const {
        return i < levelCount() ? ladder.levels.at(i).mesh : ladder.budgets.at(i - levelCount()).mesh;
    }
    bool isLevel(std::size_t i) const { return i < levelCount(); }
};
using LadderPointer = std::shared_ptr<MadeLadder>;

// keep: the caller goes on using the solid; else its field goes as soon as the first step is made, and the solid is empty.
LadderPointer make(Solid& solid, const GivenOptions& given, bool keep, const py::object& watch) {
    auto made = std::make_shared<MadeLadder>(MadeLadder{{}, SolidChoices(given)});
    made->space = solid.space();
    made->metresPerUnit = tools::metresPerUnitOf(solid);
    checkRanges(made->choices.levels);
    Solid taken = keep ? solid : std::move(solid);
    made->ladder = watched(watch, [&](const Progress& progress) {
        return makeBudget(std::move(taken), made->choices.budgets, made->choices.levels, {}, progress);
    });
    return made;
}

// Before anything is read. Throws UsageError for options that exclude each other.
void check(const GivenOptions& given) {
    const SolidChoices choices(given);
    lod::checkBudgets(choices.budgets, choices.solid.openBorder);
    checkRanges(choices.levels);
}

struct WriteChoice {
    MeshFormat format;
    MeshWriteOptions options;
    tools::ColourChoice colour;

    // Of every mesh, with its distances to level 0, which must be there where they are wanted.
    struct Coloured {
        std::vector<MeshWriteOptions> each;
        std::optional<double> range;
    };
    Coloured coloured(const MadeLadder& made, const Progress& progress) const {
        colour.requireLevel0(made.choices.levels, made.choices.budgets);
        tools::MeshColours colours(colour);
        if (made.levelCount() > 0) colours.setLevel0(made.mesh(0));
        Coloured all;
        for (std::size_t i = 0; i < made.size(); ++i) {
            const bool isLevel0 = i < made.levelCount() && made.ladder.levels[i].report.step == 0;
            all.each.push_back(colours.with(options, made.mesh(i), isLevel0, progress));
        }
        all.range = colours.range();
        for (MeshWriteOptions& one : all.each) one.distanceRange = all.range.value_or(0);
        return all;
    }
};

WriteChoice choiceOf(const MadeLadder& made, const std::string& format, const std::string& space,
                     const std::string& colour) {
    std::optional<MeshFormat> chosen;
    tools::SpaceChoice spaceChoice;
    tools::ColourChoice colourChoice;
    tools::OptionList options;
    tools::declareFormat(options, chosen);
    spaceChoice.declare(options);
    colourChoice.declare(options);
    GivenOptions given{{"--format", format}};
    if (!space.empty()) given.push_back({"--space", space});
    if (!colour.empty()) given.push_back({"--colour", colour});
    take(given, options);
    colourChoice.requireFormat(*chosen);
    return {*chosen, {spaceChoice.of(made.space), made.metresPerUnit}, colourChoice};
}

tools::TileChoice tilesOf(const MadeLadder& made, const std::string& format) {
    tools::TileChoice tiles;
    tools::OptionList options;
    tiles.declare(options);
    if (!format.empty()) take({{"--tiles", format}}, options);
    tiles.requireLevels(made.choices.levels, made.choices.budgets);
    return tiles;
}

tools::LadderFiles filesOf(const MadeLadder& made, const tools::MeshNames& names) {
    tools::LadderFiles files;
    for (std::size_t i = 0; i < made.levelCount(); ++i)
        files.levels.push_back(names.ofLevel(made.ladder.levels[i].report));
    for (const BudgetLevel& budget : made.ladder.budgets)
        files.budgets.push_back(names.ofBudget(budget.report));
    return files;
}

// The report beside the meshes; then all of the folder appears. Returns the report's place.
std::filesystem::path finish(tools::OutputFolder& out, const std::string& report,
                             const std::vector<std::string>& remarks, const Progress& progress) {
    tools::writeFiles(out, {{"report.json", tools::withRemarks(report, remarks)}});
    progress.check();
    out.commit();
    return out.folder() / "report.json";
}

// What `isowave lod -o FOLDER` writes. inputs: what no file may take the place of.
std::vector<std::filesystem::path> save(const MadeLadder& made, const std::filesystem::path& folder,
                                        const std::string& format, const std::string& space,
                                        const std::string& colour, const std::string& tiles,
                                        const std::vector<std::filesystem::path>& inputs,
                                        const std::vector<std::string>& remarks, const py::object& watch) {
    const WriteChoice choice = choiceOf(made, format, space, colour);
    const tools::TileChoice tileChoice = tilesOf(made, tiles);
    return watched(watch, [&](const Progress& progress) {
        tools::OutputFolder out(folder, tools::Inputs(inputs));
        const tools::MeshNames names(out.name(), choice.format, made.choices.levels, made.choices.budgets);
        tools::LadderFiles files = filesOf(made, names);
        std::vector<std::string> all = files.levels;
        all.insert(all.end(), files.budgets.begin(), files.budgets.end());
        std::vector<std::filesystem::path> places;
        const WriteChoice::Coloured coloured = choice.coloured(made, progress);
        files.colourRange = coloured.range;
        try {
            for (std::size_t i = 0; i < all.size(); ++i) {
                progress("write", static_cast<double>(i) / static_cast<double>(all.size()));
                writeMesh(out.place(all[i]), made.mesh(i), choice.format, coloured.each[i]);
                places.push_back(out.folder() / all[i]);
            }
            if (const auto writer = tileChoice.writerFor(out, made.ladder.input, choice.options)) {
                for (std::size_t i = 0; i < made.levelCount(); ++i)
                    tools::addTiles(*writer, made.ladder.levels[i].report, made.mesh(i), progress);
                writer->finish();
                files.tiles = tileChoice.folderOf(out.name());
                places.push_back(out.folder() / files.tiles);
            }
            places.push_back(finish(out, tools::jsonOf(made.ladder, files), remarks, progress));
        } catch (const OperationError& error) {
            throw OperationError(out.publicText(error.what()));
        }
        return places;
    });
}

void write(const MadeLadder& made, std::size_t i, const std::filesystem::path& path, const std::string& space,
           const std::string& colour) {
    const WriteChoice choice = choiceOf(made, extensionOf(meshFormatOf(path)) + 1, space, colour);
    const py::gil_scoped_release release;
    tools::OutputFile out(path);
    writeMesh(path, made.mesh(i), choice.format, choice.coloured(made, {}).each[i]);
    out.commit();
}

py::tuple meshArrays(const LadderPointer& made, std::size_t i) {
    const py::object owner = py::cast(made);
    const TriangleMesh& mesh = made->mesh(i);
    return py::make_tuple(rowsOf<double>(mesh.points, owner), rowsOf<std::int32_t>(mesh.triangles, owner),
                          rowsOf<float>(mesh.normals, owner));
}

// ---- labels, each a solid of its own

using Label = std::tuple<double, std::string, ModelColour>;  // its name and colour behind it

// Those of an image's file, but for 0, or those that are asked for, with the names and colours that it has for them.
std::vector<Label> labelsOf(const std::filesystem::path& path, const GivenOptions& given,
                            const py::object& watch) {
    const SolidOptions options = SolidChoices(given).solid;
    return watched(watch, [&](const Progress& progress) {
        std::vector<Label> all;
        for (const tools::NamedLabel& label : tools::namedLabels(path, options, progress))
            all.emplace_back(label.label, label.name, label.colour);
        return all;
    });
}

// Without the meshes, which a report does not need.
Ladder reportsOf(const Ladder& ladder) {
    Ladder reports;
    reports.input = ladder.input;
    reports.fit = ladder.fit;
    reports.K = ladder.K;
    reports.order = ladder.order;
    for (const Level& level : ladder.levels) reports.levels.push_back({level.report, {}});
    reports.steps = ladder.steps;
    reports.coefficientsStored = ladder.coefficientsStored;
    reports.controlPoints = ladder.controlPoints;
    reports.seconds = ladder.seconds;
    reports.totalSeconds = ladder.totalSeconds;
    reports.peakMemoryBytes = ladder.peakMemoryBytes;
    reports.threads = ladder.threads;
    return reports;
}

// Of the labels that are still there at that step.
std::vector<ModelObject> objectsOf(const std::vector<Label>& labels,
                                   const std::vector<LadderPointer>& ladders, int step) {
    std::vector<ModelObject> objects;
    for (std::size_t i = 0; i < labels.size(); ++i)
        for (std::size_t level = 0; level < ladders[i]->levelCount(); ++level)
            if (ladders[i]->ladder.levels[level].report.step == step)
                objects.push_back({std::get<1>(labels[i]), std::get<2>(labels[i]), ladders[i]->mesh(level)});
    return objects;
}

// What `isowave lod --each-label --format 3mf -o FOLDER` writes. REQUIRES: as many ladders as labels, and one at least, all made
// with the same options.
std::vector<std::filesystem::path> saveLabels(const std::vector<Label>& labels,
                                              const std::vector<LadderPointer>& ladders,
                                              const std::filesystem::path& folder, const std::string& space,
                                              const std::vector<std::filesystem::path>& inputs,
                                              const std::vector<std::string>& remarks,
                                              const py::object& watch) {
    const MadeLadder& first = *ladders.at(0);
    const WriteChoice choice = choiceOf(first, "3mf", space, "");
    return watched(watch, [&](const Progress& progress) {
        tools::OutputFolder out(folder, tools::Inputs(inputs));
        const tools::MeshNames names(out.name(), choice.format, first.choices.levels, first.choices.budgets);
        tools::LabelLadders made;
        std::map<int, std::string> fileOf;  // by step: a level of all labels is one file
        for (std::size_t i = 0; i < labels.size(); ++i) {
            const auto& [number, name, colour] = labels[i];
            made.labels.push_back({number, name, colour});
            made.ladders.push_back(reportsOf(ladders[i]->ladder));
            made.files.push_back(filesOf(*ladders[i], names));
            for (std::size_t level = 0; level < ladders[i]->levelCount(); ++level)
                fileOf[ladders[i]->ladder.levels[level].report.step] = made.files.back().levels[level];
        }
        std::vector<std::filesystem::path> places;
        try {
            for (const auto& [step, file] : fileOf) {
                progress.check();
                writeThreeMfObjects(out.place(file), objectsOf(labels, ladders, step), choice.options);
                made.written.push_back(file);
                places.push_back(out.folder() / file);
            }
            places.push_back(finish(out, tools::jsonOf(made), remarks, progress));
        } catch (const OperationError& error) {
            throw OperationError(out.publicText(error.what()));
        }
        return places;
    });
}

}  // namespace

void bindLadder(py::module_& module) {
    py::class_<MadeLadder, LadderPointer>(module, "Ladder")
        .def("__len__", &MadeLadder::size)
        .def_property_readonly("level_count", &MadeLadder::levelCount)
        .def("arrays", meshArrays)
        .def("report", [](const MadeLadder& made) { return tools::jsonOf(made.ladder); })
        .def("save", save)
        .def("write", write);
    module.def("make_ladder", make);
    module.def("check_ladder_options", check);
    module.def("labels_of", labelsOf);
    module.def("label_colour", modelColour);
    module.def("save_labels", saveLabels);
}

}  // namespace isowave::python
