// isowave lod INPUT -o FOLDER: read -> fit -> analyse, polygonizing each wanted step as it passes by, so that
// one field is in memory at a time; then report.json, then everything is put into the folder at once.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <optional>
#include <utility>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "base/heap.h"
#include "simplify/measure.h"
#include "simplify/sample.h"
#include "polygonize/topology.h"
#include "polygonize/zero_set.h"
#include "tools/budgets.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/level_mesh.h"
#include "tools/output.h"
#include "tools/steps.h"

namespace isowave::tools {
namespace {

// Which steps are written, and what their files are called.
constexpr std::int64_t kControlPointsOfOneNode = 4 * 4 * 4;

class Wanted {
  public:
    // budgets: every step is made, but a level is written only where the levels are asked for.
    Wanted(const Settings& settings, std::string name, MeshFormat format, bool budgets)
        : name_(std::move(name)),
          format_(format),
          levels_(!budgets || settings.levels || settings.steps),
          all_(budgets) {
        if (settings.levels && settings.steps)
            throw UsageError("--levels and --steps exclude each other; level L is step 3L");
        bySteps_ = settings.steps.has_value();
        const StepRange range = bySteps_ ? *settings.steps : settings.levels.value_or(StepRange{});
        first_ = range.first * stride();
        if (range.last) last_ = *range.last * stride();
    }

    bool has(int step) const {
        return levels_ && step >= first_ && (!last_ || step <= *last_) && step % stride() == 0;
    }
    // Whether the step is looked at, be it written or not.
    bool visits(int step) const { return all_ || step == 0 || has(step); }
    MeshFormat format() const { return format_; }
    int first() const { return first_; }
    std::optional<int> last() const { return last_; }
    // Of all steps that may be reached.
    std::vector<std::string> fileNames() const {
        std::vector<std::string> names;
        for (int step = first_; step <= std::min(last_.value_or(kMostSteps), kMostSteps); step += stride())
            names.push_back(fileName(step));
        return names;
    }
    std::optional<int> lastVisited() const { return all_ ? std::nullopt : last_; }
    // part_L2.ply, part_s5.ply
    std::string fileName(int step) const {
        return fmt::format("{}_{}{}{}", name_, bySteps_ ? 's' : 'L', step / stride(), extensionOf(format_));
    }

  private:
    // Coordinates have 32 bits, so an axis is halved at most so often.
    static constexpr int kMostSteps = 32 * kStepsPerLevel;

    int stride() const { return bySteps_ ? 1 : kStepsPerLevel; }

    std::string name_;
    MeshFormat format_;
    bool levels_, all_;
    bool bySteps_ = false;
    int first_ = 0;
    std::optional<int> last_;
};

constexpr const char* kReport = "report.json";

// From level 0 to a coarser level, which is far from most of it, the nearest triangle takes long to find: so
// many triangles of level 0, evenly chosen, are enough for an rms to three digits and see every speck of a
// few hundredths of a percent of the surface. In the other direction every vertex and centroid counts.
constexpr std::size_t kReferenceTriangles = 50'000;

// Makes and measures one mesh a step, level 0 first: the others are measured against it.
class Ladder {
  public:
    Ladder(const Wanted& wanted, Budgets& budgets, const Settings& settings, const Solid& solid,
           OutputFolder& out, Console& console, StageClock& clock)
        : wanted_(wanted),
          budgets_(budgets),
          settings_(settings),
          mesher_(settings, solid.openBorder, LevelMesher::Facts::thinToo, console, clock),
          space_(outputSpace(solid, settings)),
          out_(out),
          console_(console),
          clock_(clock) {}

    // REQUIRES: steps in ascending order, step 0 first.
    void visit(int step, const BSplineField& field) {
        if (vanished_ || !wanted_.visits(step)) return;
        const double begin = clock_.secondsSoFar();
        LevelMesh made = mesher_.make(step, field);
        TriangleMesh& mesh = made.mesh;
        vanished_ = mesh.triangles.empty();
        if (wanted_.has(step)) {
            Json level = fieldJson(step, field);
            if (vanished_)
                console_.say(
                    fmt::format("step {}: the whole solid has vanished; the ladder ends before it", step));
            else
                level["file"] = write(step, mesh);
            putTopology(level, made.topology);
            level.update(made.facts);
            const SolidCounts now = countsOf(made.topology), before = counts_.value_or(now);
            level["change"] = changeJson(before, now);
            level["sampling"] = mesher_.sampling(step, made, before);
            counts_ = now;
            measure(level, step, mesh);
            putDeviation(level, made.field, made.iso, mesh);
            level["seconds"] = clock_.secondsSoFar() - begin;
            levels_.push_back(std::move(level));
        }
        if (budgets_.wanted() && !vanished_) budgets_.add(step, field, mesh, made.topology);
        if (step != 0) return;
        empty_ = vanished_;
        counts_ = countsOf(made.topology);
        reference_ = std::move(mesh);
        reference_.normals = {};
    }

