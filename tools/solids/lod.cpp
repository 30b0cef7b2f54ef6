// isowave lod INPUT -o FOLDER: each mesh is written as the ladder makes it; then report.json, then everything is put into
// the folder at once.
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/atomic_file.h"
#include "base/heap.h"
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

namespace isowave::tools {
namespace {

constexpr const char* kReport = "report.json";

// Writes meshes into the folder, and keeps what they are called.
struct MeshWriter {
    const MeshNames& names;
    MeshFormat format;
    MeshWriteOptions options;
    OutputFolder& out;
    LadderFiles files;

    void write(const std::string& name, const TriangleMesh& mesh) {
        writeMesh(out.place(name), mesh, format, options);
    }
    LadderVisitor visitor() {
        const auto level = [this](const LevelReport& report, const TriangleMesh& mesh) {
            files.levels.push_back(names.ofStep(report.step));
            write(files.levels.back(), mesh);
        };
        const auto budget = [this](const BudgetReport& report, const TriangleMesh& mesh) {
            files.budgets.push_back(names.ofBudget(report));
            write(files.budgets.back(), mesh);
        };
        return {level, budget, releaseFreedMemory};
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

// Of the triangles of a mesh, or of level 0.
double share(const std::string& text) {
    const double ratio = positive(text);
    if (ratio > 1) throw UsageError("'" + text + "' is above 1, all triangles");
    return ratio;
}

class Lod : public Command {
  public:
    Lod();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void declareLevels();
    void declareBudgets();
    void refuseTaken(const MeshNames& names, OutputFolder& out) const;

    LevelOptions levels_;
    BudgetOptions budgets_;
    SolidOptions solid_;
    std::optional<MeshFormat> format_;
    SpaceChoice space_;
};

Lod::Lod()
    : Command(
          {"lod", "INPUT", "a solid -> a ladder of closed meshes, one a level, and a report",
           "INPUT is an image (NIfTI, NRRD, MetaImage, MGH, TIFF; a folder of DICOM, TIFF or PNG slices; raw "
           "with "
           "--size), a mesh (STL, OBJ, PLY, OFF, GLB), a level set (.vdb) or a pyramid (analyse). -o "
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
    declareLevels();
    declareFormat(options_, format_);
    space_.declare(options_);
    declareMesh(options_, levels_, /*features=*/true);
    declareJson();
    declareBudgets();
    declareSolid(options_, solid_);
    declareThreads();
    declareMaxMemory(options_, solid_);
    declareQuiet();
}

void Lod::declareLevels() {
    options_.value("--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)",
                   [this](const std::string& v) { levels_.levels = range(v); });
    options_.value("--steps", "A..B", "", "steps instead of levels; three steps are a level",
                   [this](const std::string& v) { levels_.steps = range(v); });
}

void Lod::declareBudgets() {
    options_.value(
        "--triangles", "N,N,...", "", "instead of the levels, meshes of at most so many triangles: name_TN",
        [this](const std::string& v) {
            budgets_.triangles = list(v, [](const std::string& n) { return integer(n, 4, kHuge); });
        });
    options_.value("--ratio", "R,R,...", "",
                   "the same as a share of the mesh's own triangles, of level 0's for other inputs (0.01 = 1 "
                   "%): name_RR",
                   [this](const std::string& v) { budgets_.ratios = list(v, share); });
    options_.value("--tolerance", "D,D,...", "",
                   "the fewest triangles that stay within D (world units) of level 0, both ways: name_DD",
                   [this](const std::string& v) { budgets_.tolerances = list(v, positive); });
    options_.value(
        "--max-genus", "N", "",
        "at most N handles in every mesh: holes are filled or their rings cut, whichever takes less volume",
        [this](const std::string& v) { levels_.maxGenus = integer(v, 0, kHuge); });
    options_.value(
        "--max-parts", "N", "",
        "at most N parts in every mesh: the others are removed, or joined where that takes less volume",
        [this](const std::string& v) { levels_.maxParts = integer(v, 1, kHuge); });
    options_.value("--min-component", "VOLUME", "",
                   "budgets: only from steps without components smaller than that (world units cubed)",
                   [this](const std::string& v) { budgets_.minComponent = positive(v); });
}

void Lod::refuseTaken(const MeshNames& names, OutputFolder& out) const {
    if (jsonToFile()) out.keepFree(*json_);
    out.refuseTaken(kReport);
    for (const std::string& file : names.all()) out.refuseTaken(file);
}

int Lod::run(Console& console) {
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
        MeshWriter writer{names, format, {space_.of(solid), metresPerUnitOf(solid)}, out, {}};
        const Ladder ladder =
            makeBudget(std::move(solid), budgets_, levels_, writer.visitor(), console.progress());
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
