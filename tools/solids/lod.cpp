// isowave lod INPUT... -o FOLDER: each mesh is written as the ladder makes it; then report.json, then everything is put into
// the folder at once. Several inputs get a folder each, one after another.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <variant>

#include "base/atomic_file.h"
#include "base/heap.h"
#include "base/number_text.h"
#include "io/image/kind.h"
#include "io/mesh/glb_lods.h"
#include "io/mesh/read.h"
#include "io/mesh/write.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "lod/budgets.h"
#include "lod/source.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/json.h"
#include "tools/report/ladder_report.h"
#include "tools/solids/dry_run_text.h"
#include "tools/solids/labels/each_label.h"
#include "tools/solids/mesh_colours.h"
#include "tools/solids/mesh_names.h"
#include "tools/solids/parts.h"
#include "tools/solids/solid_options.h"
#include "tools/solids/tiles/tile_choice.h"
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
    MeshColours colours;
    OutputFolder& out;
    std::unique_ptr<view::Page> page;   // of --view
    std::optional<GlbLods> lods;        // of --glb-lods
    std::unique_ptr<TileWriter> tiles;  // of --tiles
    Progress progress;
    LadderFiles files;
    std::vector<std::filesystem::path> written = {};
    double firstVoxel = 0;
    bool fromLevel0 = false;  // the page's first level is level 0, which the reports' distances are to

    template <class Report>
    void write(const std::string& name, const Report& report, const TriangleMesh& mesh,
               const MeshWriteOptions& with) {
        written.push_back(out.place(name));
        writeMesh(written.back(), mesh, format, with);
        if (!page) return;
        view::LevelFacts facts = factsOf(report, names.suffixOf(name), fromLevel0);
        facts.file = name;
        page->add(std::move(facts), mesh, progress);
    }
    LadderVisitor visitor() {
        const auto level = [this](const LevelReport& report, const TriangleMesh& mesh) {
            files.levels.push_back(names.ofLevel(report));
            fromLevel0 = fromLevel0 || report.step == 0;
            if (tiles) addTiles(*tiles, report, mesh, progress);
            if (report.step == 0) colours.setLevel0(mesh);
            const MeshWriteOptions with = colours.with(options, mesh, report.step == 0, progress);
            if (lods)
                lods->add(names.suffixOf(files.levels.back()), mesh, coverageOf(report),
                          with.distanceToLevel0);
            write(files.levels.back(), report, mesh, with);
        };
        const auto budget = [this](const BudgetReport& report, const TriangleMesh& mesh) {
            files.budgets.push_back(names.ofBudget(report));
            write(files.budgets.back(), report, mesh, colours.with(options, mesh, false, progress));
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
        lods->write(out.place(files.lods), colours.range().value_or(0));
    }
    // One range of colours for all meshes: known when the last one has been measured.
    void recolour() {
        files.colourRange = colours.range();
        for (const std::filesystem::path& file : written) colours.recolour(file, format);
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
    const std::string unit = lod::unitOf(solid.input());
    return unit.empty() ? "" : " [" + unit + "]";
}

// All that there is to tell about one input's meshes.
struct Made {
    Ladder ladder;
    LadderFiles files;
    std::string unit;  // as unitShown() has it
};

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

// The report and the text of a run, and which files it has made.
struct Told {
    std::string json, text;
    LadderFiles files;
};

Told toldOf(const Made& made) {
    return {jsonOf(made.ladder, made.files), textOf(made.ladder, made.files, made.unit), made.files};
}

Told toldOf(const LabelLadders& made) { return {jsonOf(made), textOf(made), {made.written, {}}}; }

void tellOfWhatIsLeft(const OutputFolder& out, const LadderFiles& files, const Progress& progress) {
    const std::vector<std::string> left = leftFromBefore(out, files);
    if (left.empty()) return;
    progress.say(fmt::format("{}: {} of an earlier run {} there; this run has no such mesh",
                             out.folder().string(), fmt::join(left, ", "),
                             left.size() == 1 ? "stays" : "stay"));
}

void writeReport(const std::string& json, OutputFolder& out) {
    AtomicFile file(out.place(kReport));
    writeWhole(file, json);
    file.commit();
}

// "5 levels, 12,000 to 96 triangles"
PartStory storyOf(const Made& made, const OutputFolder& out) {
    PartStory story;
    const std::vector<Level>& all = made.ladder.levels;
    const auto levels =
        std::count_if(all.begin(), all.end(), [](const Level& l) { return !l.report.vanished(); });
    const auto budgets = static_cast<std::int64_t>(made.ladder.budgets.size());
    if (levels > 0)
        story.text =
            fmt::format("{}, {} to {} triangles", counted(levels, "level"),
                        grouped(all.front().report.topology.triangles),
                        grouped(all[static_cast<std::size_t>(levels) - 1].report.topology.triangles));
    if (budgets > 0)
        story.text += (levels > 0 ? ", " : "") + counted(budgets, "mesh by budget", "meshes by budget");
    story.json = {{"report", (out.folder() / kReport).string()}, {"levels", levels}, {"budgets", budgets}};
    return story;
}

// What can fail for want of room comes first; then only names change.
void finish(const Told& told, bool toStdout, AtomicFile* copy, OutputFolder& out, Console& console) {
    tellOfWhatIsLeft(out, told.files, console.progress());
    const std::string json = withRemarks(told.json, console.remarks());
    writeReport(json, out);
    if (copy) writeWhole(*copy, json);
    console.progress().check();
    console.print(toStdout ? json : told.text);
    console.flush();
    out.commit();
    if (copy) copy->commit();
}

std::vector<std::filesystem::path> filesOf(const std::vector<FineRegion>& regions) {
    std::vector<std::filesystem::path> files;
    for (const FineRegion& region : regions)
        if (const auto* path = std::get_if<std::filesystem::path>(&region.where)) files.push_back(*path);
    return files;
}

class Lod : public Command {
  public:
    Lod();
    bool needsOutput() const override { return !dryRun_; }
    bool hasOtherInputs() const override { return parts_.list.has_value(); }
    int run(Console& console) override;

  private:
    void check();
    int runOne(Console& console);
    int runParts(Console& console);
    PartStory runPart(const Part& part, const Progress& progress) const;
    // All files that one input's job reads: no result takes their place.
    std::vector<std::filesystem::path> readFor(const std::filesystem::path& input) const;
    MeshNames namesIn(const OutputFolder& out) const;
    Made make(const std::filesystem::path& input, const MeshNames& names, OutputFolder& out,
              const Progress& progress) const;
    LabelLadders makeLabels(const std::filesystem::path& input, const MeshNames& names, OutputFolder& out,
                            const Progress& progress) const;
    void refuseTaken(const MeshNames& names, OutputFolder& out) const;
    std::optional<GlbLods> lodsOf(const Solid& solid) const;
    // Nothing without --view.
    std::unique_ptr<view::Page> pageOf(const Solid& solid, const std::string& name) const;

    LevelOptions levels_;
    BudgetOptions budgets_;
    SolidOptions solid_;
    PartsChoice parts_;
    bool dryRun_ = false;
    std::optional<MeshFormat> format_;
    SpaceChoice space_;
    ColourChoice colour_;
    TileChoice tiles_;
    LabelChoice labels_;
    bool view_ = false;
    std::optional<bool> quantizedLods_;  // --glb-lods
};

const std::string& lodDetails() {
    static const std::string text =
        "INPUT is an image (" + imageio::imageFormatNames() +
        "; slices in a folder; raw with --size), a mesh (" + meshInputNames() +
        "), a level set (.vdb) or a "
        "pyramid (analyse, pack). -o "
        "out/part "
        "makes "
        "the folder out/part with part_L0.ply, part_L1.ply, ... and report.json; with --steps the meshes "
        "are "
        "part_s0.ply, part_s1.ply, ... Level L is step 3L: every axis halved L times; where voxels are no "
        "cubes "
        "the first levels halve their short edges alone (--axes). With a budget there "
        "is "
        "one mesh a budget instead of one a level (give --levels to have both): the step whose topology "
        "suits "
        "it, with edges collapsed; the report says which and why. The ladder ends where one node is left, "
        "or "
        "before the first level at which the whole solid has vanished. A run that fails or is interrupted "
        "leaves the folder as it was. Several inputs, -o out: each gets a folder of its own, out/NAME, as "
        "if "
        "it were run alone; one that fails does not stop the others.";
    return text;
}

Lod::Lod()
    : Command({"lod", "INPUT...", "a solid -> a ladder of closed meshes, one a level, and a report",
               lodDetails()}) {
    declareOutput("the folder that gets one mesh a level, and report.json");
    parts_.declare(options_);
    options_.flag("--dry-run",
                  "make nothing; say voxels, memory, levels, and how many voxels thin the thinnest walls are",
                  dryRun_);
    declareLevels(options_, levels_);
    declareFormat(options_, format_);
    space_.declare(options_);
    colour_.declare(options_);
    options_.value("--glb-lods", "quantized|float", "",
                   "also one GLB with all levels (MSFT_lod), name_lods.glb: positions of 16 bits "
                   "(KHR_mesh_quantization), or float32",
                   [this](const std::string& v) {
                       quantizedLods_ = choice<bool>(v, {{"quantized", true}, {"float", false}});
                   });
    tiles_.declare(options_);
    labels_.declare(options_);
    options_.flag("--view", "also a page to look at, name.html, as isowave view makes it", view_);
    declareMesh(options_, levels_, /*features=*/true);
    declareRegions(options_, levels_);
    declareJson();
    declareBudgets(options_, budgets_, levels_);
    declareSolid(options_, solid_);
    declareThreads();
    declareMaxMemory(options_, solid_);
    declareSlabs(options_, solid_);
    declareTalk();
}

void Lod::refuseTaken(const MeshNames& names, OutputFolder& out) const {
    out.refuseTaken(kReport);
    for (const std::string& file : names.all()) out.refuseTaken(file);
    if (view_) out.refuseTaken(names.ofPage());
    if (quantizedLods_) out.refuseTaken(names.ofLods());
    if (tiles_.format) out.refuseTaken(tiles_.folderOf(out.name()));
}

std::optional<GlbLods> Lod::lodsOf(const Solid& solid) const {
    if (!quantizedLods_) return std::nullopt;
    return GlbLods({space_.of(solid), metresPerUnitOf(solid)}, *quantizedLods_);
}

std::unique_ptr<view::Page> Lod::pageOf(const Solid& solid, const std::string& name) const {
    return view_ ? std::make_unique<view::Page>(pageOptionsOf(solid.input(), name)) : nullptr;
}

void Lod::check() {
    if (view_) view::requirePages();
    colour_.requireFormat(format_.value_or(MeshFormat::ply));
    colour_.requireLevel0(levels_, budgets_);
    if (quantizedLods_ && budgets_.any() && !levels_.levels && !levels_.steps)
        throw UsageError("--glb-lods holds levels, and with a budget there are none; give --levels too");
    tiles_.requireLevels(levels_, budgets_);
    labels_.check(format_.value_or(MeshFormat::ply), budgets_, view_, quantizedLods_.has_value(),
                  tiles_.format.has_value());
    lod::requireNoRegions(budgets_, levels_);
    if (budgets_.any()) budgets_.maxGenus = levels_.maxGenus;
    lod::checkBudgets(budgets_, solid_.openBorder);
    checkRanges(levels_);
}

std::vector<std::filesystem::path> Lod::readFor(const std::filesystem::path& input) const {
    std::vector<std::filesystem::path> files = filesOf(levels_.fine);
    files.insert(files.begin(), input);
    return files;
}

MeshNames Lod::namesIn(const OutputFolder& out) const {
    return MeshNames(out.name(), format_.value_or(MeshFormat::ply), levels_, budgets_);
}

Made Lod::make(const std::filesystem::path& input, const MeshNames& names, OutputFolder& out,
               const Progress& progress) const {
    Solid solid = open(input, withSlabsBeside(solid_, out.folder()), progress);
    const std::string unit = unitShown(solid);
    const MeshWriteOptions options{space_.of(solid), metresPerUnitOf(solid)};
    MeshWriter writer{.names = names,
                      .format = format_.value_or(MeshFormat::ply),
                      .options = options,
                      .colours = MeshColours(colour_),
                      .out = out,
                      .page = pageOf(solid, out.name()),
                      .lods = lodsOf(solid),
                      .tiles = tiles_.writerFor(out, solid.input(), options),
                      .progress = progress,
                      .files = {}};
    Ladder ladder = makeBudget(std::move(solid), budgets_, levels_, writer.visitor(), progress);
    writer.recolour();
    writer.writeLods();
    if (writer.tiles) {
        writer.tiles->finish();
        writer.files.tiles = tiles_.folderOf(out.name());
    }
    writer.writePage();
    return {std::move(ladder), std::move(writer.files), unit};
}

LabelLadders Lod::makeLabels(const std::filesystem::path& input, const MeshNames& names, OutputFolder& out,
                             const Progress& progress) const {
    const auto options = [this](const Solid& solid) {
        return MeshWriteOptions{space_.of(solid), metresPerUnitOf(solid)};
    };
    return makeEachLabel(
        input, withSlabsBeside(solid_, out.folder()), levels_, names, options,
        [&](const std::string& name) { return out.place(name); }, progress);
}

int Lod::run(Console& console) {
    if (dryRun_) {
        check();
        if (json_) throw UsageError("--dry-run has no report; leave out --json");
        return tellDryRuns(parts_.inputs(arguments), solid_, console);
    }
    return parts_.asksForParts(arguments) ? runParts(console) : runOne(console);
}

int Lod::runOne(Console& console) {
    OutputFolder out(*output_, Inputs(readFor(arguments[0])));
    check();
    const MeshNames names = namesIn(out);
    if (jsonToFile()) out.keepFree(*json_);
    refuseTaken(names, out);
    std::optional<OutputFile> copyFolders;
    std::optional<AtomicFile> copy;  // opened now: a report that cannot be written is no surprise at the end
    if (jsonToFile()) {
        copyFolders.emplace(*json_);
        copy.emplace(*json_);
    }
    try {
        const Progress progress = console.progress();
        const Told told = labels_.each ? toldOf(makeLabels(arguments[0], names, out, progress))
                                       : toldOf(make(arguments[0], names, out, progress));
        finish(told, jsonToStandardOutput(), copy ? &*copy : nullptr, out, console);
        if (copyFolders) copyFolders->commit();
    } catch (const OperationError& error) {
        throw OperationError(out.publicText(error.what()));
    }
    return 0;
}

// --json has what became of each input; the reports are in the folders.
int Lod::runParts(Console& console) {
    check();
    if (labels_.each) throw UsageError("--each-label takes one image; start isowave once for each");
    const std::vector<std::filesystem::path> inputs = parts_.inputs(arguments);
    std::vector<Part> parts = partsOf(inputs, *output_);
    if (jsonToFile()) refuseAmong(parts, *json_);
    openJson();
    PartsRun all(std::move(parts), console);
    const int code = all.run([this](const Part& part, const Progress& p) { return runPart(part, p); },
                             jsonToStandardOutput());
    if (code != kInterrupted) tell(console, all.text(), dumped(all.json()));
    return code;
}

PartStory Lod::runPart(const Part& part, const Progress& progress) const {
    OutputFolder out(part.output, Inputs(readFor(part.input)));
    const MeshNames names = namesIn(out);
    refuseTaken(names, out);
    try {
        std::vector<std::string> remarks;
        Progress watched = progress;
        watched.remark = [&](std::string_view line) {
            remarks.emplace_back(line);
            progress.say(line);
        };
        const Made made = make(part.input, names, out, watched);
        tellOfWhatIsLeft(out, made.files, watched);
        writeReport(withRemarks(jsonOf(made.ladder, made.files), remarks), out);
        progress.check();
        const PartStory story = storyOf(made, out);
        out.commit();
        return story;
    } catch (const OperationError& error) {
        throw OperationError(out.publicText(error.what()));
    }
}

}  // namespace

std::unique_ptr<Command> lodCommand() { return std::make_unique<Lod>(); }

}  // namespace isowave::tools
