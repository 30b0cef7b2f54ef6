// open -> analyse, making each wanted step's mesh as it passes by, so that one field is in memory at a time -> budgets.
#include "isowave/ladder.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <utility>

#include "base/peak_memory.h"
#include "isowave/error.h"
#include "lod/budgets.h"
#include "lod/field_state.h"
#include "lod/fit_solid.h"
#include "lod/level_mesher.h"
#include "lod/pyramid_state.h"
#include "lod/source.h"
#include "lod/step_choice.h"
#include "lod/steps.h"
#include "polygonize/zero_set.h"

namespace isowave {
namespace lod {
namespace {

constexpr std::int64_t kControlPointsOfOneNode = 4 * 4 * 4;

void putField(LevelReport& report, const BSplineField& field) {
    const openvdb::Vec3d spacing = field.transform().voxelSize();
    report.spacing = {spacing.x(), spacing.y(), spacing.z()};
    report.controlPoints = field.controlPointCount();
    report.nodes = definedNodeCount(field);
    report.leafOccupancy = leafOccupancyOf(*field.shape);
    report.memoryBytes = bytesOf(field);
}

void putChange(LevelReport& report, const SolidCounts& before) {
    const SolidCounts now = countsOf(report.topology);
    report.change = {now.parts - before.parts, now.handles - before.handles, now.cavities - before.cavities};
}

// Takes as long as polygonizing several times over.
void putDeviation(LevelReport& report, const LevelMesh& level, const Progress& progress) {
    const Deviation deviation = deviationFrom(ZeroSet(level.field, level.iso), level.mesh, progress);
    report.maxDeviation = deviation.max;
    report.rmsDeviation = deviation.rms;
}

// A pyramid's input is the solid that it was made of.
InputTruth truthOf(const Solid& solid) {
    const InputReport& input = solid.input();
    return InputTruth::of(input.madeFrom ? *input.madeFrom : input);
}

// Of a mesh as read, and of the one that a pyramid was made of.
std::optional<std::int64_t> trianglesOf(const Solid& solid) {
    const InputReport& input = solid.input();
    return input.madeFrom ? input.madeFrom->triangles : input.triangles;
}

// Makes and measures one mesh a step, level 0 first: the others are measured against it.
class Maker {
  public:
    Maker(const StepChoice& choice, Budgets& budgets, const LevelOptions& options, const StepOrder& order,
          const std::optional<Border>& openBorder, const InputTruth& truth,
          std::shared_ptr<const TriangleMesh> input, const LadderVisitor& visitor, const Progress& progress,
          StageClock& clock)
        : choice_(choice),
          budgets_(budgets),
          deviation_(options.deviation),
          mesher_(options, order, openBorder,
                  budgets.wanted() && !options.levels && !options.steps ? LevelMesher::Facts::ofBudget
                                                                        : LevelMesher::Facts::thinToo,
                  truth, progress, clock),
          input_(std::move(input)),
          visitor_(visitor),
          progress_(progress),
          clock_(clock) {}

    // REQUIRES: steps in ascending order, step 0 first.
    void visit(int step, const BSplineField& field) {
        if (vanished_ || !choice_.visits(step)) return;
        const double begin = clock_.secondsSoFar();
        if (step != 0 && !choice_.has(step) && !budgets_.wanted()) return mesher_.prepare(step, field);
        LevelMesh made = mesher_.make(step, field);
        vanished_ = made.mesh.triangles.empty();
        if (step == 0) {
            empty_ = vanished_;
            counts_ = countsOf(made.report.topology);
        }
        if (choice_.has(step)) {
            if (vanished_)
                progress_.say(
                    fmt::format("step {}: the whole solid has vanished; the ladder ends before it", step));
            tell(made, field);
            handOn(made, begin);
        }
        if (budgets_.wanted() && !vanished_) budgets_.add(step, field, made.mesh, made.report.topology);
        if (step == 0)
            keepReference(std::move(made.mesh));
        else if (!levels_.empty() && !visitor_.level && choice_.has(step))
            levels_.back().mesh = std::move(made.mesh);
    }

    bool empty() const { return empty_; }
    std::vector<Level> takeLevels() { return std::move(levels_); }