    bool empty() const { return empty_; }
    const Json& levels() const { return levels_; }

  private:
    static Json fieldJson(int step, const BSplineField& field) {
        Json json;
        json["step"] = step;
        json["level"] = step % kStepsPerLevel == 0 ? Json(step / kStepsPerLevel) : Json(nullptr);
        json["file"] = nullptr;
        json["spacing"] = triple(field.transform().voxelSize());
        json["control_points"] = field.controlPointCount();
        json["nodes"] = definedNodeCount(field);
        json["leaf_occupancy"] = leafOccupancyOf(*field.shape);
        json["memory_bytes"] = bytesOf(field);
        return json;
    }

    std::string write(int step, const TriangleMesh& mesh) {
        const StageClock::Scope scope(clock_, "write");
        const std::string name = wanted_.fileName(step);
        writeMesh(out_.place(name), mesh, wanted_.format(), {.space = space_});
        console_.progress().check();
        return name;
    }

    void measure(Json& json, int step, const TriangleMesh& mesh) {
        const StageClock::Scope scope(clock_, "measure");
        OneSidedDistance to, from;
        if (step != 0 && !mesh.triangles.empty()) {
            if (!target_) {
                releaseFreedMemory();  // leaves were made and dropped until here; now come large arrays
                sample_ = everyFew(reference_, kReferenceTriangles);
                target_.emplace(std::exchange(reference_, {}));
            }
            to = target_->sampledDistanceFrom(mesh, 0, console_.progress());
            from = DistanceTarget(mesh).sampledDistanceFrom(sample_, 0, console_.progress());
        }
        const bool known = !mesh.triangles.empty();
        json["rms_to_level0"] = known ? finite(to.rms) : Json(nullptr);
        json["max_to_level0"] = known ? finite(to.max) : Json(nullptr);
        json["rms_from_level0"] = known ? finite(from.rms) : Json(nullptr);
        json["max_from_level0"] = known ? finite(from.max) : Json(nullptr);
    }

    // null unless asked for: it takes as long as polygonizing several times over.
    void putDeviation(Json& json, const BSplineField& field, double iso, const TriangleMesh& mesh) {
        const StageClock::Scope scope(clock_, "measure");
        const bool known = settings_.deviation && !mesh.triangles.empty();
        const Deviation deviation =
            known ? deviationFrom(ZeroSet(field, iso), mesh, console_.progress()) : Deviation{};
        json["max_deviation"] = known ? finite(deviation.max) : Json(nullptr);
        json["rms_deviation"] = known ? finite(deviation.rms) : Json(nullptr);
    }

