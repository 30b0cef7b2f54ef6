// isowave lod INPUT -o FOLDER: each mesh is written as the ladder makes it; then report.json, then everything is put into
// the folder at once.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "base/atomic_file.h"
#include "base/heap.h"
#include "io/mesh/glb_lods.h"
#include "io/mesh/write.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "lod/budgets.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/json.h"
#include "tools/report/ladder_report.h"
#include "tools/solids/mesh_names.h"
#include "tools/solids/solid_options.h"
#include "tools/view/level_facts.h"
#include "tools/view/pages.h"

namespace isowave::tools {
namespace {

constexpr const char* kReport = "report.json";

// Writes meshes into the folder, and keeps what they are called.
struct MeshWriter {
    const MeshNames& names;
    MeshFormat format;
    MeshWriteOptions options;
    OutputFolder& out;
    std::unique_ptr<view::Page> page;  // of --view
    std::optional<GlbLods> lods;       // of --glb-lods
    Progress progress;
    LadderFiles files;
    double firstVoxel = 0;
    bool fromLevel0 = false;  // the page's first level is level 0, which the reports' distances are to

    template <class Report>
    void write(const std::string& name, const Report& report, const TriangleMesh& mesh) {
        writeMesh(out.place(name), mesh, format, options);
        if (!page) return;
        view::LevelFacts facts = factsOf(report, names.suffixOf(name), fromLevel0);
        facts.file = name;
        page->add(std::move(facts), mesh, progress);
    }
    LadderVisitor visitor() {
        const auto level = [this](const LevelReport& report, const TriangleMesh& mesh) {
            files.levels.push_back(names.ofStep(report.step));
            fromLevel0 = fromLevel0 || report.step == 0;
            if (lods) lods->add(names.suffixOf(files.levels.back()), mesh, coverageOf(report));
            write(files.levels.back(), report, mesh);
        };
        const auto budget = [this](const BudgetReport& report, const TriangleMesh& mesh) {
            files.budgets.push_back(names.ofBudget(report));
            write(files.budgets.back(), report, mesh);
        };
        return {level, budget, releaseFreedMemory};
    }
    // A level is fine enough while its voxel is at most so many voxels of the first one as the picture is smaller; the first one
    // suits half a picture.
    double coverageOf(const LevelReport& report) {
        const double voxel = std::cbrt(report.spacing[0] * report.spacing[1] * report.spacing[2]);
        if (firstVoxel == 0) firstVoxel = voxel;
        return 0.5 * firstVoxel / voxel;
    }
    void writeLods() {
        if (!lods) return;
        files.lods = names.ofLods();
        lods->write(out.place(files.lods));
    }
    void writePage() {
        if (!page) return;
        files.view = names.ofPage();
        AtomicFile file(out.place(files.view));
        writeWhole(file, page->html());
        file.commit();
    }
};

// " [mm]" behind lengths where it is known.
std::string unitShown(const Solid& solid) {
    const InputReport& input = solid.input();
    const std::string& unit = input.madeFrom ? input.madeFrom->unit : input.unit;
    if (!unit.empty()) return " [" + unit + "]";
    return solid.space() == Space::unspecified ? "" : " [mm]";
}

// Meshes that the folder's own report.json names, and this run does not make: they would pass for its levels.
std::vector<std::string> leftFromBefore(const OutputFolder& out, const LadderFiles& files) {
    std::ifstream in(out.folder() / kReport);
    const Json before = Json::parse(in, nullptr, /*allow_exceptions*/ false);
    std::vector<std::string> left;
    for (const char* key : {"levels", "budgets"}) {
        if (!before.is_object() || !before.contains(key)) continue;
        for (const Json& entry : before[key]) {
            if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) continue;
            const auto name = entry["file"].get<std::string>();
            const auto isOf = [&](const std::vector<std::string>& made) {
                return std::find(made.begin(), made.end(), name) != made.end();
            };
            std::error_code ignored;
            if (!isOf(files.levels) && !isOf(files.budgets) &&
                std::filesystem::is_regular_file(out.folder() / name, ignored))
                left.push_back(name);
        }
    }
    return left;
}

void tellOfWhatIsLeft(const OutputFolder& out, const LadderFiles& files, Console& console) {
    const std::vector<std::string> left = leftFromBefore(out, files);
    if (left.empty()) return;
    console.say(fmt::format("{}: {} of an earlier run {} there; this run has no such mesh",
                            out.folder().string(), fmt::join(left, ", "),
                            left.size() == 1 ? "stays" : "stay"));
}

// What can fail for want of room comes first; then only names change.
void finish(const Ladder& ladder, const LadderFiles& files, const std::string& unit, bool toStdout,
            AtomicFile* copy, OutputFolder& out, Console& console) {
    const std::string json = jsonOf(ladder, files);
    AtomicFile file(out.place(kReport));
    writeWhole(file, json);
    file.commit();
    if (copy) writeWhole(*copy, json);
    console.progress().check();
    tellOfWhatIsLeft(out, files, console);
    console.print(toStdout ? json : textOf(ladder, files, unit));
    console.flush();
    out.commit();
    if (copy) copy->commit();
}

class Lod : public Command {
  public:
    Lod();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void refuseTaken(const MeshNames& names, OutputFolder& out) const;
    std::optional<GlbLods> lodsOf(const Solid& solid) const;
    // Nothing without --view.
    std::unique_ptr<view::Page> pageOf(const Solid& solid, const std::string& name) const;

