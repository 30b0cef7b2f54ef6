#include "volume/walls/wall_fit.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "volume/padded_leaf.h"
#include "volume/row_ascent.h"
#include "volume/walls/between.h"
#include "volume/walls/feet.h"
#include "volume/walls/one_per_cell.h"
#include "volume/walls/thin_places.h"

// Notation, lengths in voxels: v the distance of a lattice point, p its foot, n the normal there, t the wall's
// thickness, half = sigma/(2 refine) what half a wall needs for the mesh's samples, e = max(0, half - t/2) by
// what each face of it is moved out. F in the field's units is F in voxels times `scale` = K/w.
// Passes: thin places -> faces (soft), signs and middles (hard) -> ascent -> hard rows alone -> shape.

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;

constexpr double kFaceReach = 0.75;  // lattice points so near have a row on the face
constexpr double kSignReach = 1.8;   // and so near, one on their sign
constexpr double kCell = 0.5;        // one face row in each
// rho of face rows. 0.01: 2 to 5 times the rounds, not nearer; 0.1: up to 3 % left at t = 1.
constexpr float kSoftness = 0.03F;
// The same for walls below kThin voxels: with 0.03 a wall of 0.35 in a tube is 5 % thicker.
constexpr float kThinSoftness = 0.003F;
constexpr double kThin = 0.6;
constexpr double kLeastValue = 1e-3;  // |F| that a sign row asks for, or |v|/2
// Between lattice points: how far from the mesh a wrong sign counts (0.1: bars of 0.6 come out 15 instead of 6 % thicker),
// how often these are looked for, |F| that their rows ask for, or |v|/8, and their rho (0, hard: a row of walls and gaps
// below what a spline can hold would push the others about).
constexpr double kBetween = 0.06;
constexpr double kFeather = 0.3;
constexpr int kMendingRounds = 6;
constexpr double kBetweenDepth = 0.02;
constexpr float kBetweenSoftness = 0.001F;
constexpr double kTolerance = 0.005;     // of F
constexpr double kHardTolerance = 1e-5;  // of F, hard rows alone

// How deep the middle of a wall or gap should lie: 0.1 t, or 0.16 t^2 where that is less. A parabola with zeros at
// +-t/2 that is curved as the spline of |z| lies t^2/8 to t^2/4 deep; to ask for more pushes the faces apart (walls of
// 0.3: 0.1 t makes them 39 % thicker), with less the samples of a mesh miss some places.
double depthOf(double t) { return std::min(0.1 * t, 0.16 * t * t); }

// Thickened walls are inside up to this share of half their thickness, everywhere: a hard row in each cell of 1/4 on
// either side holds them whole, and makes them thicker where it binds (1: 33 % for a tube of 0.23, 0.9: 25 %, 0.8: 20 %
// and 12 handles).
constexpr double kSide = 0.9;

class WallFit {
  public:
    WallFit(BSplineField& field, const openvdb::FloatTree& distance, const Coord& shift,
            const TriangleHierarchy& triangles, const WallFitOptions& options, const Progress& progress)
        : field_(field),
          distance_(distance),
          shift_(shift),
          triangles_(triangles),
          options_(options),
          progress_(progress),
          scale_(field.K / options.halfWidth),
          half_(options.sigma / (2.0 * options.refine)) {}

    WallFitReport run() {
        const ThinPlaces places = thinPlaces(distance_, triangles_, options_.widest, progress_);
        measure(places);
        if (places.near->empty()) return report_;
        progress_("walls", 0.3);
        addFaces(places);
        const std::size_t faces = rows_.size();
        addSigns(places);
        addMiddles(places);
        addGaps(places);
        progress_("walls", 0.5);
        ascendAll(faces);
        mendBetween(places);
        takeIn();
        progress_("walls", 1);
        return report_;
    }

  private:
    void measure(const ThinPlaces& places) {
        const auto& all = places.thicknesses;
        if (all.empty()) return;
        report_.thinnest = all[all.size() / 100];
        while (report_.leastRefine < 4 && options_.sigma / report_.leastRefine > report_.thinnest)
            report_.leastRefine *= 2;
    }

    FieldRow row(const Vec3d& at, double sign, double bound) const {
        return {at + shift_.asVec3d(), static_cast<float>(sign), static_cast<float>(bound * scale_)};
    }

    // The wall behind a foot if it is thinner than kThin or than what the mesh's samples need, else 0. Asked from so
    // deep: the other face of such a wall is nearer to there than this one.
    double thinBehind(const Vec3d& foot, const Vec3d& normal) const {
        const double deepest = std::max(kThin, 2 * half_);
        const double t = wallBehind(foot, normal, deepest, triangles_).thickness;
        return t < deepest ? t : 0;
    }
    // By what it is to stand out of its face.
    double outBy(double thin) const { return thin > 0 ? std::max(0.0, half_ - thin / 2) : 0; }

