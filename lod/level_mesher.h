// A step's field -> the mesh of that step: at which iso-value, less which specks; and what is told about its topology.
#pragma once

#include <memory>
#include <optional>

#include "base/stage_clock.h"
#include "isowave/ladder.h"
#include "lod/regions/level_regions.h"
#include "lod/solid_state.h"
#include "polygonize/specks.h"

namespace isowave::lod {

// Whether there are more of anything.
bool isMore(const SolidCounts& now, const SolidCounts& before);

// What is known of the solid that level 0 was made of.
struct InputTruth {
    std::optional<double> volume;       // world units^3
    std::optional<SolidCounts> counts;  // parts, handles, cavities

    static InputTruth of(const InputReport& input);
};

struct LevelMesh {
    // That of the step, or what `refit` made of it; with regions blended into it on the finest region's lattice.
    BSplineField field;
    TriangleMesh mesh;                            // cut off at an open border
    double iso = 0;                               // of the field
    LevelReport report;                           // step, topology, refine ... features: what make() knows
    std::vector<LocalLevels::Place> places = {};  // of triangles; empty without regions
};

// Of the volume: a coarser level that is farther from it is told.
constexpr double kVolumeTold = 0.1;

// Whether a level may not have more parts, handles and cavities than the one before it, which must be looked at then.
inline bool levelsLimit(const LevelOptions& options, bool openBorder) {
    return options.hold == Holding::local && !openBorder;
}

class LevelMesher {
  public:
    // thinToo: also say how much of what is thin is kept. ofBudget: no level is asked for, only a step for a budget to choose,
    // which may have more parts, handles and cavities than the step before.
    enum class Facts { few, thinToo, ofBudget };
    // truth: its volume is what levels are measured against and keep with preserveVolume; without one it is level 0's. Throws UsageError for options that exclude each other.
    LevelMesher(const LevelOptions& options, const StepOrder& order, const std::optional<Border>& openBorder,
                Facts facts, const InputTruth& truth, const Progress& progress, StageClock& clock);
    ~LevelMesher();

    // Whether make() must have seen step 0 before any other.
    bool needsLevel0() const { return isowave::needsLevel0(options_) || wantsThin_; }
    // Sampled as options say, else as finely as it takes: level 0 for the input's parts, handles, cavities and volume, the
    // others for what is thin and for no more parts, handles and cavities than level 0 has.
    // Regions that keep a finer level are blended in at last, so that levels limit each other as they do without.
    LevelMesh make(int step, const BSplineField& field);
    // A level that nobody asked for: one that regions of coarser ones keep, or that limits those after it.
    void prepare(int step, const BSplineField& field);
    // The steps that make() or prepare() must have seen before this one, which is not among them; ascending.
    std::vector<int> stepsBefore(int step) const;

    // Of which kind are the parts, handles and cavities that a level has beyond those of the level before? Those that
    // a finer lattice does not find in the same field are the mesh's sampling; the others are the field's own. The
    // lattice is doubled until nothing of the rise is left, once at least, then neither past refine 4 nor past
    // what level 0 has. Nothing where nothing rises, at refine 4 and for meshes cut off at an open border.
    // level: as make() gave it; its mesh is not needed any more.
    std::optional<SamplingReport> sampling(const LevelMesh& level, const SolidCounts& before) const;

    // A remark for the first level that has gained or lost more than kVolumeTold of the volume: level 0 has its own.
    // report: as make() gave it. Nothing with preserveVolume, which says by itself what it could not keep.
    void tellVolume(const LevelReport& report);

  private:
    struct Level0;

    TriangleMesh polygonizeAt(const BSplineField& field, double iso, int refine) const;
    BSplineField fieldToDraw(int step, const BSplineField& field) const;
    // How finely a field is sampled; and its mesh at iso 0 where choosing took one, else empty.
    struct Sampled {
        int refine = 1;
        TriangleMesh mesh = {};
        double closedGaps = 0;  // HoldOptions
    };
    Sampled sampled(int step, const BSplineField& field);
    Sampled sampledLevel0(const BSplineField& field);
    std::optional<SolidCounts> mendable(const LevelMesh& level) const;
    Sampled sampledAsInput(const BSplineField& field) const;
    // A level whose mesh has its parts, handles, cavities and volume, and all its triangles. That it is closed and 2-manifold
    // is taken on trust here and counted when it is completed.
    struct Draft {
        LevelMesh level;
        SpeckRemoval removal;
        SolidCounts counts() const { return countsOf(level.report.topology); }
    };
    Draft draftedAt(Sampled sampled, int step, const BSplineField& field);
    Draft shifted(Draft draft, int step, const BSplineField& field);
    Draft chosen(int step, const BSplineField& field);
    Draft withoutGaps(Draft draft, int step, const BSplineField& field);
    void limit(Draft& draft);
    LevelMesh completed(Draft draft) const;
    LevelMesh whole(int step, const BSplineField& field);
    void putRemoval(LevelMesh& level, const SpeckRemoval& removal, double smallest) const;
    DrawnLevel drawnBy(const LevelMesh& level) const;
    void addRegions(LevelMesh& level);
    SpeckRemoval drawBlended(LevelMesh& level, RegionBlend& blend) const;
    void tellAdaptive(LevelReport& report, const AdaptiveSummary& summary) const;
    void finish(LevelMesh& level) const;
    bool holds(int step) const;
    bool mustFall(int step) const;
    void hold(LevelMesh& level, double closedGaps) const;
    void tellWalls(LevelReport& report) const;
    void tellMended(const LevelReport& report) const;
    void tellDifference(const LevelReport& report) const;
    double smallestAt(int step, const BSplineField& field) const;
    double isoFor(const LevelMesh& level, const std::optional<std::vector<double>>& thin) const;
    void draw(Draft& draft, TriangleMesh ready = {});
    void compact(TriangleMesh& mesh, int refine, const BSplineField& field, double iso) const;
    bool compacts(int refine) const;
    void rememberLevel0(const BSplineField& field, const TriangleMesh& mesh, const MeshComponents& components,
                        int refine);
    double volumeToKeep() const;
    double isoPreservingVolume(const LevelMesh& level, double smallest) const;
    std::vector<double> thinValues(const BSplineField& field, int refine) const;
    void putIso(LevelMesh& level, double smallest) const;
    void putFeatures(LevelMesh& level, const SpeckRemoval& removal) const;

    const LevelOptions options_;
    const StepOrder order_;
    std::optional<Border> openBorder_;
    bool wantsThin_;
    Facts facts_;
    InputTruth truth_;
    double smallest0_ =
        0;  // what is smaller goes at step 0: what the input has no more parts and cavities for
    std::optional<SolidCounts> before_;  // of the step made before, of those that must not have more
    const Progress& progress_;
    StageClock& clock_;
    std::unique_ptr<Level0> level0_;
    std::optional<LevelRegions> regions_;
    bool toldOfRegions_ = false, toldOfVolume_ = false, toldOfLoss_ = false;
};

}  // namespace isowave::lod