  private:
    void tell(LevelMesh& made, const BSplineField& field) {
        LevelReport& report = made.report;
        putField(report, field);
        putChange(report, counts_);
        if (visitor_.level && !vanished_) clock_.announce("write");
        report.sampling = mesher_.sampling(made, counts_);
        counts_ = countsOf(report.topology);
        const StageClock::Scope scope(clock_, "measure");
        if (vanished_) return;
        mesher_.tellVolume(report);
        putDistances(report, made.mesh);
        putRegionDistances(report, made);
        if (report.step == 0) putInputDistance(report, made.mesh);
        if (deviation_) putDeviation(report, made, progress_);
    }

    void putDistances(LevelReport& report, const TriangleMesh& mesh) {
        ReferenceSurface::Distances distances;
        if (report.step != 0) {
            if (!canMeasureDistances()) return;
            if (!target_) {
                if (visitor_.beforeMeasuring) visitor_.beforeMeasuring();
                target_ = makeReferenceSurface(std::exchange(reference_, {}));
            }
            distances = target_->distances(mesh, progress_);
        }
        report.rmsToLevel0Error = distances.toReference.rmsError;
        report.rmsFromLevel0Error = distances.fromReference.rmsError;
        report.rmsToLevel0 = distances.toReference.rms;
        report.maxToLevel0 = distances.toReference.max;
        report.rmsFromLevel0 = distances.fromReference.rms;
        report.maxFromLevel0 = distances.fromReference.max;
    }

    // REQUIRES: putDistances() before.
    void putRegionDistances(LevelReport& report, const LevelMesh& made) const {
        if (!report.regions || !target_) return;
        RegionSummary& regions = *report.regions;
        const auto measure = [&](bool inside, std::optional<double>& rms, std::optional<double>& max) {
            const TriangleMesh part = partOf(made.mesh, made.places, inside);
            if (part.triangles.empty()) return;
            const OneSidedDistance distance = target_->distanceFrom(part, progress_);
            rms = distance.rms, max = distance.max;
        };
        measure(true, regions.rmsInside, regions.maxInside);
        measure(false, regions.rmsOutside, regions.maxOutside);
    }

    void putInputDistance(LevelReport& report, const TriangleMesh& level0) {
        if (!input_ || !canMeasureDistances()) return;
        target_ = makeReferenceSurface({level0.points, level0.triangles, {}});
        const ReferenceSurface::Distances found = target_->distances(*input_, progress_);
        report.toInput = {found.fromReference.rms, found.fromReference.max, found.toReference.rms,
                          found.toReference.max};
        input_.reset();
    }

    void handOn(LevelMesh& made, double begin) {
        LevelReport& report = made.report;
        report.seconds = clock_.secondsSoFar() - begin;
        if (visitor_.level && !vanished_) {
            const StageClock::Scope scope(clock_, "write");
            progress_("writing", 0);
            visitor_.level(report, made.mesh);
            progress_.check();
            report.seconds = clock_.secondsSoFar() - begin;
        }
        levels_.push_back({report, {}});
    }

    void keepReference(TriangleMesh mesh) {
        if (!visitor_.level && !levels_.empty()) levels_.back().mesh = mesh;
        if (target_) return;
        reference_ = std::move(mesh);
        reference_.normals = {};
    }

