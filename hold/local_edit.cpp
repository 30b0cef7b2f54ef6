#include "hold/local_edit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "hold/mesh_lattice.h"
#include "polygonize/cell_table.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/row_ascent.h"

// Index space: F at x depends on the control points nearer than 2 to it on each axis. With A the control points that may
// change, F changes nearer than 2 to A, and rows there need control points nearer than 4 to A.

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr int kReach = 2, kAround = 4;

struct MeshSize {
    double volume;
    int euler;
};
MeshSize sizeOf(const BSplineField& field, int refine) {
    const MeshTopology topology = topologyOf(polygonize(field, {.refine = refine}));
    return {topology.volume, static_cast<int>(2 * topology.components - 2 * topology.genus)};
}

class Trial {
  public:
    Trial(const BSplineField& field, int refine, const EditPlan& plan) : refine_(refine), plan_(plan) {
        collectPlaces();
        cutOut(field);
        lattice_ = meshLattice(local_, refine);
        for (const Coord& c : plan.points) wanted_.insert(c);
        step_ = meanStep();
        tolerance_ = 0.01 * step_;
    }

    LocalEdit run() {
        LocalEdit edit;
        edit.box = box_;
        const MeshSize before = sizeOf(local_, refine_);
        const std::vector<FieldRow> demands = rows();
        if (plan_.whole) startBeyond();
        ascend(local_, demands, {.tolerance = tolerance_, .rounds = 100});
        const MeshSize after = sizeOf(local_, refine_);
        edit.volume = after.volume - before.volume;
        edit.euler = after.euler - before.euler;
        for (auto known = local_.controlPoints->cbeginValueOn(); known; ++known)
            if (*known != before_->tree().getValue(known.getCoord()))
                edit.controlPoints.emplace_back(known.getCoord(), *known);
        return edit;
    }

  private:
    void collectPlaces() {
        places_ = plan_.places;
        for (const Coord& c : plan_.points) places_.push_back(c.asVec3d() / refine_);
        for (const Vec3d& at : places_)
            for (const Vec3d& end : {at - Vec3d(kReach), at + Vec3d(kReach)}) {
                // nearer than kReach
                const Coord low = Coord::floor(end).offsetBy(1), high = Coord::ceil(end).offsetBy(-1);
                box_.expand(end[0] < at[0] ? low : high);
            }
    }

    // Control points around the plan; those in reach of its points are active.
    void cutOut(const BSplineField& field) {
        local_.K = field.K;
        local_.controlPoints = openvdb::FloatGrid::create(static_cast<float>(field.K));
        local_.shape = Shape::create(false);
        local_.controlPoints->setTransform(field.transform().copy());
        local_.shape->setTransform(field.transform().copy());
        auto to = local_.controlPoints->getAccessor();
        const auto from = field.controlPoints->getConstAccessor();
        CoordBBox all = box_;
        all.expand(kAround);
        for (auto at = all.begin(); at; ++at) to.setValueOff(*at, from.getValue(*at));
        for (const Vec3d& at : places_) {
            const CoordBBox near(Coord::floor(at - Vec3d(kReach)).offsetBy(1),
                                 Coord::ceil(at + Vec3d(kReach)).offsetBy(-1));
            for (auto c = near.begin(); c; ++c) to.setActiveState(*c, true);
        }
        before_ = local_.controlPoints->deepCopy();
    }

    // Lattice points where F may change.
    CoordBBox rowBox() const {
        return {Coord((box_.min().offsetBy(-kReach)).asVec3i() * refine_).offsetBy(1),
                Coord((box_.max().offsetBy(kReach)).asVec3i() * refine_).offsetBy(-1)};
    }

    double meanStep() const {
        double sum = 0;
        int count = 0;
        const CoordBBox box = rowBox();
        for (auto at = box.begin(); at; ++at)
            for (int a = 0; a < 3; ++a) {
                Coord next = *at;
                ++next[a];
                const double f = lattice_.at(*at), g = lattice_.at(next);
                if ((f < 0) == (g < 0)) continue;
                sum += std::abs(f - g);
                ++count;
            }
        return count > 0 ? sum / count : local_.K / 4;
    }

    // For parts as a whole; the rows then mend what is beside them.
    void startBeyond() {
        const float value = static_cast<float>((plan_.fill ? -1.5 : 1.5) * plan_.margin * step_);
        for (auto known = local_.controlPoints->beginValueOn(); known; ++known)
            if (plan_.fill ? *known > value : *known < value) known.setValue(value);
    }