    const Wanted& wanted_;
    Budgets& budgets_;
    const Settings& settings_;
    LevelMesher mesher_;
    Space space_;
    OutputFolder& out_;
    Console& console_;
    StageClock& clock_;
    TriangleMesh reference_;                // level 0, until it is first measured against
    TriangleMesh sample_;                   // then some of its triangles
    std::optional<DistanceTarget> target_;  // and all of them
    std::optional<SolidCounts> counts_;     // of the level before in the report, or of step 0
    bool vanished_ = false, empty_ = true;
    Json levels_ = Json::array();
};

// Passes every step by the ladder; says what the pyramid stores.
struct PyramidCounts {
    int steps = 0;
    std::int64_t coefficientsStored = 0, controlPoints = 0, coarsestControlPoints = 0;
};

PyramidCounts climb(Solid solid, const Wanted& wanted, Ladder& ladder, const std::string& name,
                    Console& console, StageClock& clock) {
    PyramidCounts counts;
    if (!solid.pyramid) {
        const StageClock::Scope scope(clock, "analyse");
        wavelets::AnalyseOptions options;
        if (wanted.lastVisited()) options.maxSteps = *wanted.lastVisited();
        counts.controlPoints = solid.field->controlPointCount();
        const wavelets::Descent descent =
            wavelets::descend(*std::exchange(solid.field, {}), options, console.progress(),
                              [&](int step, const BSplineField& field) { ladder.visit(step, field); });
        counts.steps = descent.steps;
        counts.coefficientsStored = descent.coefficientsStored;
        counts.coarsestControlPoints = descent.coarsest.controlPointCount();
    } else {
        const StageClock::Scope scope(clock, "synthesise");
        const wavelets::Pyramid& pyramid = *solid.pyramid;
        for (int step = 0; step <= pyramid.stepCount(); ++step)
            if (wanted.visits(step)) ladder.visit(step, pyramid.field(step, console.progress()));
        counts = {pyramid.stepCount(), pyramid.coefficientsStored(), finestControlPoints(pyramid),
                  pyramid.coarsest.controlPointCount()};
    }
    if (ladder.empty()) throw InputError(name, "has no surface; nothing to polygonize");
    if (wanted.first() > counts.steps)
        throw InputError(name, fmt::format("has steps 0 to {} (levels 0 to {}), not step {}", counts.steps,
                                           counts.steps / kStepsPerLevel, wanted.first()));
    if (wanted.last() && *wanted.last() > counts.steps)
        console.say(fmt::format("{}: {} step {}", name,
                                counts.coarsestControlPoints == kControlPointsOfOneNode
                                    ? "one node is left; the ladder ends at"
                                    : "the ladder ends at",
                                counts.steps));
    return counts;
}

std::string numberOf(const Json& json) {
    if (json.is_null()) return "-";
    return json.is_number_integer() ? grouped(json.get<std::int64_t>()) : shortNumber(json.get<double>());
}

std::string levelsText(const Json& report, const std::string& unit) {
    if (report["levels"].empty()) return {};
    Table table({"file", "step", "voxel" + unit, "control points", "triangles", "components", "genus",
                 unit.empty() ? "volume" : "volume [mm^3]", "rms to level 0" + unit, "max to level 0" + unit,
                 "closed"});
    for (const Json& level : report["levels"]) {
        table.row({level["file"].is_null() ? "(vanished)" : level["file"].get<std::string>(),
                   numberOf(level["step"]), voxelText(level["spacing"]), numberOf(level["control_points"]),
                   numberOf(level["triangles"]), numberOf(level["components"]), numberOf(level["genus"]),
                   numberOf(level["volume"]), numberOf(level["rms_to_level0"]),
                   numberOf(level["max_to_level0"]),
                   level["closed"].get<bool>() && level["manifold"].get<bool>() ? "yes" : "no"});
    }
    std::string stories;
    for (const Json& level : report["levels"])
        if (level["step"] != 0 && !level["file"].is_null())
            stories += storyText(level, unit.empty() ? "" : " mm") + "\n";
    return table.text() + stories;
}

std::string tableOf(const Json& report, const std::string& unit) {
    const std::string budgets = report["budgets"].empty() ? "" : Budgets::tableOf(report["budgets"], unit);
    const double ratio = report["coefficients_stored"].get<double>() / report["control_points"].get<double>();
    return levelsText(report, unit) + budgets +
           fmt::format("{} coefficients stored for {} control points (x{:.3f})\n",
                       numberOf(report["coefficients_stored"]), numberOf(report["control_points"]), ratio);
}

}  // namespace

int runLod(const Settings& settings, Console& console) {
    StageClock clock;
    OutputFolder out(*settings.output, Inputs(settings.files));
    const MeshFormat format = settings.format.value_or(MeshFormat::ply);
    Budgets budgets(settings, out.name(), format);
    const Wanted wanted(settings, out.name(), format, budgets.wanted());
    const bool toStdout = settings.jsonFile == "-";
    if (settings.jsonFile && !toStdout) out.keepFree(*settings.jsonFile);
    out.refuseTaken(kReport);
    for (const std::string& file : wanted.fileNames()) out.refuseTaken(file);
    for (const std::string& file : budgets.fileNames()) out.refuseTaken(file);
    const std::string name = settings.files[0].string();
    std::optional<AtomicFile> copy;  // opened now: a report that cannot be written is no surprise at the end
    if (settings.jsonFile && !toStdout) copy.emplace(*settings.jsonFile);
    try {
        Solid solid = loadSolid(settings.files[0], settings, console, clock);
        const Space space = outputSpace(solid, settings);

        Json report;
        report["version"] = 1;
        report["input"] = solid.input;
        report["fit"] = solid.fit;
        report["K"] = solid.K();
        Ladder ladder(wanted, budgets, settings, solid, out, console, clock);
        const PyramidCounts counts = climb(std::move(solid), wanted, ladder, name, console, clock);
        report["levels"] = ladder.levels();
        report["budgets"] =
            budgets.wanted() ? budgets.write(out, space, name, console, clock) : Json(Json::array());
        report["steps"] = counts.steps;
        report["coefficients_stored"] = counts.coefficientsStored;
        report["control_points"] = counts.controlPoints;
        report["seconds"] = clock.seconds();
        report["peak_memory_bytes"] = peakMemoryBytes();
        report["threads"] = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);

        // What can fail for want of room comes first; then only names change.
        AtomicFile file(out.place(kReport));
        writeJson(file, report);
        file.commit();
        if (copy) writeJson(*copy, report);
        console.progress().check();
        console.print(toStdout ? textOf(report)
                               : tableOf(report, space == Space::unspecified ? "" : " [mm]"));
        console.flush();
        out.commit();
        if (copy) copy->commit();
    } catch (const OperationError& error) {
        throw OperationError(out.publicText(error.what()));
    }
    return 0;
}

}  // namespace isowave::tools
