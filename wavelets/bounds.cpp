#include "wavelets/bounds.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>

namespace isowave::wavelets {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

// Takes what is smaller than `below` out of the details; returns how far each of them moved.
DetailGrid::Ptr takeOut(DetailGrid& details, double below, std::int64_t& count) {
    const DetailGrid::Ptr moved = details.deepCopy();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(details.tree());
    std::atomic<std::int64_t> taken{0};
    leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
        FloatLeaf& change = *moved->tree().probeLeaf(leaf.origin());
        std::int64_t here = 0;
        for (auto detail = leaf.beginValueOn(); detail; ++detail) {
            const float size = std::abs(*detail);
            const bool out = size < below;
            change.setValueOnly(detail.pos(), out ? size : 0.0f);
            if (out) detail.setValue(0.0f);
            here += out;
        }
        taken += here;
    });
    count += taken;
    return moved;
}

double largest(const openvdb::FloatGrid& bounds) {
    double result = 0;
    for (auto bound = bounds.cbeginValueOn(); bound; ++bound) result = std::max(result, double{*bound});
    return result;
}

// A bound of 0 for every control point of a field.
BSplineField unmoved(const BSplineField& field) {
    BSplineField bound;
    bound.K = 0;
    bound.shape = field.shape;
    bound.controlPoints = openvdb::FloatGrid::create(0.0f);
    bound.controlPoints->setTree(std::make_shared<openvdb::FloatTree>(field.controlPoints->tree(), 0.0f, 0.0f,
                                                                      openvdb::TopologyCopy()));
    bound.controlPoints->setTransform(field.transform().copy());
    return bound;
}

}  // namespace

DroppedDetails dropDetails(Pyramid& pyramid, std::span<const double> below, const Progress& progress) {
    assert(static_cast<int>(below.size()) == pyramid.stepCount());
    // The bounds themselves are stored as float32, rounded once a step; twice an ulp is enough for that.
    constexpr double kRounding = 1 + 2 * double{std::numeric_limits<float>::epsilon()};
    DroppedDetails result;
    result.bound.resize(below.size() + 1);
    BSplineField bound = unmoved(pyramid.coarsest);
    double rounding = 1;
    for (std::size_t s = below.size(); s-- > 0;) {
        progress("dropping details", double(below.size() - 1 - s) / double(below.size()));
        Step& step = pyramid.steps[s];
        step.details = step.details->deepCopy();  // others may hold on to them
        const DetailGrid::Ptr moved = takeOut(*step.details, below[s], result.dropped);
        result.details += static_cast<std::int64_t>(moved->activeVoxelCount());
        bound = boundDirection(bound, *moved, *step.shape, step.axis, progress);
        rounding *= kRounding;
        result.bound[s] = rounding * largest(*bound.controlPoints);
    }
    progress("dropping details", 1);
    return result;
}

}  // namespace isowave::wavelets
