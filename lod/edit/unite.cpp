#include "lod/edit/unite.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "polygonize/polygonize.h"
#include "volume/leaf_words.h"
#include "volume/mesh_nearest.h"
#include "volume/padded_leaf.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;
using Floats = openvdb::FloatTree;
using FloatLeaf = Floats::LeafNodeType;
using Mask = openvdb::MaskTree;
constexpr int kLeaf = FloatLeaf::DIM;

// Of w: less than this is no change, but rounding, or what wavelets leave of a plateau.
constexpr double kLeastChange = 1e-4;

// Distance from the solid's surface farther than w, where F does not tell it.
class SolidDistance {
  public:
    SolidDistance(const BSplineField& field, double most, const Progress& progress)
        : most_(most), lattice_(field.transform().copy()) {
        const TriangleMesh mesh = polygonize(field, {}, progress);
        std::vector<openvdb::Vec3d> points;
        points.reserve(mesh.points.size());
        for (const Point& p : mesh.points) points.push_back(lattice_->worldToIndex(openvdb::Vec3d(p.data())));
        if (!mesh.triangles.empty())
            mesh_ = std::make_unique<const TriangleHierarchy>(points, mesh.triangles);
    }

    // u: of F, cut at w. Up to half of w it is the distance, from nine tenths on the mesh tells; between them a mean does.
    double at(const Coord& point, double u, double w) const {
        const double share = std::clamp((std::abs(u) / w - 0.5) / 0.4, 0.0, 1.0);
        if (share == 0 || !mesh_) return u;
        const double far = std::sqrt(mesh_->nearest(point.asVec3d(), {most_ * most_, -1}).squared);
        return (1 - share) * u + share * std::copysign(far, u);
    }

  private:
    double most_;
    openvdb::math::Transform::ConstPtr lattice_;
    std::unique_ptr<const TriangleHierarchy> mesh_;
};

// What becomes of a leaf's values.
struct LeafResult {
    bool changed = false;
    bool full = false;  // the operand fills it: u' = -w everywhere
    LeafWords touched{};
    std::array<float, 512> values;  // F', where changed
};

class Union {
  public:
    Union(const BSplineField& field, const Operand& operand, const UniteOptions& options,
          const Progress& progress)
        : c_(field.controlPoints->constTree()),
          operand_(operand),
          options_(options),
          sign_(options.cut ? -1 : 1),
          scale_(field.K / options.voxelsPerK),
          w_(options.voxelsPerK) {
        if (options.radius > 0)
            solid_ = std::make_unique<const SolidDistance>(field, reachOf(options), progress);
    }

    Change run(const Progress& progress) {
        const std::vector<Coord> origins = operand_.leaves(progress);
        progress("editing", 0);
        std::vector<std::unique_ptr<LeafResult>> results(origins.size());
        tbb::parallel_for(std::size_t(0), origins.size(),
                          [&](std::size_t i) { results[i] = at(origins[i]); });
        progress("editing", 0.5);
        Change change;
        change.fill = static_cast<float>(-sign_ * w_ * scale_);
        put(origins, results, change);
        refit(change);
        progress("editing", 1);
        return change;
    }

  private:
    std::unique_ptr<LeafResult> at(const Coord& origin) const {
        LeafValues T;
        const Operand::Side side = operand_.values(origin, T);
        if (side == Operand::Side::outside) return nullptr;
        const bool uniform = !c_.probeConstLeaf(origin);
        if (side == Operand::Side::inside) {
            if (uniform && sign_ * c_.getValue(origin) < 0) return nullptr;
            T.fill(-w_);
        }
        auto result = std::make_unique<LeafResult>();
        result->full = side == Operand::Side::inside && !solid_;
        const std::array<double, 512> F = valuesOf(c_, origin);
        for (std::size_t n = 0; n < F.size(); ++n) {
            const double u = std::clamp(sign_ * F[n] / scale_, -w_, w_);
            const double united = unite(u, T[n], origin + FloatLeaf::offsetToLocalCoord(openvdb::Index(n)));
            const bool touched = std::abs(united - u) > kLeastChange * w_;
            result->touched[n >> 6] |= std::uint64_t(touched) << (n & 63);
            result->changed = result->changed || touched;
            result->values[n] = static_cast<float>(touched ? sign_ * scale_ * united : F[n]);
        }
        return result->changed || result->full ? std::move(result) : nullptr;
    }