    LevelOptions levels_;
    BudgetOptions budgets_;
    SolidOptions solid_;
    std::optional<MeshFormat> format_;
    SpaceChoice space_;
    bool view_ = false;
    std::optional<bool> quantizedLods_;  // --glb-lods
};

Lod::Lod()
    : Command(
          {"lod", "INPUT", "a solid -> a ladder of closed meshes, one a level, and a report",
           "INPUT is an image (NIfTI, NRRD, MetaImage, MGH, TIFF; a folder of DICOM, TIFF or PNG slices; raw "
           "with "
           "--size), a mesh (STL, OBJ, PLY, OFF, GLB), a level set (.vdb) or a pyramid (analyse, pack). -o "
           "out/part "
           "makes "
           "the folder out/part with part_L0.ply, part_L1.ply, ... and report.json; with --steps the meshes "
           "are "
           "part_s0.ply, part_s1.ply, ... Level L is step 3L: every axis halved L times. With a budget there "
           "is "
           "one mesh a budget instead of one a level (give --levels to have both): the step whose topology "
           "suits "
           "it, with edges collapsed; the report says which and why. The ladder ends where one node is left, "
           "or "
           "before the first level at which the whole solid has vanished. A run that fails or is interrupted "
           "leaves the folder as it was."}) {
    declareOutput("the folder that gets one mesh a level, and report.json");
    declareLevels(options_, levels_);
    declareFormat(options_, format_);
    space_.declare(options_);
    options_.value("--glb-lods", "quantized|float", "",
                   "also one GLB with all levels (MSFT_lod), name_lods.glb: positions of 16 bits "
                   "(KHR_mesh_quantization), or float32",
                   [this](const std::string& v) {
                       quantizedLods_ = choice<bool>(v, {{"quantized", true}, {"float", false}});
                   });
    options_.flag("--view", "also a page to look at, name.html, as isowave view makes it", view_);
    declareMesh(options_, levels_, /*features=*/true);
    declareJson();
    declareBudgets(options_, budgets_, levels_);
    declareSolid(options_, solid_);
    declareThreads();
    declareMaxMemory(options_, solid_);
    declareQuiet();
}

void Lod::refuseTaken(const MeshNames& names, OutputFolder& out) const {
    if (jsonToFile()) out.keepFree(*json_);
    out.refuseTaken(kReport);
    for (const std::string& file : names.all()) out.refuseTaken(file);
    if (view_) out.refuseTaken(names.ofPage());
    if (quantizedLods_) out.refuseTaken(names.ofLods());
}

std::optional<GlbLods> Lod::lodsOf(const Solid& solid) const {
    if (!quantizedLods_) return std::nullopt;
    return GlbLods({space_.of(solid), metresPerUnitOf(solid)}, *quantizedLods_);
}

std::unique_ptr<view::Page> Lod::pageOf(const Solid& solid, const std::string& name) const {
    return view_ ? std::make_unique<view::Page>(pageOptionsOf(solid.input(), name)) : nullptr;
}

int Lod::run(Console& console) {
    if (view_) view::requirePages();
    if (quantizedLods_ && budgets_.any() && !levels_.levels && !levels_.steps)
        throw UsageError("--glb-lods holds levels, and with a budget there are none; give --levels too");
    OutputFolder out(*output_, Inputs(arguments));
    const MeshFormat format = format_.value_or(MeshFormat::ply);
    if (budgets_.any()) budgets_.maxGenus = levels_.maxGenus;
    lod::checkBudgets(budgets_, solid_.openBorder);
    checkRanges(levels_);
    const MeshNames names(out.name(), format, levels_, budgets_);
    refuseTaken(names, out);
    std::optional<OutputFile> copyFolders;
    std::optional<AtomicFile> copy;  // opened now: a report that cannot be written is no surprise at the end
    if (jsonToFile()) {
        copyFolders.emplace(*json_);
        copy.emplace(*json_);
    }
    try {
        Solid solid = open(arguments[0], solid_, console.progress());
        const std::string unit = unitShown(solid);
        MeshWriter writer{.names = names,
                          .format = format,
                          .options = {space_.of(solid), metresPerUnitOf(solid)},
                          .out = out,
                          .page = pageOf(solid, out.name()),
                          .lods = lodsOf(solid),
                          .progress = console.progress(),
                          .files = {}};
        const Ladder ladder =
            makeBudget(std::move(solid), budgets_, levels_, writer.visitor(), console.progress());
        writer.writeLods();
        writer.writePage();
        finish(ladder, writer.files, unit, jsonToStandardOutput(), copy ? &*copy : nullptr, out, console);
        if (copyFolders) copyFolders->commit();
    } catch (const OperationError& error) {
        throw OperationError(out.publicText(error.what()));
    }
    return 0;
}

}  // namespace

std::unique_ptr<Command> lodCommand() { return std::make_unique<Lod>(); }

}  // namespace isowave::tools