    // Whether the gap before a foot is too thin for the mesh's samples.
    bool isClosed(const Vec3d& foot, const Vec3d& normal) const {
        const double gap = wallBehind(foot, -normal, 2 * half_, triangles_).thickness;
        return gap > 0 && gap < 2 * half_;
    }

    // Lattice points of the mask that are nearer than `reach`.
    openvdb::MaskTree nearer(const openvdb::MaskTree& mask, double reach) const {
        openvdb::MaskTree result(mask);
        openvdb::tree::LeafManager<openvdb::MaskTree> leaves(result);
        leaves.foreach ([this, reach](MaskLeaf& leaf, std::size_t) {
            const openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(distance_);
            for (auto point = leaf.beginValueOn(); point; ++point)
                if (std::abs(values.getValue(point.getCoord())) > reach) leaf.setValueOff(point.pos());
        });
        return result;
    }

    void addFaces(const ThinPlaces& places) {
        const Feet feet(nearer(*places.near, kFaceReach), distance_, triangles_, kFaceReach, progress_);
        std::vector<Foot> there = feet.all();
        std::erase_if(there, [](const Foot& foot) { return !foot.isThere(); });
        there = onePerCell(
            there, kCell, [](const Foot& foot) { return foot.at; },
            [](const Foot& foot) { return std::abs(foot.distance); });
        std::vector<char> closed(there.size());
        rows_.resize(there.size());
        tbb::parallel_for(std::size_t(0), there.size(), [&](std::size_t i) {
            const Vec3d foot(there[i].at), normal(there[i].normal);
            const double thin = thinBehind(foot, normal);
            closed[i] = isClosed(foot, normal);
            rows_[i] = row(foot + normal * outBy(thin), 1, 0);
            rows_[i].rho = thin > 0 && thin < kThin ? kThinSoftness : kSoftness;
            rows_[i].equal = true;
        });
        std::size_t kept = 0;
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (!closed[i]) rows_[kept++] = rows_[i];
        rows_.resize(kept);
    }

    // Whether a lattice point outside may come to lie in a thickened wall or a closed gap.
    bool isTakenIn(const Vec3d& x, double v) const {
        if (v <= 0 || v > half_) return false;
        const auto nearest = triangles_.nearest(x, {half_ * half_ + 1e-6, -1});
        if (nearest.triangle < 0) return false;
        const Vec3d foot = triangles_.footOn(nearest.triangle, x);
        Vec3d normal = triangles_.areaNormal(nearest.triangle);
        if (!normal.normalize()) return false;
        if (normal.dot(x - foot) < 0) normal = -normal;
        return v <= outBy(thinBehind(foot, normal)) || isClosed(foot, normal);
    }

    void addSigns(const ThinPlaces& places) {
        const openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(distance_);
        for (auto leaf = places.near->cbeginLeaf(); leaf; ++leaf)
            for (auto point = leaf->cbeginValueOn(); point; ++point) {
                const Coord c = point.getCoord();
                const double v = values.getValue(c), size = std::abs(v);
                if (size >= kSignReach) continue;
                if (isTakenIn(c.asVec3d(), v))
                    takenIn_.push_back(c + shift_);
                else
                    rows_.push_back(row(c.asVec3d(), v < 0 ? 1 : -1, std::min(kLeastValue, size / 2)));
            }
    }

    // The shape follows the field where a thickened wall passed a lattice point.
    void takeIn() {
        auto shape = field_.shape->getUnsafeAccessor();
        for (const Coord& c : takenIn_) {
            if (evaluate(field_, c.asVec3d()) >= 0 || !shape.isValueOn(c)) continue;
            shape.setValueOnly(c, true);
            ++report_.thickened;
        }
    }

    void addMiddles(const ThinPlaces& places) {
        for (const WallMiddle& m : places.middles) {
            rows_.push_back(row(m.at, 1, depthOf(std::max(m.thickness, 2 * half_))));
            if (m.thickness >= 2 * half_) continue;
            for (const double side : {kSide * half_, -kSide * half_})
                rows_.push_back(row(m.at + m.normal * side, 1, 0));
        }
    }

    void addGaps(const ThinPlaces& places) {
        for (const WallMiddle& m : places.gaps) {
            const bool isOpen = m.thickness > 2 * half_;
            rows_.push_back(row(m.at, isOpen ? -1 : 1, depthOf(isOpen ? m.thickness : 2 * half_)));
        }
    }

