#include "compress/field_points.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "isowave/error.h"
#include "volume/leaf_words.h"
#include "volume/tiles.h"

namespace isowave::compress {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

BitBox knownOf(const BSplineField& field, const openvdb::CoordBBox& box, const Size& size) {
    BitBox known(size);
    for (auto value = field.controlPoints->cbeginValueOn(); value; ++value) {
        openvdb::CoordBBox some;
        value.getBoundingBox(some);
        for (auto p = some.begin(); p; ++p) {
            const openvdb::Coord q = *p - box.min();
            known.set(q.x(), q.y(), q.z());
        }
    }
    return known;
}

// Everything of the planes x, each by one thread.
template <class Plane>
void forEachPlane(int planes, const Progress& progress, const Plane& plane) {
    tbb::parallel_for(0, planes, [&](int x) {
        progress.check();
        plane(x);
    });
}

void takeValues(const BSplineField& field, FieldPoints& points, const Progress& progress) {
    const Lattice& lattice = points.lattice;
    points.c.resize(lattice.pointCount());
    points.inside.resize(lattice.pointCount());
    forEachPlane(lattice.size[0], progress, [&](int x) {
        auto value = field.controlPoints->getConstAccessor();
        auto inside = field.shape->getConstAccessor();
        for (int y = 0; y < lattice.size[1]; ++y)
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                 i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i) {
                const openvdb::Coord p = points.origin.offsetBy(x, y, lattice.z[i]);
                points.c[i] = value.getValue(p);
                points.inside[i] = inside.getValue(p);
            }
    });
}

// inside at every point of the box, unknown ones by the rule
BitBox insideOf(const FieldPoints& points) {
    const Lattice& lattice = points.lattice;
    BitBox inside(lattice.size);
    forEachPlane(lattice.size[0], {}, [&](int x) {
        for (int y = 0; y < lattice.size[1]; ++y) {
            const std::size_t last = lattice.rowStart[lattice.rowOf(x, y) + 1];
            for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)]; i < last; ++i) {
                if (!points.inside[i]) continue;
                const int end = i + 1 < last ? lattice.z[i + 1] : lattice.z[i] + 1;
                for (int z = lattice.z[i]; z < end; ++z) inside.set(x, y, z);
            }
        }
    });
    return inside;
}

void requireRule(const BSplineField& field, const FieldPoints& points, const std::string& name,
                 const Progress& progress) {
    const BitBox inside = insideOf(points);
    const auto K = static_cast<float>(points.K);
    std::atomic<std::int64_t> wrong = 0;
    forEachPlane(points.lattice.size[0], progress, [&](int x) {
        auto value = field.controlPoints->getConstAccessor();
        auto sign = field.shape->getConstAccessor();
        std::int64_t here = 0;
        for (int y = 0; y < points.lattice.size[1]; ++y)
            for (int z = 0; z < points.lattice.size[2]; ++z) {
                const openvdb::Coord p = points.origin.offsetBy(x, y, z);
                float c = 0;
                if (value.probeValue(p, c)) continue;
                const bool in = inside.get(x, y, z);
                here += sign.getValue(p) != in || c != (in ? -K : K);
            }
        wrong += here;
    });
    if (wrong > 0)
        throw InputError(
            name, fmt::format("the signs of {} lattice points away from its surface do not follow from its "
                              "control points, so it cannot be packed; keep it as a pyramid (analyse)",
                              wrong.load()));
}

void requireSize(const openvdb::CoordBBox& box, const std::string& name) {
    if (box.empty()) throw InputError(name, "has no surface; nothing to pack");
    double count = 1;
    for (int a = 0; a < 3; ++a) count *= static_cast<double>(box.max()[a]) - box.min()[a] + 1;
    if (count > kMostBoxPoints)
        throw InputError(
            name, fmt::format("its control points lie in a box of {:.3g} lattice points, and at most {:.3g} "
                              "can be packed; crop it, or take larger voxels",
                              count, kMostBoxPoints));
}

