// Passes: locate (the samples by the leaf that their first control point lies in) -> sweep: gather a leaf's
// control points and those beside it -> value, and shares of numerator and denominator -> add them up, leaf
// by leaf -> move. Leaves whose origins are two leaves apart on an axis, or more, share no control point:
// eight colours, and within a colour no two threads write to the same place, in an order that is always the
// same.
#include "polygonize/refit.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "base/triangle.h"
#include "volume/cubic_weights.h"
#include "volume/padded_leaf.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using DoubleLeaf = openvdb::DoubleTree::LeafNodeType;
using Block = PaddedLeaf<double, 0, 3>;  // a leaf and what samples in its last nodes reach beyond it

// In index space; the sample's first control point is floor(at) - 1.
struct Located {
    Coord leaf;  // origin of the leaf of that control point
    Vec3d at;
    double area;
};

Coord firstOf(const Vec3d& at) { return Coord::floor(at).offsetBy(-1); }
int colourOf(const Coord& leaf) {
    return (leaf[0] >> 3 & 1) * 4 + (leaf[1] >> 3 & 1) * 2 + (leaf[2] >> 3 & 1);
}

// Samples of one leaf, which lie one behind the other.
struct Range {
    std::size_t begin, end;
};

// By colour.
std::array<std::vector<Range>, 8> rangesOf(const std::vector<Located>& samples) {
    std::array<std::vector<Range>, 8> ranges;
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
        while (end < samples.size() && samples[end].leaf == samples[begin].leaf) ++end;
        ranges[colourOf(samples[begin].leaf)].push_back({begin, end});
    }
    return ranges;
}

std::vector<Located> locate(const std::vector<SurfaceSample>& surface, const BSplineField& level) {
    std::vector<Located> samples(surface.size());
    tbb::parallel_for(std::size_t{0}, surface.size(), [&](std::size_t i) {
        const Vec3d at = level.transform().worldToIndex(surface[i].at);
        samples[i] = {firstOf(at) & ~7, at, surface[i].area};
    });
    // By all that a sample is: equal ones may come in any order.
    const auto key = [](const Located& s) { return std::tuple(s.leaf, s.at[0], s.at[1], s.at[2], s.area); };
    tbb::parallel_sort(samples.begin(), samples.end(),
                       [&key](const Located& a, const Located& b) { return key(a) < key(b); });
    return samples;
}

// The numerators and denominators of the control points, in leaves beside the field's own.
class Shares {
  public:
    explicit Shares(const openvdb::FloatTree& field)
        : residual_(field, 0.0, openvdb::TopologyCopy()), weight_(field, 0.0, openvdb::TopologyCopy()) {}

    void add(const Coord& leaf, const Block& residual, const Block& weight) {
        for (int b = 0; b < 8; ++b) {
            const Coord origin = leaf.offsetBy(8 * (b >> 2), 8 * (b >> 1 & 1), 8 * (b & 1));
            DoubleLeaf* to = residual_.probeLeaf(origin);
            if (!to) continue;
            DoubleLeaf* toWeight = weight_.probeLeaf(origin);
            const Coord low = origin - leaf;
            const auto high = [&low](int axis) { return low[axis] == 0 ? 8 : 3; };
            for (int x = 0; x < high(0); ++x)
                for (int y = 0; y < high(1); ++y)
                    for (int z = 0; z < high(2); ++z) {
                        const auto at = static_cast<openvdb::Index>(64 * x + 8 * y + z);
                        const int from = Block::index(low[0] + x, low[1] + y, low[2] + z);
                        to->setValueOnly(at, to->getValue(at) + residual.values[from]);
                        toWeight->setValueOnly(at, toWeight->getValue(at) + weight.values[from]);
                    }
        }
    }

    // c - residual / weight, where there is any.
    void move(FloatLeaf& leaf) const {
        const DoubleLeaf* residual = residual_.probeConstLeaf(leaf.origin());
        const DoubleLeaf* weight = weight_.probeConstLeaf(leaf.origin());
        for (auto known = leaf.beginValueOn(); known; ++known)
            if (const double w = weight->getValue(known.pos()); w > 0)
                known.setValue(static_cast<float>(*known - residual->getValue(known.pos()) / w));
    }

  private:
    openvdb::DoubleTree residual_, weight_;
};

// reach: in units of the field.
void addShares(const Located* begin, const Located* end, const openvdb::FloatTree& field, double reach,
               Shares& shares) {
    const openvdb::tree::ValueAccessor<const openvdb::FloatTree> accessor(field);
    Block c, residual, weight;
    c.gather(accessor, begin->leaf);
    residual.values.fill(0);
    weight.values.fill(0);
    for (const Located* sample = begin; sample != end; ++sample) {
        const Coord first = firstOf(sample->at), low = first - sample->leaf;
        std::array<std::array<double, 4>, 3> B;
        for (int axis = 0; axis < 3; ++axis) B[axis] = cubicWeights(sample->at[axis] - (first[axis] + 1));
        const auto each = [&](const auto& act) {
            for (int x = 0; x < 4; ++x)
                for (int y = 0; y < 4; ++y)
                    for (int z = 0; z < 4; ++z)
                        act(Block::index(low[0] + x, low[1] + y, low[2] + z), B[0][x] * B[1][y] * B[2][z]);
        };
        double F = 0;
        each([&](int i, double b) { F += b * c.values[i]; });
        if (std::abs(F) > reach) continue;
        each([&](int i, double b) {
            residual.values[i] += sample->area * b * F;
            weight.values[i] += sample->area * b;
        });
    }
    shares.add(begin->leaf, residual, weight);
}

}  // namespace

std::vector<SurfaceSample> surfaceSamples(const TriangleMesh& mesh) {
    std::vector<SurfaceSample> samples(mesh.triangles.size());
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        const Triangle& t = mesh.triangles[i];
        const Vec3d a(mesh.points[t[0]].data()), b(mesh.points[t[1]].data()), c(mesh.points[t[2]].data());
        samples[i] = {(a + b + c) / 3, length(areaNormal(mesh, t)) / 2};
    });
    return samples;
}

BSplineField refitted(const BSplineField& level, const std::vector<SurfaceSample>& surface,
                      const RefitOptions& options, const Progress& progress) {
    const std::vector<Located> samples = locate(surface, level);
    const std::array<std::vector<Range>, 8> colours = rangesOf(samples);
    BSplineField field = level;
    field.controlPoints = level.controlPoints->deepCopy();
    openvdb::FloatTree& tree = field.controlPoints->tree();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(tree);
    for (int sweep = 0; sweep < options.sweeps; ++sweep) {
        progress("fitting to level 0", static_cast<double>(sweep) / options.sweeps);
        Shares shares(tree);
        for (const std::vector<Range>& ranges : colours)
            tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t i) {
                progress.check();
                addShares(&samples[ranges[i].begin], samples.data() + ranges[i].end, tree,
                          options.reach * field.K, shares);
            });
        leaves.foreach ([&shares](FloatLeaf& leaf, std::size_t) { shares.move(leaf); });
    }
    return field;
}

}  // namespace isowave