    const StepChoice& choice_;
    Budgets& budgets_;
    bool deviation_;
    LevelMesher mesher_;
    std::shared_ptr<const TriangleMesh> input_;  // until level 0 is measured against it
    const LadderVisitor& visitor_;
    const Progress& progress_;
    StageClock& clock_;
    TriangleMesh reference_;                    // level 0, until it is first measured against
    std::unique_ptr<ReferenceSurface> target_;  // from then on
    SolidCounts counts_;                        // of the level before in the report, or of step 0
    bool vanished_ = false, empty_ = true;
    std::vector<Level> levels_;
};

// Passes every step by the maker; says what the pyramid stores.
struct PyramidCounts {
    int steps = 0;
    std::int64_t coefficientsStored = 0, controlPoints = 0, coarsestControlPoints = 0;
};

std::int64_t controlPointsOf(const Solid& solid) {
    const Solid::State& state = SolidAccess::of(solid);
    return state.slabs ? state.slabs->extent().controlPoints : state.field->controlPointCount();
}

PyramidCounts descendSolid(Solid solid, const StepChoice& choice, Maker& maker, const Progress& progress,
                           StageClock& clock) {
    const StageClock::Scope scope(clock, "analyse");
    wavelets::AnalyseOptions options{.order = solid.order()};
    if (choice.lastVisited()) options.maxSteps = *choice.lastVisited();
    PyramidCounts counts;
    counts.controlPoints = controlPointsOf(solid);
    const wavelets::Descent descent = lod::descendFrom(
        std::move(solid), options, [&](int step) { return choice.visits(step); },
        [&](int step, const BSplineField& f) { maker.visit(step, f); }, progress);
    counts.steps = descent.steps;
    counts.coefficientsStored = descent.coefficientsStored;
    counts.coarsestControlPoints = descent.coarsest.controlPointCount();
    return counts;
}

PyramidCounts walk(const wavelets::Pyramid& pyramid, const std::string& name, const StepChoice& choice,
                   Maker& maker, const Progress& progress, StageClock& clock) {
    const StageClock::Scope scope(clock, "synthesise");
    for (int step = 0; step <= pyramid.stepCount(); ++step)
        if (choice.visits(step)) maker.visit(step, fieldOf(pyramid, step, name, progress));
    return {pyramid.stepCount(), pyramid.coefficientsStored(), finestControlPoints(pyramid),
            pyramid.coarsest.controlPointCount()};
}

PyramidCounts climb(Solid solid, const StepChoice& choice, Maker& maker, const Progress& progress,
                    StageClock& clock) {
    const std::string name = solid.input().path;
    const StepOrder order = solid.order();
    const auto& pyramid = SolidAccess::of(solid).pyramid;
    const PyramidCounts counts = pyramid ? walk(*pyramid, name, choice, maker, progress, clock)
                                         : descendSolid(std::move(solid), choice, maker, progress, clock);
    if (maker.empty()) throw InputError(name, "has no surface; nothing to polygonize");
    if (choice.first() > counts.steps)
        throw InputError(name, tooFarText(choice.first(), counts.steps, order));
    if (choice.lastKept() >= counts.steps)
        throw InputError(name,
                         fmt::format("the ladder ends at step {}, and no level is coarser than level {}, "
                                     "which a region of --fine keeps; give it a finer one",
                                     counts.steps, order.levelUpTo(choice.lastKept())));
    if (choice.last() && *choice.last() > counts.steps)
        progress.say(fmt::format("{}: {} step {}", name,
                                 counts.coarsestControlPoints == kControlPointsOfOneNode
                                     ? "one node is left; the ladder ends at"
                                     : "the ladder ends at",
                                 counts.steps));
    return counts;
}

}  // namespace
}  // namespace lod

Ladder makeLadder(Solid solid, const LevelOptions& options, const LadderVisitor& visitor,
                  const Progress& progress) {
    return makeBudget(std::move(solid), {}, options, visitor, progress);
}

Ladder makeBudget(Solid solid, const BudgetOptions& budgetOptions, const LevelOptions& options,
                  const LadderVisitor& visitor, const Progress& progress) {
    lod::requireNoRegions(budgetOptions, options);
    const Solid::State& state = SolidAccess::of(solid);
    StageClock clock(state.stages, state.seconds);
    const std::optional<lod::Border> border = state.openBorder;
    lod::checkBudgets(budgetOptions, border.has_value());
    const StepOrder order = solid.order();
    lod::Budgets budgets(budgetOptions, lod::trianglesOf(solid), state.surface, order);
    const lod::StepChoice choice(options, budgets.wanted(), lod::levelsLimit(options, border.has_value()),
                                 order);
    lod::Maker maker(choice, budgets, options, order, border, lod::truthOf(solid), state.surface, visitor,
                     progress, clock);
    Ladder ladder;
    ladder.input = solid.input();
    ladder.fit = solid.fit();
    ladder.K = solid.K();
    ladder.order = order;
    const lod::PyramidCounts counts = lod::climb(std::move(solid), choice, maker, progress, clock);
    ladder.levels = maker.takeLevels();
    if (budgets.wanted()) ladder.budgets = budgets.make(ladder.input.path, visitor, progress, clock);
    ladder.steps = counts.steps;
    ladder.coefficientsStored = counts.coefficientsStored;
    ladder.controlPoints = counts.controlPoints;
    ladder.seconds = clock.stages();
    ladder.totalSeconds = clock.secondsSoFar();
    ladder.peakMemoryBytes = peakMemoryBytes();
    ladder.threads = static_cast<std::int64_t>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    return ladder;
}

namespace {

// What to take instead of a step at which nothing is left. Coarse fields of a pyramid are small; of another solid each would have to be
// made from level 0.
std::string vanishedText(const Solid& solid, int step, const Progress& progress) {
    const Solid::State& state = SolidAccess::of(solid);
    const std::string gone = fmt::format("the whole solid has vanished at step {}; ", step);
    for (int before = step - 1; state.pyramid && before >= 0; --before) {
        if (!lod::hasSurface(lod::fieldOf(*state.pyramid, before, solid.input().path, progress))) continue;
        const std::optional<int> level = state.order.levelOf(before);
        return gone + fmt::format("take step {}{} or an earlier one", before,
                                  level ? fmt::format(" (level {})", *level) : "");
    }
    return gone + "take a smaller one";
}

// One step as the ladder has it.
lod::LevelMesh levelMeshOf(Solid solid, int step, const LevelOptions& options, const Progress& progress) {
    const std::string name = solid.input().path;
    const Solid::State& state = SolidAccess::of(solid);
    StageClock clock(state.stages, state.seconds);
    const double begin = clock.secondsSoFar();
    lod::LevelMesher mesher(options, state.order, state.openBorder, lod::LevelMesher::Facts::few,
                            lod::truthOf(solid), progress, clock);
    if (const char* option = lod::regionOptionOf(options); option && !state.order.levelOf(step))
        throw UsageError(fmt::format("{} needs a level: step {} is between two", option, step));
    const BSplineField field = lod::fieldAtStep(solid, step, progress, clock);
    for (const int before : mesher.stepsBefore(step))
        mesher.prepare(before, lod::fieldAtStep(solid, before, progress, clock));
    lod::LevelMesh made = mesher.make(step, field);
    if (made.mesh.triangles.empty()) throw InputError(name, vanishedText(solid, step, progress));
    mesher.tellVolume(made.report);
    lod::putField(made.report, field);
    if (options.deviation) lod::putDeviation(made.report, made, progress);
    made.report.seconds = clock.secondsSoFar() - begin;
    return made;
}

}  // namespace

Level makeLevel(Solid solid, int step, const LevelOptions& options, const Progress& progress) {
    lod::LevelMesh made = levelMeshOf(std::move(solid), step, options, progress);
    return {std::move(made.report), std::move(made.mesh)};
}

Field makeLevelField(Solid solid, int step, const LevelOptions& options, const Progress& progress) {
    if (options.hold == Holding::shift || options.preserveVolume)
        throw UsageError(
            "a level that is moved as a whole is not the zero set of a field; hold locally or not at all");
    return FieldAccess::make(levelMeshOf(std::move(solid), step, options, progress).field);
}

std::vector<LevelReport> describeLevels(const Pyramid& pyramid, const LevelOptions& options,
                                        const Progress& progress) {
    StageClock clock;
    const auto input = lod::inputOfSource(PyramidAccess::of(pyramid).source);
    lod::LevelMesher mesher(options, pyramid.order(), std::nullopt, lod::LevelMesher::Facts::few,
                            input ? lod::InputTruth::of(*input) : lod::InputTruth{}, progress, clock);
    std::vector<LevelReport> reports;
    SolidCounts before;
    for (int l = 0, step = 0; step <= pyramid.stepCount(); step = pyramid.order().stepOf(++l)) {
        const BSplineField field = PyramidAccess::of(pyramid).field(step, progress);
        lod::LevelMesh level = mesher.make(step, field);
        if (level.mesh.triangles.empty()) break;
        if (step == 0) before = countsOf(level.report.topology);
        lod::putField(level.report, field);
        lod::putChange(level.report, before);
        level.report.sampling = mesher.sampling(level, before);
        before = countsOf(level.report.topology);
        reports.push_back(std::move(level.report));
    }
    return reports;
}

}  // namespace isowave
