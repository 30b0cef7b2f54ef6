#include "hold/local_edit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polygonize/cell_table.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"

// Index space: F at x depends on the control points nearer than 2 to it on each axis. With A the control points that may
// change, F changes nearer than 2 to A, and rows there need control points nearer than 4 to A.

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr int kReach = 2, kAround = 3;
constexpr std::uint8_t kInside = 1, kPlanned = 2, kBeside = 4;  // beside: nearer than a control point
// Mean differences of F over a lattice edge: lattice points so far from the surface are not asked to keep their sign, but looked at
// when all others have been: they are most of the points, and hardly ever in danger.
constexpr double kFar = 3;
// What it costs to break a sign that should be kept, for each control point's share of the lattice: rho of FieldRow. Kept without
// exception, signs a fraction of a control point from the plan's would have control points swing to and fro, farther and farther, and
// the surface with them.
constexpr double kSoftness = 0.01;

double volumeOf(const BSplineField& field, int refine) {
    return topologyOf(polygonize(field, {.refine = refine})).volume;
}

FieldRow rowOf(const Vec3d& at, bool inside, double bound, double rho) {
    return {at, inside ? 1.0f : -1.0f, static_cast<float>(bound), static_cast<float>(rho), false};
}

CoordBBox pointsNear(const Vec3d& at) {  // nearer than kReach
    return {Coord::floor(at - Vec3d(kReach)).offsetBy(1), Coord::ceil(at + Vec3d(kReach)).offsetBy(-1)};
}

}  // namespace

EditTrial::EditTrial(const BSplineField& field, int refine, const EditPlan& plan)
    : refine_(refine), plan_(plan) {
    collectPlaces();
    cutOut(field);
    patchBefore_ = patch();
    step_ = meanStep();
    tolerance_ = 0.01 * step_;
    foresee();
}

void EditTrial::collectPlaces() {
    places_ = plan_.places;
    for (const Coord& c : plan_.points) places_.push_back(c.asVec3d() / refine_);
    for (const Vec3d& at : places_) box_.expand(pointsNear(at));
}

// Control points around the plan; those in reach of its points are active.
void EditTrial::cutOut(const BSplineField& field) {
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
        const CoordBBox near = pointsNear(at);
        for (auto c = near.begin(); c; ++c) to.setActiveState(*c, true);
    }
    before_ = local_.controlPoints->deepCopy();
}

LatticePatch EditTrial::patch() const {
    CoordBBox all = box_;
    all.expand(kAround);
    LatticeFunction c{all.dim(), {}};
    c.values.reserve(static_cast<std::size_t>(all.volume()));
    const auto from = local_.controlPoints->getConstAccessor();
    for (auto at = all.begin(); at; ++at) c.values.push_back(from.getValue(*at));  // z fastest
    return {c, all.min(), refine_};
}

// Lattice points where F may change.
CoordBBox EditTrial::rowBox() const {
    return {Coord((box_.min().offsetBy(-kReach)).asVec3i() * refine_).offsetBy(1),
            Coord((box_.max().offsetBy(kReach)).asVec3i() * refine_).offsetBy(-1)};
}

double EditTrial::meanStep() const {
    double sum = 0;
    int count = 0;
    const CoordBBox box = rowBox();
    for (auto at = box.begin(); at; ++at)
        for (int a = 0; a < 3; ++a) {
            Coord next = *at;
            ++next[a];
            const double f = patchBefore_.lattice().at(*at), g = patchBefore_.lattice().at(next);
            if ((f < 0) == (g < 0)) continue;
            sum += std::abs(f - g);
            ++count;
        }
    return count > 0 ? sum / count : local_.K / 4;
}

// ---- signs to come

void EditTrial::foresee() {
    planned_ = rowBox();
    planned_.expand(refine_);
    marks_.reserve(static_cast<std::size_t>(planned_.volume()));
    for (auto at = planned_.begin(); at; ++at)
        marks_.push_back(patchBefore_.lattice().at(*at) < 0 ? kInside : 0);
    for (const Coord& c : plan_.points)
        for (auto at = CoordBBox(c.offsetBy(-refine_), c.offsetBy(refine_)).begin(); at; ++at)
            marks_[markIndex(*at)] |= kBeside;
    for (const Coord& c : plan_.points)
        marks_[markIndex(c)] = static_cast<std::uint8_t>(kPlanned | (plan_.fill ? kInside : 0));
}
std::size_t EditTrial::markIndex(const Coord& c) const {
    const Coord p = c - planned_.min(), size = planned_.dim();
    return (std::size_t(p[0]) * size[1] + p[1]) * size[2] + p[2];
}

bool EditTrial::mustKeep(const Coord& c, bool thicker) const {
    const std::uint8_t marks = marks_[markIndex(c)];
    if (marks & kPlanned) return false;
    return !thicker || bool(marks & kInside) == plan_.fill || !(marks & kBeside);
}

// ---- the change

std::optional<LocalEdit> EditTrial::attempt(const EditManner& manner, std::optional<int> euler) {
    if (!solve(manner, kFar * step_)) solve(manner, std::numeric_limits<double>::infinity());
    if (euler && !changesEulerBy(*euler)) return {};
    LocalEdit edit;
    edit.box = box_;
    for (auto known = local_.controlPoints->cbeginValueOn(); known; ++known)
        if (*known != before_->tree().getValue(known.getCoord()))
            edit.controlPoints.emplace_back(known.getCoord(), *known);
    if (edit.controlPoints.empty()) return {};
    edit.moved = moved();
    return edit;
}