    bool isWanted(const Coord& c) const { return wanted_.count(c) != 0; }
    bool insideAfter(const Coord& c) const {
        const Coord p = c - planned_.min();
        return after_[(std::size_t(p[0]) * planned_.dim()[1] + p[1]) * planned_.dim()[2] + p[2]] & 1;
    }
    bool isPlanned(const Coord& c) const {
        const Coord p = c - planned_.min();
        return after_[(std::size_t(p[0]) * planned_.dim()[1] + p[1]) * planned_.dim()[2] + p[2]] & 2;
    }
    // Signs to come: bit 0 inside, bit 1 of the plan.
    void foresee() {
        planned_ = rowBox();
        planned_.expand(std::max(1, plan_.thicker));
        after_.reserve(planned_.volume());
        for (auto at = planned_.begin(); at; ++at) {
            const bool wanted = isWanted(*at);
            after_.push_back(static_cast<char>((wanted ? plan_.fill : lattice_.at(*at) < 0) | wanted << 1));
        }
    }

    bool mustKeep(const Coord& c) const {
        if (isPlanned(c)) return false;
        if (plan_.thicker == 0 || insideAfter(c) == plan_.fill) return true;
        const CoordBBox near(c.offsetBy(-plan_.thicker), c.offsetBy(plan_.thicker));
        for (auto at = near.begin(); at; ++at)
            if (isPlanned(*at)) return false;
        return true;
    }

    std::vector<FieldRow> rows() {
        foresee();
        std::vector<FieldRow> rows;
        for (const Vec3d& at : places_) rows.push_back(rowOf(at, plan_.fill, plan_.margin * step_));
        const CoordBBox box = rowBox();
        for (auto at = box.begin(); at; ++at) {
            if (mustKeep(*at)) rows.push_back(keptSign((*at).asVec3d() / refine_, lattice_.at(*at)));
            addCell(*at, rows);
        }
        return rows;
    }
    static FieldRow rowOf(const Vec3d& at, bool inside, double bound) {
        return {at, inside ? 1.0f : -1.0f, static_cast<float>(bound), 0, false};
    }
    // A sign is kept with as much of |F| as it has, up to a twentieth of a step, and surely beyond the tolerance.
    FieldRow keptSign(const Vec3d& at, double f) const {
        return rowOf(at, f < 0, std::clamp(std::abs(f), 3 * tolerance_, 0.05 * step_));
    }

    // Where the corners of a cell will leave a choice, F keeps its sign in the middle of its low faces and of itself.
    void addCell(const Coord& low, std::vector<FieldRow>& rows) const {
        unsigned pattern = 0;
        bool beside = false;
        for (int c = 0; c < kCellCorners; ++c) {
            const Coord corner = low.offsetBy(c & 1, c >> 1 & 1, c >> 2);
            pattern |= static_cast<unsigned>(insideAfter(corner)) << c;
            beside = beside || isPlanned(corner);
        }
        if (cellTable().isPlain(pattern) || (beside && plan_.thicker > 0)) return;
        const Vec3d middle = low.asVec3d() + Vec3d(0.5);
        keep(middle, rows);
        for (int a = 0; a < 3; ++a) {
            if (!(cellTable().ambiguousFaces(pattern) >> (2 * a) & 1)) continue;
            Vec3d face = middle;
            face[a] -= 0.5;
            keep(face, rows);
        }
    }
    void keep(const Vec3d& latticePlace, std::vector<FieldRow>& rows) const {
        const Vec3d at = latticePlace / refine_;
        if (std::find(plan_.places.begin(), plan_.places.end(), at) == plan_.places.end())
            rows.push_back(keptSign(at, evaluate(local_, at)));
    }

    int refine_;
    const EditPlan& plan_;
    std::vector<Vec3d> places_;
    CoordBBox box_;
    BSplineField local_;
    openvdb::FloatGrid::Ptr before_;
    MeshLattice lattice_;
    std::unordered_set<Coord> wanted_;
    CoordBBox planned_;
    std::vector<char> after_;
    double step_ = 0, tolerance_ = 0;
};

// Makes a control point known, with its block of 4^3, values as they are.
void makeKnown(const Coord& at, openvdb::FloatGrid::Accessor& values, Shape::Accessor& shape) {
    if (values.isValueOn(at)) return;
    const CoordBBox block(at.offsetBy(-1), at.offsetBy(2));
    for (auto c = block.begin(); c; ++c) {
        values.setActiveState(*c, true);
        shape.setActiveState(*c, true);
    }
}

}  // namespace

LocalEdit tryEdit(const BSplineField& field, int refine, const EditPlan& plan) {
    return Trial(field, refine, plan).run();
}

void apply(const LocalEdit& edit, BSplineField& field) {
    if (edit.controlPoints.empty()) return;
    auto values = field.controlPoints->getAccessor();
    auto shape = field.shape->getAccessor();
    for (const auto& [at, value] : edit.controlPoints) {
        makeKnown(at, values, shape);
        values.setValueOn(at, value);
    }
    CoordBBox reached = edit.box;
    reached.expand(1);
    for (auto at = reached.begin(); at; ++at) {
        const bool inside = evaluate(field, (*at).asVec3d()) < 0;
        if (shape.getValue(*at) != inside) shape.setValueOnly(*at, inside);
    }
}

}  // namespace isowave
