// make = hold what is thin -> choose the iso-value -> polygonize -> remove specks -> compact -> relax -> cut off at the border -> count -> tell
//        -> where a region keeps a finer level, blend its field in, and the same again from polygonize on
// sampling = polygonize the same field finer -> remove specks -> count
#include "lod/level_mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/number_text.h"
#include "hold/cut_or_fill.h"
#include "hold/hold.h"
#include "hold/limit_level.h"
#include "isowave/error.h"
#include "lod/option_checks.h"
#include "lod/regions/part_handles.h"
#include "lod/simplifier.h"
#include "lod/voxel_edges.h"
#include "polygonize/clip.h"
#include "polygonize/features.h"
#include "polygonize/knot_insertion.h"
#include "polygonize/level_iso.h"
#include "polygonize/polygonize.h"
#include "polygonize/quadric_collapse.h"
#include "polygonize/refit.h"
#include "polygonize/relax.h"

namespace isowave {

SolidCounts countsOf(const MeshTopology& topology) {
    return {topology.parts, topology.genus, topology.cavities};
}

bool needsLevel0(const LevelOptions& options) {
    return options.preserveVolume || options.hold != Holding::none || options.features || options.refit ||
           lod::regionOptionOf(options);
}

namespace lod {
namespace {

constexpr double kPreserved = 1e-4;       // of the volume to keep
constexpr std::int64_t kManyEdits = 40;   // gaps are filled instead
constexpr std::int64_t kMostEdits = 150;  // that nobody asked for: each takes up to half a second
constexpr double kLittle = 0.03;          // of the volume: gaps with so much are filled
constexpr double kHeldVoxels = 1.5;       // walls so thick are held as they are at any place
constexpr int kFinestRefine = 4;          // that polygonize() takes

void checkOptions(const LevelOptions& options, bool openBorder) {
    requireRefine(options.refine.value_or(1));
    requireAtLeast("--relax", options.relax, 0);
    requireAtLeast("--max-genus", options.maxGenus, 0);
    requireAtLeast("--max-parts", options.maxParts, 1);
    if (options.preserveVolume && options.hold == Holding::shift)
        throw UsageError(
            "--preserve-volume and --hold shift exclude each other: each chooses the iso-value of a level");
    if (options.compact && options.refine.value_or(1) == 1)
        throw UsageError("--compact collapses what --refine 2 or 4 adds; give one of them");
    if (options.compact && options.relax > 0)
        throw UsageError(
            "--compact and --relax exclude each other: one keeps the volume, the other goes back to the zero "
            "set");
    if ((options.maxGenus || options.maxParts) && openBorder)
        throw UsageError("--max-genus and --max-parts need closed meshes; leave out --open-border");
    if (options.preserveVolume && openBorder)
        throw UsageError("--preserve-volume needs a closed surface; leave out --open-border");
    if (options.compact) requireSimplifier("--compact");
}

std::int64_t excess(const SolidCounts& now, const SolidCounts& before) {
    const auto more = [](std::int64_t a, std::int64_t b) { return std::max<std::int64_t>(0, a - b); };
    return more(now.parts, before.parts) + more(now.handles, before.handles) +
           more(now.cavities, before.cavities);
}

// An error of 1 is 100 %. "0.31", "12", "150".
std::string percentText(double error) {
    const double percent = 100 * std::abs(error);
    return percent < 99.5 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}
std::string moreOrLess(double error) { return percentText(error) + (error < 0 ? " % less" : " % more"); }

FeatureFate fateOf(const Survival& s, std::int64_t now) {
    return {s.survived,          s.closed,         s.torn, std::max<std::int64_t>(0, now - s.survived),
            s.smallestSurviving, s.largestVanished};
}

}  // namespace

InputTruth InputTruth::of(const InputReport& input) {
    InputTruth truth{input.volume, {}};
    if (input.parts && input.handles && input.cavities)
        truth.counts = {*input.parts, *input.handles, *input.cavities};
    return truth;
}

bool isMore(const SolidCounts& now, const SolidCounts& before) { return excess(now, before) > 0; }

// What the coarser steps are compared with.
struct LevelMesher::Level0 {
    double volume = 0;
    SolidCounts counts;
    std::optional<ThinParts> thin;
    std::optional<SolidFeatures> features;
    std::vector<SurfaceSample> surface;  // for refit
    std::unique_ptr<LevelHold> hold;
};

LevelMesher::LevelMesher(const LevelOptions& options, const StepOrder& order,
                         const std::optional<Border>& openBorder, Facts facts, const InputTruth& truth,
                         const Progress& progress, StageClock& clock)
    : options_(options),
      order_(order),
      openBorder_(openBorder),
      wantsThin_(options.hold == Holding::shift ||
                 (options.hold == Holding::none && facts == Facts::thinToo)),
      facts_(facts),
      truth_(truth),
      progress_(progress),
      clock_(clock) {
    checkOptions(options, openBorder.has_value());
    checkRegions(options);
    if (regionOptionOf(options)) regions_.emplace(options, order, progress);
}

LevelMesher::~LevelMesher() = default;

TriangleMesh LevelMesher::polygonizeAt(const BSplineField& field, double iso, int refine) const {
    return polygonize(field, {.refine = refine, .iso = iso}, progress_);
}

// A mesh on the zero set lies inside where the solid is convex, and coarse triangles cut off corners and tear walls. Finer
// ones do so less, and collapsing them by volumes (Lindstrom and Turk) keeps what they have gained: docs/fidelity.md.
void LevelMesher::compact(TriangleMesh& mesh, int refine, const BSplineField& field, double iso) const {
    if (mesh.triangles.empty()) return;
    const std::int64_t wanted = static_cast<std::int64_t>(mesh.triangles.size()) / (refine * refine);
    if (options_.compact)
        mesh = collapsedByVolume(mesh, wanted, progress_);
    else
        collapseByQuadrics(mesh, {.triangles = wanted}, nullptr, progress_);
    mesh.normals = ZeroSet(field, iso).normalsOf(mesh, progress_);
}

// 0: neither is known.
double LevelMesher::volumeToKeep() const { return truth_.volume.value_or(level0_ ? level0_->volume : 0); }

// The volume without the specks that will be removed.
double LevelMesher::isoPreservingVolume(const LevelMesh& level, double smallest) const {
    const StageClock::Scope scope(clock_, "choose iso");
    const BSplineField& field = level.field;
    const VolumeMatch match = isoOfVolume(
        [&](double iso) {
            return volumeWithoutSpecks(polygonizeAt(field, iso, level.report.refine), smallest);
        },
        volumeToKeep(), kIsoLimit * field.K);
    const double error = match.volume / volumeToKeep() - 1;
    if (std::abs(error) > kPreserved)
        progress_.say(fmt::format("step {}: the volume of {} is out of reach: {:+.3g} % at iso {:+.3g} K",
                                  level.report.step, truth_.volume ? "the input" : "level 0", 100 * error,
                                  match.iso / field.K));
    return match.iso;
}

std::vector<double> LevelMesher::thinValues(const BSplineField& field, int refine) const {
    const StageClock::Scope scope(clock_, "thin parts");
    const openvdb::Vec3d spacing = field.transform().voxelSize();
    if (refine == 1) return level0_->thin->valuesOn(field, spacing, progress_);
    BSplineField fine = field;
    for (int refined = 1; refined < refine; refined *= 2) fine = insertKnots(fine, progress_);
    return level0_->thin->valuesOn(fine, spacing, progress_);
}

void LevelMesher::rememberLevel0(const BSplineField& field, const TriangleMesh& mesh,
                                 const MeshComponents& components, int refine) {
    level0_ = std::make_unique<Level0>();
    if (mesh.triangles.empty()) return;
    level0_->volume = std::accumulate(components.volume.begin(), components.volume.end(), 0.0);
    if (options_.refit) level0_->surface = surfaceSamples(mesh);
    if (options_.hold == Holding::local) {
        const StageClock::Scope scope(clock_, "hold");
        progress_("finding what is thin", 0);
        level0_->hold = std::make_unique<LevelHold>(surfaceOf(mesh, components, field.transform(), refine),
                                                    field, progress_);
    }
    if (wantsThin_) {
        const StageClock::Scope scope(clock_, "thin parts");
        level0_->thin.emplace(field, progress_);
    }
    if (options_.features) {
        const StageClock::Scope scope(clock_, "features");
        FeatureOptions options;
        options.spacing = shortestVoxel(field.transform());
        level0_->features = featuresOf(mesh, options, progress_);
    }
}

// isoDistance: what was added, over the mean of the two areas.
void LevelMesher::putIso(LevelMesh& level, double smallest) const {
    LevelReport& report = level.report;
    report.isoShift = level.iso / level.field.K;
    if (openBorder_) return;
    const MeshTopology& topology = report.topology;
    report.isoDistance = 0;
    report.volumeAtIso0 = topology.volume;
    if (level.iso != 0) {
        TriangleMesh unmoved = polygonizeAt(level.field, 0, report.refine);
        removeSpecks(unmoved, smallest);
        const MeshTopology before = closedTopologyOf(unmoved);
        report.volumeAtIso0 = before.volume;
        const double area = (before.area + topology.area) / 2;
        report.isoDistance = area > 0 ? (topology.volume - before.volume) / area : 0;
    }
    if (volumeToKeep() > 0) report.volumeError = topology.volume / volumeToKeep() - 1;
}

void LevelMesher::putFeatures(LevelMesh& level, const SpeckRemoval& removal) const {
    if (!level0_ || !level0_->features || level.mesh.triangles.empty()) return;
    const SolidFeatures& features = *level0_->features;
    const SolidSurvival survival = survivalOf(features, level.field, level.iso, removal.boxes);
    const SolidCounts now = countsOf(level.report.topology);
    level.report.features = {features.spacing, features.reach, fateOf(survival.parts, now.parts),
                             fateOf(survival.handles, now.handles), fateOf(survival.cavities, now.cavities)};
}

// What is smaller goes.
double LevelMesher::smallestAt(int step, const BSplineField& field) const {
    if (options_.keepSpecks) return 0;
    return step == 0 ? smallest0_ : nodeVolume(field.transform());
}

BSplineField LevelMesher::fieldToDraw(int step, const BSplineField& field) const {
    if (step == 0 || !options_.refit || !level0_) return field;
    const StageClock::Scope scope(clock_, "refit");
    return refitted(field, level0_->surface, {}, progress_);
}

LevelMesh LevelMesher::make(int step, const BSplineField& field) {
    LevelMesh level = whole(step, field);
    if (regions_) addRegions(level);
    return level;
}

// The level without regions.
LevelMesh LevelMesher::whole(int step, const BSplineField& given) {
    Draft draft = chosen(step, fieldToDraw(step, given));
    limit(draft);
    LevelMesh level = completed(std::move(draft));
    if (step == 0 || mustFall(step)) before_ = countsOf(level.report.topology);
    if (step == 0) {
        level0_->counts = *before_;
        tellMended(level.report);
        tellWalls(level.report);
        tellDifference(level.report);
    }
    if (regions_ && regions_->keeps(step)) {
        const StageClock::Scope scope(clock_, "regions");
        regions_->see(drawnBy(level), level.mesh, progress_);
    }
    return level;
}

void LevelMesher::prepare(int step, const BSplineField& field) {
    if (step == 0 || (regions_ && regions_->keeps(step))) {
        whole(step, field);
    } else {
        Draft draft = chosen(step, fieldToDraw(step, field));
        limit(draft);
        if (!draft.level.report.vanished()) before_ = draft.counts();
    }
}

std::vector<int> LevelMesher::stepsBefore(int step) const {
    std::vector<int> all = stepsOf(options_.fine, order_);
    if (needsLevel0()) all.push_back(0);
    if (levelsLimit(options_, openBorder_.has_value()) || options_.adaptive)
        for (int level = 1; order_.stepOf(level) < step; ++level) all.push_back(order_.stepOf(level));
    std::set<int> steps(all.begin(), all.end());
    return {steps.begin(), steps.lower_bound(step)};
}

DrawnLevel LevelMesher::drawnBy(const LevelMesh& level) const {
    const int step = level.report.step;
    return {step, level.field, level.report.refine, smallestAt(step, level.field)};
}

void LevelMesher::addRegions(LevelMesh& level) {
    LevelReport& report = level.report;
    const StageClock::Scope scope(clock_, "regions");
    const DrawnLevel own = drawnBy(level);
    LevelRegions::Choice choice = regions_->choiceFor(own);
    std::optional<RegionBlend> blend;
    SpeckRemoval removal;
    do {
        progress_("blending", 0);
        blend = regions_->blended(own, choice, progress_);
        if (!blend) break;
        removal = drawBlended(level, *blend);
    } while (regions_->widen(choice, level.mesh, progress_));
    if (!blend) {
        if (!choice.asked.empty() && !std::exchange(toldOfRegions_, true))
            progress_.say(fmt::format("step {}: nothing in the regions of --fine differs from a finer level",
                                      report.step));
        return;
    }
    report.regions = blend->summary;
    putRemoval(level, removal, own.smallest);
    level.places = blend->levels.placesOf(level.mesh, progress_);
    const auto count = [&](LocalLevels::Place place) {
        return std::count(level.places.begin(), level.places.end(), place);
    };
    report.regions->trianglesInside = count(LocalLevels::Place::inside);
    report.regions->trianglesFading = count(LocalLevels::Place::fading);
    report.regions->trianglesOutside = count(LocalLevels::Place::outside);
    report.regions->handlesInside = handlesOf(partOf(level.mesh, level.places, true));
    report.regions->handlesOutside = handlesOf(partOf(level.mesh, level.places, false));
    report.regions->handlesOfLevel0 = level0_->counts.handles;
    if (options_.adaptive) tellAdaptive(report, choice.summary);
}

// Silence would mean that the tolerance holds.
void LevelMesher::tellAdaptive(LevelReport& report, const AdaptiveSummary& summary) const {
    report.regions->adaptive = summary;
    if (const std::int64_t lost = level0_->counts.handles - report.topology.genus; lost > 0 && !openBorder_)
        progress_.say(
            fmt::format("step {}: {} fewer than level 0: holes and rings narrower than the tolerance may go",
                        report.step, counted(lost, "handle")));
    if (summary.samplesBeyond == 0) return;
    progress_.say(fmt::format(
        "step {}: {} up to {:.3g} away from level 0, more than the {:.3g} of --adaptive", report.step,
        counted(summary.samplesBeyond, "sample of the surface is", "samples of the surface are"),
        summary.farthest, summary.tolerance));
}

SpeckRemoval LevelMesher::drawBlended(LevelMesh& level, RegionBlend& blend) const {
    level.field = std::move(blend.field);
    level.report.refine = options_.refine.value_or(blend.refine);
    level.mesh = polygonizeAt(level.field, 0, level.report.refine);
    SpeckRemoval removal;
    if (!options_.keepSpecks)
        removal = removeSpecks(level.mesh, blend.levels.smallestAt(level.mesh, progress_));
    blend.levels.collapse(level.mesh, level.report.refine, options_.refine.value_or(1), regions_->deviation(),
                          progress_);
    if (level.mesh.normals.empty())
        level.mesh.normals = ZeroSet(level.field, 0).normalsOf(level.mesh, progress_);
    finish(level);
    return removal;
}

LevelMesher::Draft LevelMesher::chosen(int step, const BSplineField& field) {
    Draft draft = draftedAt(sampled(step, field), step, field);
    int refine = draft.level.report.refine;
    if (options_.hold == Holding::shift) return shifted(std::move(draft), step, field);
    if (!holds(step) || !mustFall(step) || options_.refine || openBorder_) return draft;
    while (refine < kFinestRefine && isMore(draft.counts(), level0_->counts)) {
        Draft finer = draftedAt({refine *= 2}, step, field);
        if (!isMore(draft.counts(), finer.counts())) break;
        draft = std::move(finer);
    }
    return withoutGaps(std::move(draft), step, field);
}

// A gap narrower than the level's voxel closes in some places and not in others, and each opening left is a handle. Where cuts and
// fills would be too many, or the gap holds little, all of it is filled.
LevelMesher::Draft LevelMesher::withoutGaps(Draft draft, int step, const BSplineField& field) {
    const auto tooMany = [&](const Draft& d) { return excess(d.counts(), *before_); };
    const double volume = draft.level.report.topology.volume;
    for (const double closed : {0.5, 1.0}) {
        if (!before_ || tooMany(draft) == 0) break;
        Draft filled = draftedAt({draft.level.report.refine, {}, closed}, step, field);
        const bool isLittle = std::abs(filled.level.report.topology.volume - volume) <= kLittle * volume;
        if (tooMany(filled) < tooMany(draft) && (isLittle || tooMany(draft) > kManyEdits))
            draft = std::move(filled);
    }
    return draft;
}

// What level 0 may have: no more than the input, where it has all of its parts and cavities; where parts have grown together, handles between
// them are no faults of their own. Of a lattice that is too large for faults to be found nothing is asked.
std::optional<SolidCounts> LevelMesher::mendable(const LevelMesh& level) const {
    const LevelReport& report = level.report;
    if (report.step != 0 || options_.hold != Holding::local || !truth_.counts) return {};
    const SolidCounts counts = countsOf(report.topology), input = *truth_.counts;
    const bool lacks = counts.parts < input.parts || counts.cavities < input.cavities;
    if (lacks || excess(counts, input) > kMostEdits || !isSearchedWhole(level.field, report.refine))
        return {};
    return input;
}

// From level to level nothing becomes more, level 0 has no more than the input, and nothing is more than was asked for. What level 0 still
// has too many tellDifference() says.
void LevelMesher::limit(Draft& draft) {
    LevelMesh& level = draft.level;
    LevelReport& report = level.report;
    const bool falls =
        options_.hold == Holding::local && before_ && report.step != 0 && mustFall(report.step);
    const SolidCounts counts = countsOf(report.topology);
    const SolidLimits limits = limitsOf(options_, falls ? before_ : mendable(level));
    if (openBorder_ || report.vanished() || limits.allow(counts)) return;
    const bool asked = options_.maxGenus || options_.maxParts;
    if (falls && !asked && excess(counts, *before_) > kMostEdits) {
        missLimits(report,
                   fmt::format("{} parts, handles and cavities more than the level before, too many to cut "
                               "and fill unasked; "
                               "give --max-genus or --max-parts",
                               excess(counts, *before_)),
                   progress_);
        return;
    }
    if (level.iso != 0) {
        missLimits(report, "cuts and fills are made where the iso-value is 0", progress_);
        return;
    }
    std::string missed;
    {
        const StageClock::Scope scope(clock_, "cut and fill");
        missed = limitLevel(level.field, report.refine, limits, smallestAt(report.step, level.field), report,
                            progress_);
    }
    if (!report.edits.empty()) draw(draft);
    const bool isOwn = report.step == 0 && limitsOf(options_).allow(countsOf(report.topology));
    if (!missed.empty() && !isOwn) missLimits(report, missed, progress_);
}

LevelMesher::Draft LevelMesher::shifted(Draft draft, int step, const BSplineField& field) {
    const int refine = draft.level.report.refine;
    if (step == 0 || openBorder_ || refine == kFinestRefine) return draft;
    Draft finer = draftedAt({2 * refine}, step, field);
    const auto pieces = [](const Draft& d) {
        return d.level.report.topology.components + d.level.report.topology.genus;
    };
    const bool fewer = !finer.level.mesh.triangles.empty() && pieces(finer) < pieces(draft);
    return fewer ? std::move(finer) : std::move(draft);
}

// Level 0 keeps its specks, but those of the fit, which the input does not have.
LevelMesher::Sampled LevelMesher::sampledLevel0(const BSplineField& field) {
    Sampled sampled = sampledAsInput(field);
    if (truth_.counts && !sampled.mesh.triangles.empty()) {
        const SolidCounts counts = countsOf(closedTopologyOf(sampled.mesh));
        const bool more = counts.parts > truth_.counts->parts || counts.cavities > truth_.counts->cavities;
        if (more) smallest0_ = nodeVolume(field.transform());
    }
    return sampled;
}

// The least that gives the input's parts, handles and cavities, and its volume as nearly as a finer one does.
LevelMesher::Sampled LevelMesher::sampledAsInput(const BSplineField& field) const {
    constexpr double kNear = 0.005, kNoNearer = 0.002;  // of the volume
    if (options_.hold != Holding::local || openBorder_ || !truth_.volume) return {};
    const auto isRight = [&](const MeshTopology& t) {
        return !truth_.counts || countsOf(t) == *truth_.counts;
    };
    Sampled now{1, polygonizeAt(field, 0, 1)};
    MeshTopology topology = closedTopologyOf(now.mesh);
    while (now.refine < kFinestRefine) {
        const bool near = std::abs(topology.volume / *truth_.volume - 1) <= kNear;
        if (near && isRight(topology)) return now;
        Sampled finer{2 * now.refine, polygonizeAt(field, 0, 2 * now.refine)};
        const MeshTopology finerTopology = closedTopologyOf(finer.mesh);
        const bool nearer = std::abs(finerTopology.volume - topology.volume) > kNoNearer * *truth_.volume;
        if (!nearer && countsOf(finerTopology) == countsOf(topology)) return now;
        now = std::move(finer);
        topology = finerTopology;
    }
    return now;
}

std::optional<SamplingReport> LevelMesher::sampling(const LevelMesh& level, const SolidCounts& before) const {
    const int step = level.report.step;
    SolidCounts finer = countsOf(level.report.topology);
    int refine = level.report.refine;
    if (step == 0 || openBorder_ || refine == kFinestRefine || level.report.regions || !isMore(finer, before))
        return std::nullopt;
    const StageClock::Scope scope(clock_, "sampling");
    // A lattice point of level 0 and one of this level, refined so often, are equally dense (in the mean of the axes).
    const int finest =
        std::min(kFinestRefine, options_.refine.value_or(1) << std::min(2, step / kStepsPerLevel));
    do {
        refine *= 2;
        TriangleMesh mesh = polygonizeAt(level.field, level.iso, refine);
        removeSpecks(mesh, smallestAt(step, level.field));
        finer = countsOf(closedTopologyOf(mesh));
    } while (isMore(finer, before) && 2 * refine <= finest);
    SamplingReport report{refine, finer, {}};
    if (level0_ && level0_->thin) report.thinKept = shareInside(thinValues(level.field, refine), level.iso);
    return report;
}

// Said at the start: it tells how far down the ladder is worth going.
void LevelMesher::tellWalls(LevelReport& report) const {
    if (!level0_->hold || level0_->hold->samples().empty()) return;
    std::string text;
    const std::vector<double> shares{0.01, 0.05, 0.5};
    const std::vector<Thickness> thickness = thinnest(level0_->hold->samples(), shares);
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const Thickness& t = thickness[i];
        WallThickness wall{shares[i], t.voxels, t.world, {}};
        const double widest = LevelHold::widestVoxelFor(t.voxels);
        if (widest >= 1) wall.heldUpTo = order_.levelOfVoxel(widest);
        report.walls.push_back(wall);
        text += fmt::format("{} {:.3g} ({:.3g} voxels, {})", text.empty() ? "" : ",", wall.world, wall.voxels,
                            wall.heldUpTo ? fmt::format("kept up to level {}", *wall.heldUpTo)
                                          : std::string("thickened at every level"));
    }
    progress_.say("the thinnest 1, 5, 50 % of the walls are" + text);
}

// Silence would mean that level 0 is the fit as it is.
void LevelMesher::tellMended(const LevelReport& report) const {
    if (report.edits.empty() || options_.maxGenus || options_.maxParts) return;
    double volume = 0;
    for (const LevelEdit& edit : report.edits) volume += std::abs(edit.volume);
    progress_.say(fmt::format(
        "level 0: {} ({:.3g} of volume) made, so that it has no more parts, handles and "
        "cavities than the input",
        counted(static_cast<std::int64_t>(report.edits.size()), "cut or fill", "cuts and fills"), volume));
}

// Silence would mean that level 0 is the input.
void LevelMesher::tellDifference(const LevelReport& report) const {
    constexpr double kTold = 0.02;  // of the volume
    if (openBorder_ || !truth_.volume) return;
    const SolidCounts counts = countsOf(report.topology);
    const bool differs = truth_.counts && counts != *truth_.counts;
    const double error = report.topology.volume / *truth_.volume - 1;
    if (!differs && std::abs(error) <= kTold) return;
    const auto text = [](const SolidCounts& c) {
        return fmt::format("{}, {}, {}", counted(c.parts, "part"), counted(c.handles, "handle"),
                           counted(c.cavities, "cavity", "cavities"));
    };
    const double thinnest = report.walls.empty() ? 1.0 : report.walls.front().voxels;
    progress_.say(fmt::format(
        "level 0 is not the input: {}{} volume; voxels {:.2g} times as large would hold it better",
        differs ? text(counts) + " for " + text(*truth_.counts) + ", " : "", moreOrLess(error),
        std::clamp(thinnest / kHeldVoxels, 0.1, 0.5)));
}

// The level before has half the voxel, and so has the same level of a solid with voxels half as large: docs/hold.md has TR12J at both.
// What gains volume first may be nearly gone a level later, which is said by itself.
void LevelMesher::tellVolume(const LevelReport& report) {
    constexpr double kMostlyGone = 0.5;
    if (report.step == 0 || report.vanished() || options_.preserveVolume || !report.volumeError) return;
    const double error = *report.volumeError;
    if (std::abs(error) <= kVolumeTold) return;
    const std::string told = fmt::format("{}: its volume is {} than {}", nameOf(report), moreOrLess(error),
                                         truth_.volume ? "the input's" : "level 0's");
    if (error < -kMostlyGone && !std::exchange(toldOfLoss_, true)) {
        toldOfVolume_ = true;
        progress_.say(told + ": most of the solid is gone; use the levels before it");
    } else if (!std::exchange(toldOfVolume_, true)) {
        progress_.say(
            told +
            fmt::format(", beyond {:.0f} %; the level before it, or voxels half as large, would be nearer",
                        100 * kVolumeTold));
    }
}

double LevelMesher::isoFor(const LevelMesh& level, const std::optional<std::vector<double>>& thin) const {
    double iso = 0;
    if (options_.preserveVolume && volumeToKeep() > 0)
        iso = isoPreservingVolume(level, smallestAt(level.report.step, level.field));
    if (thin && options_.hold == Holding::shift)
        iso = isoThatKeeps(*thin, ThinParts::kShare, kIsoLimit * level.field.K);
    return iso;
}

void LevelMesher::draw(Draft& draft, TriangleMesh ready) {
    const StageClock::Scope scope(clock_, "polygonize");
    LevelMesh& level = draft.level;
    const int step = level.report.step, refine = level.report.refine;
    const bool isReady = level.iso == 0 && !ready.triangles.empty();
    level.mesh = isReady ? std::move(ready) : polygonizeAt(level.field, level.iso, refine);
    MeshComponents components = componentsOf(level.mesh);
    if (step == 0) rememberLevel0(level.field, level.mesh, components, refine);
    draft.removal = removeSpecks(level.mesh, smallestAt(step, level.field), components);
    level.report.topology = closedTopologyOf(level.mesh, components);
}

LevelMesh LevelMesher::completed(Draft draft) const {
    LevelMesh& level = draft.level;
    const int refine = level.report.refine;
    {
        const StageClock::Scope scope(clock_, "polygonize");
        if (compacts(refine)) compact(level.mesh, refine, level.field, level.iso);
        finish(level);
    }
    putRemoval(level, draft.removal, smallestAt(level.report.step, level.field));
    return std::move(draft.level);
}

// What comes last, whatever the mesh was made of.
void LevelMesher::finish(LevelMesh& level) const {
    if (options_.relax > 0) relax(level.mesh, ZeroSet(level.field, level.iso), options_.relax, progress_);
    if (openBorder_)
        level.mesh = clipToBox(level.mesh, openBorder_->worldToIndex, openBorder_->low, openBorder_->high);
    level.report.topology = topologyOf(level.mesh);
}

LevelMesher::Sampled LevelMesher::sampled(int step, const BSplineField& field) {
    if (options_.refine) return {*options_.refine};
    if (step == 0) return sampledLevel0(field);
    return {holds(step) ? level0_->hold->refineFor(field) : 1};
}

bool LevelMesher::compacts(int refine) const { return options_.compact || (!options_.refine && refine > 1); }

// Cuts and fills take seconds a step, and those that only a budget may choose go without.
bool LevelMesher::mustFall(int step) const {
    const bool isLevel = order_.levelOf(step) || options_.steps || facts_ == Facts::few;
    return isLevel && facts_ != Facts::ofBudget;
}

bool LevelMesher::holds(int step) const { return step != 0 && level0_ && level0_->hold; }

void LevelMesher::hold(LevelMesh& level, double closedGaps) const {
    const StageClock::Scope scope(clock_, "hold");
    progress_("holding what is thin", 0);
    LevelReport& report = level.report;
    HoldOptions options;
    options.closedGaps = closedGaps;
    const HoldReport held = level0_->hold->apply(level.field, report.refine, options, progress_);
    const auto share = [&](std::int64_t inside) {
        return held.samples > 0 ? static_cast<double>(inside) / static_cast<double>(held.samples) : 1.0;
    };
    report.thinKept = share(held.inside);
    report.thinKeptAtIso0 = share(held.inside);
    if (held.samples == 0 && held.gaps == 0) return;
    report.hold = {held.samples, held.insideBefore, held.inside, held.thickened,
                   held.gaps,    held.changed,      held.unmet};
}

LevelMesher::Draft LevelMesher::draftedAt(Sampled sampled, int step, const BSplineField& field) {
    Draft draft;
    LevelMesh& level = draft.level;
    LevelReport& report = level.report;
    level.field = field;
    report.step = step;
    report.level = order_.levelOf(step);
    report.refine = sampled.refine;
    if (holds(step)) hold(level, sampled.closedGaps);
    std::optional<std::vector<double>> thin;
    if (step != 0 && level0_ && level0_->volume > 0 && level0_->thin) thin = thinValues(field, report.refine);
    level.iso = isoFor(level, thin);
    draw(draft, std::move(sampled.mesh));
    if (thin) {
        report.thinKept = shareInside(*thin, level.iso);
        report.thinKeptAtIso0 = shareInside(*thin, 0);
    }
    return draft;
}

void LevelMesher::putRemoval(LevelMesh& level, const SpeckRemoval& removal, double smallest) const {
    LevelReport& report = level.report;
    report.specksRemoved = removal.specks;
    report.speckVolume = removal.speckVolume;
    report.bubblesRemoved = removal.bubbles;
    report.bubbleVolume = removal.bubbleVolume;
    putIso(level, smallest);
    putFeatures(level, removal);
}

}  // namespace lod
}  // namespace isowave