double EditTrial::volumeGained(const LocalEdit& edit) const {
    BSplineField field = local_;
    field.controlPoints = before_;
    const double before = volumeOf(field, refine_);
    field.controlPoints = before_->deepCopy();
    auto values = field.controlPoints->getAccessor();
    for (const auto& [at, value] : edit.controlPoints) values.setValueOnly(at, value);
    return volumeOf(field, refine_) - before;
}

// Of a handle that goes: a speck or a bubble that comes or goes changes it, too, by that of a ball. Where a part is joined or a cavity
// opened, that is what is asked for.
bool EditTrial::changesEulerBy(int euler) const {
    constexpr std::int64_t kTwiceOfBall = 4;
    const std::int64_t change = patchAfter_.twiceEuler() - patchBefore_.twiceEuler() - 2 * euler;
    if (euler < 0) return change == 0;
    return change % kTwiceOfBall == 0 &&
           change == kTwiceOfBall * (patchAfter_.closedPieces() - patchBefore_.closedPieces());
}

double EditTrial::moved() const {
    const LatticeFunction &before = patchBefore_.lattice().function, &after = patchAfter_.lattice().function;
    const double each = local_.controlPoints->transform().baseMap()->determinant() / std::pow(refine_, 3);
    std::int64_t points = 0;
    for (std::size_t i = 0; i < before.values.size(); ++i)
        points += (before.values[i] < 0) != (after.values[i] < 0);
    return std::abs(each) * static_cast<double>(points);
}

// -> whether lattice points beyond `far`, which have no rows, kept their signs.
bool EditTrial::solve(const EditManner& manner, double far) {
    local_.controlPoints = before_->deepCopy();
    const std::vector<FieldRow> demands = rows(manner, far);
    if (plan_.whole) startBeyond(manner.margin);
    ascend(local_, demands, {.tolerance = tolerance_, .rounds = 20, .innerSweeps = 8});
    patchAfter_ = patch();
    return keepsFar(manner, far);
}

bool EditTrial::keepsFar(const EditManner& manner, double far) const {
    const CoordBBox box = rowBox();
    for (auto at = box.begin(); at; ++at) {
        const double before = patchBefore_.lattice().at(*at), after = patchAfter_.lattice().at(*at);
        if (std::abs(before) > far && (before < 0) != (after < 0) && mustKeep(*at, manner.thicker))
            return false;
    }
    return true;
}

// For parts as a whole; the rows then mend what is beside them.
void EditTrial::startBeyond(double margin) {
    const float value = static_cast<float>((plan_.fill ? -1.5 : 1.5) * margin * step_);
    for (auto known = local_.controlPoints->beginValueOn(); known; ++known)
        if (plan_.fill ? *known > value : *known < value) known.setValue(value);
}

std::vector<FieldRow> EditTrial::rows(const EditManner& manner, double far) const {
    std::vector<FieldRow> rows;
    for (const Vec3d& at : places_) rows.push_back(rowOf(at, plan_.fill, manner.margin * step_, 0));
    const CoordBBox box = rowBox();
    for (auto at = box.begin(); at; ++at) {
        const double f = patchBefore_.lattice().at(*at);
        if (std::abs(f) <= far && mustKeep(*at, manner.thicker))
            rows.push_back(keptSign((*at).asVec3d() / refine_, f));
        addCell(*at, manner.thicker, rows);
    }
    return rows;
}
// A sign is kept with as much of |F| as it has, up to a twentieth of a step, and surely beyond the tolerance.
FieldRow EditTrial::keptSign(const Vec3d& at, double f) const {
    return rowOf(at, f < 0, std::clamp(std::abs(f), 3 * tolerance_, 0.05 * step_),
                 kSoftness * refine_ * refine_ * refine_);
}

// Where the corners of a cell will leave a choice, F keeps its sign in the middle of its low faces and of itself.
void EditTrial::addCell(const Coord& low, bool thicker, std::vector<FieldRow>& rows) const {
    unsigned pattern = 0;
    bool beside = false;
    for (int c = 0; c < kCellCorners; ++c) {
        const std::uint8_t marks = marks_[markIndex(low.offsetBy(c & 1, c >> 1 & 1, c >> 2))];
        pattern |= static_cast<unsigned>(marks & kInside) << c;
        beside = beside || marks & kPlanned;
    }
    if (cellTable().isPlain(pattern) || (beside && thicker)) return;
    const Vec3d middle = low.asVec3d() + Vec3d(0.5);
    addKept(middle, rows);
    for (int a = 0; a < 3; ++a) {
        if (!(cellTable().ambiguousFaces(pattern) >> (2 * a) & 1)) continue;
        Vec3d face = middle;
        face[a] -= 0.5;
        addKept(face, rows);
    }
}
void EditTrial::addKept(const Vec3d& latticePlace, std::vector<FieldRow>& rows) const {
    const Vec3d at = latticePlace / refine_;
    if (std::find(plan_.places.begin(), plan_.places.end(), at) == plan_.places.end())
        rows.push_back(keptSign(at, evaluate(local_, at)));
}

// ---- put in

namespace {

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