    double unite(double u, double T, const Coord& point) const {
        const double r = options_.radius;
        if (r > 0 && -w_ < T && T < r && -w_ < u) {
            const double d = solid_->at(point, u, w_);
            if (d < r) return std::clamp(std::max(r, std::min(d, T)) - std::hypot(r - d, r - T), -w_, w_);
        }
        return std::min(u, std::clamp(T, -w_, w_));
    }

    // Leaves with their neighbours all full are filled; of the others the values are kept, and which of them changed.
    void put(const std::vector<Coord>& origins, std::vector<std::unique_ptr<LeafResult>>& results,
             Change& change) {
        Mask full;
        for (std::size_t i = 0; i < origins.size(); ++i)
            if (results[i] && results[i]->full) full.addTile(1, origins[i], true, true);
        const auto isDeep = [&](const Coord& origin) {
            for (int b = 0; b < 27; ++b)
                if (!full.isValueOn(
                        origin.offsetBy(kLeaf * (b / 9 - 1), kLeaf * (b / 3 % 3 - 1), kLeaf * (b % 3 - 1))))
                    return false;
            return true;
        };
        for (std::size_t i = 0; i < origins.size(); ++i) {
            if (!results[i]) continue;
            if (results[i]->full && isDeep(origins[i])) {
                change.filled.push_back(origins[i]);
                values_.addTile(1, origins[i], change.fill, false);
            } else {
                auto leaf = std::make_unique<FloatLeaf>(origins[i], 0.0f, false);
                std::copy(results[i]->values.begin(), results[i]->values.end(), leaf->buffer().data());
                leaf->setValueMask(maskOf(results[i]->touched));
                values_.addLeaf(leaf.release());
            }
            results[i].reset();
        }
    }

    // Values around those that changed: of F.
    void addSurroundings(const Mask& changed) {
        const Mask around = dilated(changed, 2);
        std::vector<FloatLeaf*> made;
        for (auto leaf = around.cbeginLeaf(); leaf; ++leaf) {
            if (values_.probeConstLeaf(leaf->origin())) continue;
            const bool deep = values_.getValue(leaf->origin()) != 0;
            FloatLeaf* there = values_.touchLeaf(leaf->origin());
            if (!deep) made.push_back(there);
        }
        tbb::parallel_for(std::size_t(0), made.size(), [&](std::size_t i) {
            const std::array<double, 512> F = valuesOf(c_, made[i]->origin());
            for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n)
                made[i]->setValueOnly(n, static_cast<float>(F[n]));
        });
    }

    // Quasi-interpolation: on each axis c = (8 v_i - v_{i-1} - v_{i+1})/6, as in the fit.
    void refit(Change& change) {
        const Mask changed(values_, false, openvdb::TopologyCopy());
        addSurroundings(changed);
        const Mask touched = dilated(changed, 1);
        std::vector<const Mask::LeafNodeType*> leaves;
        for (auto leaf = touched.cbeginLeaf(); leaf; ++leaf)
            if (!leaf->isEmpty()) leaves.push_back(&*leaf);
        std::vector<std::unique_ptr<FloatLeaf>> made(leaves.size());
        tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
            PaddedLeaf<double, 1, 1> v;
            v.gather(openvdb::tree::ValueAccessor<const Floats, false>(values_), leaves[i]->origin());
            std::array<double, 512> c;
            filterThreeTaps(v, 8.0 / 6, -1.0 / 6, c);
            made[i] = std::make_unique<FloatLeaf>(leaves[i]->origin(), 0.0f, false);
            std::copy(c.begin(), c.end(), made[i]->buffer().data());
            made[i]->setValueMask(leaves[i]->getValueMask());
        });
        for (auto& leaf : made) change.controlPoints.addLeaf(leaf.release());
    }

    const Floats& c_;
    const Operand& operand_;
    UniteOptions options_;
    double sign_, scale_, w_;
    std::unique_ptr<const SolidDistance> solid_;
    Floats values_{0.0f};  // F' where it is known here; active: other than F
};

}  // namespace

double reachOf(const UniteOptions& options) { return std::max(options.voxelsPerK, options.radius) + 1; }

Change unite(const BSplineField& field, const Operand& operand, const UniteOptions& options,
             const Progress& progress) {
    return Union(field, operand, options, progress).run(progress);
}

}  // namespace isowave::lod
