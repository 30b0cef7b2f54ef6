// A step's field -> the mesh of that step, as lod, mesh and info make it: at which iso-value, less which specks; and
// what is told about its topology.
#pragma once

#include <memory>

#include "polygonize/features.h"
#include "polygonize/level_iso.h"
#include "polygonize/specks.h"
#include "tools/input.h"

namespace isowave::tools {

// Parts, handles and cavities of the solid that a mesh bounds.
struct SolidCounts {
    std::int64_t parts = 0, handles = 0, cavities = 0;
};
SolidCounts countsOf(const MeshTopology& topology);

// "36 -> 27 handles, 13 -> 5 parts", or "27 handles" where that is what it was; cavities where there are any.
std::string changeText(const SolidCounts& before, const SolidCounts& now);

// {"parts": -8, "handles": -9, "cavities": 0}
Json changeJson(const SolidCounts& before, const SolidCounts& now);

// "0.957x0.957x1.5", or one number when all are the same.
std::string voxelText(const Json& spacing);

// Whether there are more of anything.
bool isMore(const SolidCounts& now, const SolidCounts& before);

// A line about a level of a report: "level 2 (0.8 mm): 36 -> 27 handles, 13 -> 5 parts; holes closed up to radius ...".
// unit: " mm" or "".
std::string storyText(const Json& level, const std::string& unit);

struct LevelMesh {
    BSplineField field;  // that of the step, or what --refit made of it
    TriangleMesh mesh;   // cut off at an open border
    MeshTopology topology;
    double iso = 0;  // of the field
    int refine = 1;  // samples of a node along each axis
    Json facts;      // keys for the report: refine, iso_shift ... features
};

class LevelMesher {
  public:
    enum class Facts { few, thinToo };  // thinToo: also say how much of what is thin is kept
    // Throws UsageError for options that exclude each other.
    LevelMesher(const Settings& settings, const std::optional<Solid::Border>& openBorder, Facts facts,
                Console& console, StageClock& clock);
    ~LevelMesher();

    // Whether make() must have seen step 0 before any other.
    bool needsLevel0() const { return needsLevel0(settings_) || wantsThin_; }
    // The same of a mesher that is to be made with Facts::few.
    static bool needsLevel0(const Settings& settings) {
        return settings.preserveVolume || settings.protectThin || settings.features || settings.refit;
    }
    // With --protect-thin at twice the refinement where that has fewer components and handles.
    LevelMesh make(int step, const BSplineField& field);

    // Of which kind are the parts, handles and cavities that a level has beyond those of the level before? Those that
    // a finer lattice does not find in the same field are the mesh's sampling; the others are the field's own. The
    // lattice is doubled until nothing of the rise is left, once at least, then neither past --refine 4 nor past
    // what level 0 has. {"refine": 2, "parts": 1, "genus": 25, "cavities": 0, "thin_kept": 0.9994}; null where nothing rises,
    // at refine 4 and for meshes cut off at an open border.
    // level: as make() gave it; its mesh is not needed any more.
    Json sampling(int step, const LevelMesh& level, const SolidCounts& before) const;

  private:
    struct Level0;

    TriangleMesh polygonizeAt(const BSplineField& field, double iso, int refine) const;
    BSplineField fieldToDraw(int step, const BSplineField& field) const;
    LevelMesh madeAt(int refine, int step, const BSplineField& field);
    double smallestAt(int step, const BSplineField& field) const;
    void compact(TriangleMesh& mesh, int refine, const BSplineField& field, double iso) const;
    void rememberLevel0(const BSplineField& field, const TriangleMesh& mesh);
    double isoPreservingVolume(int step, const BSplineField& field, double smallest) const;
    std::vector<double> thinValues(const BSplineField& field, int refine) const;
    void putIso(Json& facts, const BSplineField& field, double smallest, const LevelMesh& level) const;

    const Settings& settings_;
    std::optional<Solid::Border> openBorder_;
    bool wantsThin_;
    Console& console_;
    StageClock& clock_;
    std::unique_ptr<Level0> level0_;
};

}  // namespace isowave::tools
