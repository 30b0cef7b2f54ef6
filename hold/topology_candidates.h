// What could be cut or filled to have one part, handle or cavity less.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <tuple>
#include <vector>

#include "hold/local_edit.h"
#include "hold/mesh_lattice.h"
#include "hold/topology_edit.h"

namespace isowave {

// One way to do it.
struct EditOption {
    TopologyEdit edit;  // without its volume
    EditPlan plan;
    double estimate = 0;            // of the volume, in lattice cells
    std::optional<int> euler = {};  // by which the mesh's Euler number changes then, where that is known
};
// Tells options apart.
using OptionKey = std::array<double, 6>;
inline OptionKey keyOf(const EditOption& option) {
    const TopologyEdit& edit = option.edit;
    return {double(edit.kind), double(edit.what), edit.at[0], edit.at[1], edit.at[2], option.estimate};
}
// All ways to get rid of the same thing, the one with the smallest estimate first.
using EditOptions = std::vector<EditOption>;

// Plugs that were grown before, for as long as the field around them stays as it is. Safe from any thread.
class PlugMemo {
  public:
    using Plug = std::vector<openvdb::Coord>;
    // The start on the mesh's lattice, whether to fill, the height, the radius (< 0: on that of the control points).
    using Key = std::tuple<openvdb::Coord, bool, float, int>;
    // make() gives the plug where none is known.
    template <class Make>
    Plug at(const Key& key, const Make& make) {
        {
            const std::lock_guard lock(mutex_);
            if (const auto found = plugs_.find(key); found != plugs_.end()) return found->second;
        }
        Plug plug = make();
        const std::lock_guard lock(mutex_);
        return plugs_.emplace(key, std::move(plug)).first->second;
    }
    // Of starts in a box of the lattice that the mesh samples.
    void forget(const openvdb::CoordBBox& box) {
        std::erase_if(plugs_, [&](const auto& entry) { return box.isInside(std::get<0>(entry.first)); });
    }

  private:
    std::mutex mutex_;
    std::map<Key, Plug> plugs_;
};

class TopologyCandidates {
  public:
    // How thoroughly to look.
    struct Depth {
        double last;  // of F: up to which holes, gaps and cavities are followed
        double
            points;  // of the lattice on which they are found: decidedLattice(), or the finest of the mesh's own and
                     // coarser ones that has no more
    };
    // Of the field's mesh at `refine`. Parts and cavities smaller than `smallestPart`/2 (world units^3) are left
    // out.
    // memo: of the same field and refinement. useless: options that are no longer offered; a plug that is one of them
    // is grown again with a wider radius.
    TopologyCandidates(const BSplineField& field, int refine, double smallestPart, const Depth& depth,
                       PlugMemo& memo, const std::set<OptionKey>& useless, const Progress& progress);

    // By least estimate. Up to `most` things, of which `wanted` are to be had; the largest part is not among them.
    std::vector<EditOptions> of(TopologyEdit::What what, std::size_t wanted, std::size_t most) const;

  private:
    using Points = std::vector<std::int64_t>;

    EditOptions optionsOf(const PersistentClass& c, std::size_t largest) const;
    EditOptions handle(const PersistentClass& c) const;
    EditOptions part(const PersistentClass& c, std::size_t largest) const;
    EditOptions cavity(const PersistentClass& c) const;
    bool isDecided() const { return found_.finer > refine_; }
    Points flooded(std::int64_t from) const;
    std::vector<openvdb::Coord> floodedOnMesh(const openvdb::Coord& from) const;
    double cellsOf(const Points& points) const;
    std::size_t largestPart() const;
    struct PlugStart {
        openvdb::Coord at;  // of the lattice of the mesh, or of the control points
        float height;
        bool onControlPoints;
    };
    void addPlugFrom(const PlugStart& start, TopologyEdit::What what, bool fill, EditOptions& options) const;
    void addPlug(std::int64_t at, TopologyEdit::What what, bool fill, EditOptions& options) const;
    void addWhole(std::int64_t from, const Points& points, TopologyEdit::What what, bool fill,
                  EditOptions& options) const;
    void addDecider(std::int64_t at, TopologyEdit::What what, bool fill, EditOptions& options) const;
    std::vector<openvdb::Coord> anchors(std::int64_t at, bool fill) const;
    TopologyEdit editAt(const openvdb::Vec3d& place, TopologyEdit::What what, bool fill) const;

    const BSplineField& field_;
    PlugMemo& memo_;
    const std::set<OptionKey>& useless_;
    const Progress& progress_;
    int refine_;
    double smallest_;    // in lattice cells of the mesh
    BSplineField fine_;  // on the lattice that the mesh samples
    MeshLattice found_;  // where classes are found: twice as fine as that lattice, as fine, or coarser
    std::vector<PersistentClass> classes_;
};

}  // namespace isowave