    void ascendAll(std::size_t faces) {
        const auto options = [this](double tolerance) {
            return AscentOptions{.tolerance = tolerance * scale_, .rounds = options_.rounds};
        };
        report_.rows = static_cast<std::int64_t>(rows_.size());
        const AscentReport all = ascend(field_, rows_, options(kTolerance), progress_);
        progress_("walls", 0.8);
        rows_.erase(rows_.begin(), rows_.begin() + std::ptrdiff_t(faces));
        const AscentReport hard = ascend(field_, rows_, options(kHardTolerance), progress_);
        report_.sweeps = all.rounds + hard.rounds;
        report_.unmet = hard.unmet;
        report_.changed = std::max(all.changed, hard.changed);
    }

    // Whether the thickened walls and the closed gaps have a place outside the mesh inside.
    // The faces of a thin gap, or of a wall that ends in an edge, cannot all be where they should: the thinner, the more
    // is left.
    bool isTolerable(const WrongPlace& p) const {
        const Vec3d beyond = p.inside ? Vec3d(-p.outwards) : p.outwards;
        const double t = wallBehind(p.foot, beyond, 1.0, triangles_).thickness;
        const double widest = p.inside ? 1.0 : kFeather, more = p.inside ? 0.2 : 0.1;
        return t > 0 && t < widest && p.distance < kBetween + more * (1 - t);
    }
    bool isMeantInside(const WrongPlace& p) const {
        return !p.inside &&
               (p.distance <= outBy(thinBehind(p.foot, p.outwards)) || isClosed(p.foot, p.outwards));
    }

    // Signs that are still wrong between lattice points, where walls meet and at the mouths of slots: a row each, round by
    // round near those of the last one.
    void mendBetween(const ThinPlaces& places) {
        if (!options_.between) return;
        openvdb::MaskTree near = nearer(*places.near, kSignReach);
        std::vector<WrongPlace> wrong = wrongIn(near);
        for (int round = 0; round < kMendingRounds && !wrong.empty(); ++round) {
            const openvdb::MaskTree around = leavesAround(wrong);
            for (const WrongPlace& p : wrong) {
                rows_.push_back(row(p.at, p.inside ? 1 : -1, std::min(kBetweenDepth, p.distance / 8)));
                rows_.back().rho = kBetweenSoftness;
            }
            report_.between += std::int64_t(wrong.size());
            const AscentReport mended =
                ascend(field_, rowsIn(around),
                       {.tolerance = kHardTolerance * scale_, .rounds = options_.rounds}, progress_);
            report_.changed = std::max(report_.changed, mended.changed);
            near.topologyIntersection(around);
            wrong = wrongIn(near);
        }
    }

    std::vector<WrongPlace> wrongIn(const openvdb::MaskTree& near) const {
        std::vector<WrongPlace> wrong =
            wrongPlaces(field_, shift_, near, *options_.between, triangles_, kBetween, progress_);
        std::erase_if(wrong, [this](const WrongPlace& p) { return isMeantInside(p) || isTolerable(p); });
        return wrong;
    }

    // The leaves that hold these places, and those beside them.
    static openvdb::MaskTree leavesAround(const std::vector<WrongPlace>& places) {
        openvdb::MaskTree around;
        for (const WrongPlace& p : places) {
            const Coord origin = Coord::floor(p.at) & ~7;
            around.fill({origin.offsetBy(-8), origin.offsetBy(15)}, true);
        }
        around.voxelizeActiveTiles();
        return around;
    }

    std::vector<FieldRow> rowsIn(const openvdb::MaskTree& mask) const {
        std::vector<FieldRow> rows;
        const openvdb::tree::ValueAccessor<const openvdb::MaskTree> accessor(mask);
        for (const FieldRow& row : rows_)
            if (accessor.isValueOn(Coord::floor(row.at) - shift_)) rows.push_back(row);
        return rows;
    }

    BSplineField& field_;
    const openvdb::FloatTree& distance_;
    Coord shift_;
    const TriangleHierarchy& triangles_;
    const WallFitOptions& options_;
    const Progress& progress_;
    double scale_, half_;
    std::vector<FieldRow> rows_;
    std::vector<Coord> takenIn_;  // outside in the mesh, perhaps inside a thickened wall; of the field
    WallFitReport report_;
};

}  // namespace

WallFitReport fitWalls(BSplineField& field, const openvdb::FloatTree& distance, const Coord& shift,
                       const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles,
                       const WallFitOptions& options, const Progress& progress) {
    if (triangles.empty()) return {};
    progress("walls", 0);
    return WallFit(field, distance, shift, TriangleHierarchy(points, triangles), options, progress).run();
}

}  // namespace isowave