// ---- back to grids

class Grids {
  public:
    explicit Grids(const FieldPoints& points) : points_(points), inside_(insideOf(points)) {}

    BSplineField make() const {
        const auto K = static_cast<float>(points_.K);
        BSplineField field;
        field.K = points_.K;
        field.controlPoints = openvdb::FloatGrid::create(K);
        field.controlPoints->setName("field");
        putLeaves(field.controlPoints->tree());
        openvdb::FloatTree& tree = field.controlPoints->tree();
        fillTiles(tree, [&] { return [&](const openvdb::Coord& p) { return insideAt(p) ? -K : K; }; });
        field.shape =
            Shape::create(std::make_shared<openvdb::BoolTree>(tree, false, openvdb::TopologyCopy()));
        openvdb::tree::LeafManager<openvdb::BoolTree> leaves(field.shape->tree());
        leaves.foreach ([&](auto& leaf, std::size_t) { setInside(leaf, wordsAt(leaf.origin())); });
        fillTiles(field.shape->tree(), [&] { return [&](const openvdb::Coord& p) { return insideAt(p); }; });
        field.controlPoints->setTransform(points_.transform->copy());
        field.shape->setTransform(points_.transform->copy());
        return field;
    }

  private:
    bool insideAt(const openvdb::Coord& p) const {
        const openvdb::Coord q = p - points_.origin;
        const Size& n = inside_.size();
        return q.x() >= 0 && q.y() >= 0 && q.z() >= 0 && q.x() < n[0] && q.y() < n[1] && q.z() < n[2] &&
               inside_.get(q.x(), q.y(), q.z());
    }
    LeafWords wordsAt(const openvdb::Coord& origin) const {
        LeafWords words{};
        for (int x = 0; x < 8; ++x)
            for (int b = 0; b < 64; ++b)
                words[static_cast<std::size_t>(x)] |=
                    std::uint64_t{insideAt(origin.offsetBy(x, b / 8, b % 8))} << b;
        return words;
    }
    void putLeaves(openvdb::FloatTree& tree) const {
        const Lattice& lattice = points_.lattice;
        openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(tree);
        for (int x = 0; x < lattice.size[0]; ++x)
            for (int y = 0; y < lattice.size[1]; ++y)
                for (std::size_t i = lattice.rowStart[lattice.rowOf(x, y)];
                     i < lattice.rowStart[lattice.rowOf(x, y) + 1]; ++i)
                    accessor.setValue(points_.origin.offsetBy(x, y, lattice.z[i]), points_.c[i]);
        const auto K = static_cast<float>(points_.K);
        openvdb::tree::LeafManager<openvdb::FloatTree> leaves(tree);
        leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
            for (auto value = leaf.beginValueOff(); value; ++value)
                value.setValue(insideAt(value.getCoord()) ? -K : K);
        });
    }

    const FieldPoints& points_;
    BitBox inside_;
};

}  // namespace

FieldPoints fieldPointsOf(const BSplineField& field, const std::string& name, const Progress& progress) {
    const auto box = field.controlPoints->evalActiveVoxelBoundingBox();
    requireSize(box, name);
    const openvdb::Coord dim = box.dim();
    const BitBox known = knownOf(field, box, {dim.x(), dim.y(), dim.z()});
    FieldPoints points;
    points.origin = box.min();
    if (dim.x() > 3 && dim.y() > 3 && dim.z() > 3) points.nodes = nodesOf(known);
    if (!(pointsOf(points.nodes) == known))
        throw InputError(name, "has control points that belong to no node, so it cannot be packed");
    points.lattice = Lattice(known);
    points.K = field.K;
    points.transform = field.transform().copy();
    takeValues(field, points, progress);
    requireRule(field, points, name, progress);
    return points;
}

BSplineField fieldOf(const FieldPoints& points) { return Grids(points).make(); }

}  // namespace isowave::compress
