// make = choose the iso-value -> polygonize -> remove specks -> compact -> relax -> cut off at the border -> count -> tell
// sampling = polygonize the same field finer -> remove specks -> count
#include "tools/level_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "polygonize/clip.h"
#include "simplify/collapse.h"
#include "polygonize/polygonize.h"
#include "polygonize/refit.h"
#include "polygonize/relax.h"
#include "tools/steps.h"

namespace isowave::tools {
namespace {

constexpr double kPreserved = 1e-4;  // of level 0's volume: issue's 0.01 %
constexpr int kFinestRefine = 4;     // that polygonize() takes

}  // namespace

SolidCounts countsOf(const MeshTopology& topology) {
    return {topology.parts, topology.genus, topology.cavities};
}

std::string changeText(const SolidCounts& before, const SolidCounts& now) {
    const auto part = [](std::int64_t from, std::int64_t to, const char* one, const char* many) {
        return (from == to ? std::string() : grouped(from) + " -> ") + counted(to, one, many);
    };
    std::string text = part(before.handles, now.handles, "handle", "handles") + ", " +
                       part(before.parts, now.parts, "part", "parts");
    if (before.cavities > 0 || now.cavities > 0)
        text += ", " + part(before.cavities, now.cavities, "cavity", "cavities");
    return text;
}

Json changeJson(const SolidCounts& before, const SolidCounts& now) {
    return {{"parts", now.parts - before.parts},
            {"handles", now.handles - before.handles},
            {"cavities", now.cavities - before.cavities}};
}

bool isMore(const SolidCounts& now, const SolidCounts& before) {
    return now.parts > before.parts || now.handles > before.handles || now.cavities > before.cavities;
}

std::string voxelText(const Json& spacing) {
    const std::string x = fmt::format("{:.4g}", spacing[0].get<double>());
    const std::string y = fmt::format("{:.4g}", spacing[1].get<double>());
    const std::string z = fmt::format("{:.4g}", spacing[2].get<double>());
    return x == y && y == z ? x : x + "x" + y + "x" + z;
}

namespace {

// "holes closed up to radius 1.9 mm, open from 2.1 mm, 3 torn open"
std::string survivalText(const Json& survival, std::string_view what, std::string_view gone,
                         std::string_view there, const std::string& unit) {
    std::vector<std::string> phrases;
    if (const Json& r = survival["largest_vanished"]; !r.is_null())
        phrases.push_back(fmt::format("{} up to radius {:.3g}{}", gone, r.get<double>(), unit));
    if (const Json& r = survival["smallest_surviving"]; !r.is_null())
        phrases.push_back(fmt::format("{} from radius {:.3g}{}", there, r.get<double>(), unit));
    if (const auto torn = survival["torn"].get<std::int64_t>(); torn > 0)
        phrases.push_back(fmt::format("{} torn open", grouped(torn)));
    return phrases.empty() ? std::string() : fmt::format("{} {}", what, fmt::join(phrases, ", "));
}

// "76 of 76 new handles are the mesh's sampling, --refine 2 has 25", or nothing where there are no new ones.
std::string samplingText(const Json& level, const char* key, const char* kind, const char* one,
                         const char* many) {
    const auto now = level[key].get<std::int64_t>(), added = level["change"][kind].get<std::int64_t>(),
               finer = level["sampling"][key].get<std::int64_t>();
    if (added <= 0) return {};
    return fmt::format("{} of {} the mesh's sampling, --refine {} has {}",
                       grouped(std::clamp<std::int64_t>(now - finer, 0, added)),
                       counted(added, fmt::format("new {} is", one), fmt::format("new {} are", many)),
                       level["sampling"]["refine"].get<int>(), grouped(finer));
}

void addPhrase(std::string& story, const std::string& phrase) {
    if (!phrase.empty()) story += "; " + phrase;
}

}  // namespace

std::string storyText(const Json& level, const std::string& unit) {
    std::string story = level["level"].is_null() ? fmt::format("step {}", level["step"].get<int>())
                                                 : fmt::format("level {}", level["level"].get<int>());
    story += fmt::format(" ({}{})", voxelText(level["spacing"]), unit);
    if (!level["genus"].is_null()) {
        const SolidCounts now{level["parts"], level["genus"], level["cavities"]};
        const Json& change = level["change"];
        const auto before = [&](std::int64_t count, const char* key) {
            return count - change[key].get<std::int64_t>();
        };
        story += ": " + changeText({before(now.parts, "parts"), before(now.handles, "handles"),
                                    before(now.cavities, "cavities")},
                                   now);
    }
    if (!level["sampling"].is_null()) {
        addPhrase(story, samplingText(level, "genus", "handles", "handle", "handles"));
        addPhrase(story, samplingText(level, "parts", "parts", "part", "parts"));
        addPhrase(story, samplingText(level, "cavities", "cavities", "cavity", "cavities"));
    }
    if (const Json& features = level["features"]; !features.is_null()) {
        addPhrase(story, survivalText(features["handles"], "holes", "closed", "open", unit));
        addPhrase(story, survivalText(features["parts"], "parts", "gone", "kept", unit));
        addPhrase(story, survivalText(features["cavities"], "cavities", "filled", "kept", unit));
    }
    const auto specks = level["specks_removed"].get<std::int64_t>(),
               bubbles = level["bubbles_removed"].get<std::int64_t>();
    if (specks > 0 || bubbles > 0)
        addPhrase(story,
                  fmt::format("{} and {} removed", counted(specks, "speck"), counted(bubbles, "bubble")));
    if (const double shift = level["iso_shift"]; shift != 0 && !level["iso_distance"].is_null()) {
        addPhrase(story, fmt::format("iso {:+.3f} K moves the surface by {:+.3g}{}", shift,
                                     level["iso_distance"].get<double>(), unit));
        if (const double unmoved = level["volume_at_iso_0"]; unmoved > 0)
            story += fmt::format(" and the volume by {:+.3g} %",
                                 100 * (level["volume"].get<double>() / unmoved - 1));
    }
    if (const Json& kept = level["thin_kept"], &at0 = level["thin_kept_at_iso_0"];
        !kept.is_null() && at0 < 1) {
        addPhrase(story, fmt::format("{:.3g} % of what is thin is kept", 100 * kept.get<double>()));
        if (kept != at0) story += fmt::format(" ({:.3g} % at iso 0)", 100 * at0.get<double>());
    }
    return story;
}

// What the coarser steps are compared with.
struct LevelMesher::Level0 {
    double volume = 0;
    std::optional<ThinParts> thin;
    std::optional<SolidFeatures> features;
    std::vector<SurfaceSample> surface;  // for --refit
};

LevelMesher::LevelMesher(const Settings& settings, const std::optional<Solid::Border>& openBorder,
                         Facts facts, Console& console, StageClock& clock)
    : settings_(settings),
      openBorder_(openBorder),
      wantsThin_(settings.protectThin || facts == Facts::thinToo),
      console_(console),
      clock_(clock) {
    if (settings.preserveVolume && settings.protectThin)
        throw UsageError(
            "--preserve-volume and --protect-thin exclude each other: each chooses the iso-value of a level");
    if (settings.compact && settings.refine == 1)
        throw UsageError("--compact collapses what --refine 2 or 4 adds; give one of them");
    if (settings.compact && settings.relax > 0)
        throw UsageError(
            "--compact and --relax exclude each other: one keeps the volume, the other goes back to the zero "
            "set");
    if (settings.preserveVolume && openBorder)
        throw UsageError("--preserve-volume needs a closed surface; leave out --open-border");
}

LevelMesher::~LevelMesher() = default;

TriangleMesh LevelMesher::polygonizeAt(const BSplineField& field, double iso, int refine) const {
    return polygonize(field, {.refine = refine, .iso = iso}, console_.progress());
}

// A mesh on the zero set lies inside where the solid is convex, and coarse triangles cut off corners and tear walls. Finer
// ones do so less, and collapsing them by volumes (Lindstrom and Turk) keeps what they have gained: docs/fidelity.md.
void LevelMesher::compact(TriangleMesh& mesh, int refine, const BSplineField& field, double iso) const {
    if (mesh.triangles.empty()) return;
    const auto finer = static_cast<std::int64_t>(refine) * refine;
    const bool normals = !mesh.normals.empty();
    mesh = thin(mesh, static_cast<std::int64_t>(mesh.triangles.size()) / finer, console_.progress());
    if (normals) mesh.normals = ZeroSet(field, iso).normalsOf(mesh, console_.progress());
}

// The volume without the specks that will be removed.
double LevelMesher::isoPreservingVolume(int step, const BSplineField& field, double smallest) const {
    const StageClock::Scope scope(clock_, "choose iso");
    const VolumeMatch match = isoOfVolume(
        [&](double iso) { return volumeWithoutSpecks(polygonizeAt(field, iso, settings_.refine), smallest); },
        level0_->volume, kIsoLimit * field.K);
    const double error = match.volume / level0_->volume - 1;
    if (std::abs(error) > kPreserved)
        console_.say(fmt::format("step {}: the volume of level 0 is out of reach: {:+.3g} % at iso {:+.3g} K",
                                 step, 100 * error, match.iso / field.K));
    return match.iso;
}

std::vector<double> LevelMesher::thinValues(const BSplineField& field, int refine) const {
    const StageClock::Scope scope(clock_, "thin parts");
    const openvdb::Vec3d spacing = field.transform().voxelSize();
    if (refine == 1) return level0_->thin->valuesOn(field, spacing, console_.progress());
    BSplineField fine = field;
    for (int refined = 1; refined < refine; refined *= 2) fine = refineField(fine, console_.progress());
    return level0_->thin->valuesOn(fine, spacing, console_.progress());
}

void LevelMesher::rememberLevel0(const BSplineField& field, const TriangleMesh& mesh) {
    level0_ = std::make_unique<Level0>();
    if (mesh.triangles.empty()) return;
    level0_->volume = volumeWithoutSpecks(mesh, 0);
    if (settings_.refit) level0_->surface = surfaceSamples(mesh);
    if (wantsThin_) {
        const StageClock::Scope scope(clock_, "thin parts");
        level0_->thin.emplace(field, console_.progress());
    }
    if (settings_.features) {
        const StageClock::Scope scope(clock_, "features");
        const openvdb::Vec3d spacing = field.transform().voxelSize();
        FeatureOptions options;
        options.spacing = std::min({spacing[0], spacing[1], spacing[2]});
        level0_->features = featuresOf(mesh, options, console_.progress());
    }
}

namespace {

Json numberOrNull(const std::optional<double>& value) { return value ? finite(*value) : Json(nullptr); }

// more: parts, handles or cavities of the level that none of level 0's accounts for.
Json survivalJson(const Survival& s, std::int64_t now) {
    return {{"survived", s.survived},
            {"vanished", s.closed},
            {"torn", s.torn},
            {"more", std::max<std::int64_t>(0, now - s.survived)},
            {"smallest_surviving", numberOrNull(s.smallestSurviving)},
            {"largest_vanished", numberOrNull(s.largestVanished)}};
}

Json featuresJson(const SolidFeatures& features, const SolidSurvival& survival, const SolidCounts& now) {
    return {{"spacing", features.spacing},
            {"reach", features.reach},
            {"parts", survivalJson(survival.parts, now.parts)},
            {"handles", survivalJson(survival.handles, now.handles)},
            {"cavities", survivalJson(survival.cavities, now.cavities)}};
}

}  // namespace

// iso_distance: what was added, over the mean of the two areas.
void LevelMesher::putIso(Json& facts, const BSplineField& field, double smallest,
                         const LevelMesh& level) const {
    const MeshTopology& topology = level.topology;
    double distance = 0, volumeAt0 = topology.volume;
    const bool known = !openBorder_;
    if (level.iso != 0 && known) {
        TriangleMesh unmoved = polygonizeAt(field, 0, level.refine);
        removeSpecks(unmoved, smallest);
        const MeshTopology before = topologyOf(unmoved);
        volumeAt0 = before.volume;
        const double area = (before.area + topology.area) / 2;
        distance = area > 0 ? (topology.volume - volumeAt0) / area : 0;
    }
    const double volume0 = level0_ ? level0_->volume : 0;
    facts["iso_shift"] = level.iso / field.K;
    facts["iso_distance"] = known ? finite(distance) : Json(nullptr);
    facts["volume_at_iso_0"] = known ? finite(volumeAt0) : Json(nullptr);
    facts["volume_error"] = known && volume0 > 0 ? finite(topology.volume / volume0 - 1) : Json(nullptr);
}

// What is smaller goes.
double LevelMesher::smallestAt(int step, const BSplineField& field) const {
    return step == 0 || settings_.keepSpecks ? 0 : nodeVolume(field.transform());
}

BSplineField LevelMesher::fieldToDraw(int step, const BSplineField& field) const {
    if (step == 0 || !settings_.refit || !level0_) return field;
    const StageClock::Scope scope(clock_, "refit");
    return refitted(field, level0_->surface, {}, console_.progress());
}

LevelMesh LevelMesher::make(int step, const BSplineField& given) {
    const BSplineField field = fieldToDraw(step, given);
    LevelMesh level = madeAt(settings_.refine, step, field);
    if (step == 0 || !settings_.protectThin || openBorder_ || settings_.refine == kFinestRefine) return level;
    LevelMesh finer = madeAt(2 * settings_.refine, step, field);
    const auto pieces = [](const LevelMesh& l) { return l.topology.components + l.topology.genus; };
    const bool fewer = !finer.mesh.triangles.empty() && pieces(finer) < pieces(level);
    return fewer ? std::move(finer) : std::move(level);
}

Json LevelMesher::sampling(int step, const LevelMesh& level, const SolidCounts& before) const {
    const BSplineField& field = level.field;
    SolidCounts finer = countsOf(level.topology);
    if (step == 0 || openBorder_ || level.refine == kFinestRefine || !isMore(finer, before)) return nullptr;
    const StageClock::Scope scope(clock_, "sampling");
    // A lattice point of level 0 and one of this level, refined so often, are equally dense.
    const int finest = std::min(kFinestRefine, settings_.refine << std::min(2, step / kStepsPerLevel));
    int refine = level.refine;
    do {
        refine *= 2;
        TriangleMesh mesh = polygonizeAt(field, level.iso, refine);
        removeSpecks(mesh, smallestAt(step, field));
        finer = countsOf(topologyOf(mesh));
    } while (isMore(finer, before) && 2 * refine <= finest);
    const bool thin = level0_ && level0_->thin;
    return {{"refine", refine},
            {"parts", finer.parts},
            {"genus", finer.handles},
            {"cavities", finer.cavities},
            {"thin_kept", thin ? finite(shareInside(thinValues(field, refine), level.iso)) : Json(nullptr)}};
}

LevelMesh LevelMesher::madeAt(int refine, int step, const BSplineField& field) {
    const double smallest = smallestAt(step, field);
    const bool compared = step != 0 && level0_ && level0_->volume > 0;
    LevelMesh level;
    level.field = field;
    level.refine = refine;
    std::optional<std::vector<double>> thin;
    if (compared && level0_->thin) thin = thinValues(field, refine);
    if (compared && settings_.preserveVolume) level.iso = isoPreservingVolume(step, field, smallest);
    if (thin && settings_.protectThin)
        level.iso = isoThatKeeps(*thin, ThinParts::kShare, kIsoLimit * field.K);
    SpeckRemoval removal;
    {
        const StageClock::Scope scope(clock_, "polygonize");
        level.mesh = polygonizeAt(field, level.iso, refine);
        if (step == 0) rememberLevel0(field, level.mesh);
        removal = removeSpecks(level.mesh, smallest);
        if (settings_.compact) compact(level.mesh, refine, field, level.iso);
        if (settings_.relax > 0)
            relax(level.mesh, ZeroSet(field, level.iso), settings_.relax, console_.progress());
        if (openBorder_)
            level.mesh =
                clipToBox(level.mesh, openBorder_->worldToIndex, openBorder_->low, openBorder_->high);
        level.topology = topologyOf(level.mesh);
    }
    level.facts["refine"] = refine;
    level.facts["parts"] = level.topology.parts;
    level.facts["cavities"] = level.topology.cavities;
    level.facts["specks_removed"] = removal.specks;
    level.facts["speck_volume"] = removal.speckVolume;
    level.facts["bubbles_removed"] = removal.bubbles;
    level.facts["bubble_volume"] = removal.bubbleVolume;
    putIso(level.facts, field, smallest, level);
    level.facts["thin_kept"] = thin ? finite(shareInside(*thin, level.iso)) : Json(nullptr);
    level.facts["thin_kept_at_iso_0"] = thin ? finite(shareInside(*thin, 0)) : Json(nullptr);
    const bool told = level0_ && level0_->features && !level.mesh.triangles.empty();
    level.facts["features"] =
        told ? featuresJson(*level0_->features,
                            survivalOf(*level0_->features, field, level.iso, removal.boxes),
                            countsOf(level.topology))
             : Json(nullptr);
    return level;
}

}  // namespace isowave::tools
