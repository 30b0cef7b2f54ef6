// make = choose the iso-value -> polygonize -> remove specks -> compact -> relax -> cut off at the border -> count -> tell
// sampling = polygonize the same field finer -> remove specks -> count
#include "lod/level_mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hold/limit_level.h"
#include "isowave/error.h"
#include "lod/simplifier.h"
#include "polygonize/clip.h"
#include "polygonize/features.h"
#include "polygonize/knot_insertion.h"
#include "polygonize/level_iso.h"
#include "polygonize/polygonize.h"
#include "polygonize/refit.h"
#include "polygonize/relax.h"

namespace isowave {

SolidCounts countsOf(const MeshTopology& topology) {
    return {topology.parts, topology.genus, topology.cavities};
}

bool needsLevel0(const LevelOptions& options) {
    return options.preserveVolume || options.protectThin || options.features || options.refit;
}

namespace lod {
namespace {

constexpr double kPreserved = 1e-4;  // of level 0's volume
constexpr int kFinestRefine = 4;     // that polygonize() takes

void checkOptions(const LevelOptions& options, bool openBorder) {
    if (options.preserveVolume && options.protectThin)
        throw UsageError(
            "--preserve-volume and --protect-thin exclude each other: each chooses the iso-value of a level");
    if (options.compact && options.refine == 1)
        throw UsageError("--compact collapses what --refine 2 or 4 adds; give one of them");
    if (options.compact && options.relax > 0)
        throw UsageError(
            "--compact and --relax exclude each other: one keeps the volume, the other goes back to the zero "
            "set");
    if (options.preserveVolume && openBorder)
        throw UsageError("--preserve-volume needs a closed surface; leave out --open-border");
    if (options.compact) requireSimplifier("--compact");
}

FeatureFate fateOf(const Survival& s, std::int64_t now) {
    return {s.survived,          s.closed,         s.torn, std::max<std::int64_t>(0, now - s.survived),
            s.smallestSurviving, s.largestVanished};
}

}  // namespace

bool isMore(const SolidCounts& now, const SolidCounts& before) {
    return now.parts > before.parts || now.handles > before.handles || now.cavities > before.cavities;
}

// What the coarser steps are compared with.
struct LevelMesher::Level0 {
    double volume = 0;
    std::optional<ThinParts> thin;
    std::optional<SolidFeatures> features;
    std::vector<SurfaceSample> surface;  // for refit
};

LevelMesher::LevelMesher(const LevelOptions& options, const std::optional<Border>& openBorder, Facts facts,
                         const Progress& progress, StageClock& clock)
    : options_(options),
      openBorder_(openBorder),
      wantsThin_(options.protectThin || facts == Facts::thinToo),
      progress_(progress),
      clock_(clock) {
    checkOptions(options, openBorder.has_value());
}

LevelMesher::~LevelMesher() = default;

TriangleMesh LevelMesher::polygonizeAt(const BSplineField& field, double iso, int refine) const {
    return polygonize(field, {.refine = refine, .iso = iso}, progress_);
}

// A mesh on the zero set lies inside where the solid is convex, and coarse triangles cut off corners and tear walls. Finer
// ones do so less, and collapsing them by volumes (Lindstrom and Turk) keeps what they have gained: docs/fidelity.md.
void LevelMesher::compact(TriangleMesh& mesh, int refine, const BSplineField& field, double iso) const {
    if (mesh.triangles.empty()) return;
    const auto finer = static_cast<std::int64_t>(refine) * refine;
    const bool normals = !mesh.normals.empty();
    mesh = collapsedByVolume(mesh, static_cast<std::int64_t>(mesh.triangles.size()) / finer, progress_);
    if (normals) mesh.normals = ZeroSet(field, iso).normalsOf(mesh, progress_);
}

// The volume without the specks that will be removed.
double LevelMesher::isoPreservingVolume(int step, const BSplineField& field, double smallest) const {
    const StageClock::Scope scope(clock_, "choose iso");
    const VolumeMatch match = isoOfVolume(
        [&](double iso) { return volumeWithoutSpecks(polygonizeAt(field, iso, options_.refine), smallest); },
        level0_->volume, kIsoLimit * field.K);
    const double error = match.volume / level0_->volume - 1;
    if (std::abs(error) > kPreserved)
        progress_.say(
            fmt::format("step {}: the volume of level 0 is out of reach: {:+.3g} % at iso {:+.3g} K", step,
                        100 * error, match.iso / field.K));
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

void LevelMesher::rememberLevel0(const BSplineField& field, const TriangleMesh& mesh) {
    level0_ = std::make_unique<Level0>();
    if (mesh.triangles.empty()) return;
    level0_->volume = volumeWithoutSpecks(mesh, 0);
    if (options_.refit) level0_->surface = surfaceSamples(mesh);
    if (wantsThin_) {
        const StageClock::Scope scope(clock_, "thin parts");
        level0_->thin.emplace(field, progress_);
    }
    if (options_.features) {
        const StageClock::Scope scope(clock_, "features");
        const openvdb::Vec3d spacing = field.transform().voxelSize();
        FeatureOptions options;
        options.spacing = std::min({spacing[0], spacing[1], spacing[2]});
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
        const MeshTopology before = topologyOf(unmoved);
        report.volumeAtIso0 = before.volume;
        const double area = (before.area + topology.area) / 2;
        report.isoDistance = area > 0 ? (topology.volume - before.volume) / area : 0;
    }
    if (level0_ && level0_->volume > 0) report.volumeError = topology.volume / level0_->volume - 1;
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
    return step == 0 || options_.keepSpecks ? 0 : nodeVolume(field.transform());
}

BSplineField LevelMesher::fieldToDraw(int step, const BSplineField& field) const {
    if (step == 0 || !options_.refit || !level0_) return field;
    const StageClock::Scope scope(clock_, "refit");
    return refitted(field, level0_->surface, {}, progress_);
}

LevelMesh LevelMesher::make(int step, const BSplineField& given) {
    const BSplineField field = fieldToDraw(step, given);
    LevelMesh level = madeAt(options_.refine, step, field);
    if (step == 0 || !options_.protectThin || openBorder_ || options_.refine == kFinestRefine) return level;
    LevelMesh finer = madeAt(2 * options_.refine, step, field);
    const auto pieces = [](const LevelMesh& l) {
        return l.report.topology.components + l.report.topology.genus;
    };
    const bool fewer = !finer.mesh.triangles.empty() && pieces(finer) < pieces(level);
    return fewer ? std::move(finer) : std::move(level);
}

std::optional<SamplingReport> LevelMesher::sampling(const LevelMesh& level, const SolidCounts& before) const {
    const int step = level.report.step;
    SolidCounts finer = countsOf(level.report.topology);
    int refine = level.report.refine;
    if (step == 0 || openBorder_ || refine == kFinestRefine || !isMore(finer, before)) return std::nullopt;
    const StageClock::Scope scope(clock_, "sampling");
    // A lattice point of level 0 and one of this level, refined so often, are equally dense.
    const int finest = std::min(kFinestRefine, options_.refine << std::min(2, step / kStepsPerLevel));
    do {
        refine *= 2;
        TriangleMesh mesh = polygonizeAt(level.field, level.iso, refine);
        removeSpecks(mesh, smallestAt(step, level.field));
        finer = countsOf(topologyOf(mesh));
    } while (isMore(finer, before) && 2 * refine <= finest);
    SamplingReport report{refine, finer, {}};
    if (level0_ && level0_->thin) report.thinKept = shareInside(thinValues(level.field, refine), level.iso);
    return report;
}

double LevelMesher::isoFor(int step, const BSplineField& field,
                           const std::optional<std::vector<double>>& thin) const {
    double iso = 0;
    if (step != 0 && level0_ && level0_->volume > 0 && options_.preserveVolume)
        iso = isoPreservingVolume(step, field, smallestAt(step, field));
    if (thin && options_.protectThin) iso = isoThatKeeps(*thin, ThinParts::kShare, kIsoLimit * field.K);
    return iso;
}

SpeckRemoval LevelMesher::draw(LevelMesh& level, double smallest) {
    const StageClock::Scope scope(clock_, "polygonize");
    const int refine = level.report.refine;
    level.mesh = polygonizeAt(level.field, level.iso, refine);
    if (level.report.step == 0) rememberLevel0(level.field, level.mesh);
    SpeckRemoval removal = removeSpecks(level.mesh, smallest);
    if (options_.compact) compact(level.mesh, refine, level.field, level.iso);
    if (options_.relax > 0) relax(level.mesh, ZeroSet(level.field, level.iso), options_.relax, progress_);
    if (openBorder_)
        level.mesh = clipToBox(level.mesh, openBorder_->worldToIndex, openBorder_->low, openBorder_->high);
    level.report.topology = topologyOf(level.mesh);
    return removal;
}

LevelMesh LevelMesher::madeAt(int refine, int step, const BSplineField& field) {
    const double smallest = smallestAt(step, field);
    LevelMesh level;
    LevelReport& report = level.report;
    level.field = field;
    report.step = step;
    if (step % kStepsPerLevel == 0) report.level = step / kStepsPerLevel;
    report.refine = refine;
    std::optional<std::vector<double>> thin;
    if (step != 0 && level0_ && level0_->volume > 0 && level0_->thin) thin = thinValues(field, refine);
    level.iso = isoFor(step, field, thin);
    if (level.iso == 0 && !openBorder_)
        limitLevel(level.field, refine, limitsOf(options_), smallest, report, progress_);
    const SpeckRemoval removal = draw(level, smallest);
    report.specksRemoved = removal.specks;
    report.speckVolume = removal.speckVolume;
    report.bubblesRemoved = removal.bubbles;
    report.bubbleVolume = removal.bubbleVolume;
    putIso(level, smallest);
    if (thin) {
        report.thinKept = shareInside(*thin, level.iso);
        report.thinKeptAtIso0 = shareInside(*thin, 0);
    }
    putFeatures(level, removal);
    return level;
}

}  // namespace lod
}  // namespace isowave
