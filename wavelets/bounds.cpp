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

// Takes what is smaller than `below` out of the details; returns what was taken out.
DetailGrid::Ptr takeOut(DetailGrid& details, double below, std::int64_t& count) {
    const DetailGrid::Ptr out = details.deepCopy();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(details.tree());
    std::atomic<std::int64_t> taken{0};
    leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
        FloatLeaf& outLeaf = *out->tree().probeLeaf(leaf.origin());
        std::int64_t here = 0;
        for (auto detail = leaf.beginValueOn(); detail; ++detail) {
            const bool small = std::abs(*detail) < below;
            if (small)
                detail.setValue(0.0f);
            else
                outLeaf.setValueOnly(detail.pos(), 0.0f);
            here += small;
        }
        taken += here;
    });
    count += taken;
    return out;
}

double largest(const openvdb::FloatGrid& grid) {
    double result = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        result = std::max(result, std::abs(double{*value}));
    return result;
}

// Zeros for the control points of a field.
BSplineField zerosLike(const BSplineField& field) {
    BSplineField zeros;
    zeros.K = 0;
    zeros.shape = field.shape;
    zeros.controlPoints = openvdb::FloatGrid::create(0.0f);
    zeros.controlPoints->setTree(std::make_shared<openvdb::FloatTree>(field.controlPoints->tree(), 0.0f, 0.0f,
                                                                      openvdb::TopologyCopy()));
    zeros.controlPoints->setTransform(field.transform().copy());
    return zeros;
}

}  // namespace

DroppedDetails dropDetails(Pyramid& pyramid, std::span<const double> below, const Progress& progress) {
    pyramid.exact = nullptr;  // step 0 becomes another one
    assert(static_cast<int>(below.size()) == pyramid.stepCount());
    // The bounds themselves are stored as float32, rounded once a step; twice an ulp is enough for that.
    constexpr double kRounding = 1 + 2 * double{std::numeric_limits<float>::epsilon()};
    DroppedDetails result;
    result.moved.resize(below.size() + 1);
    result.bound.resize(below.size() + 1);
    BSplineField bound = zerosLike(pyramid.coarsest), change = bound;
    double rounding = 1;
    for (std::size_t s = below.size(); s-- > 0;) {
        progress("dropping details", double(below.size() - 1 - s) / double(below.size()));
        Step& step = pyramid.steps[s];
        step.details = step.details->deepCopy();  // others may hold on to them
        const DetailGrid::Ptr out = takeOut(*step.details, below[s], result.dropped);
        result.details += static_cast<std::int64_t>(out->activeVoxelCount());
        // Synthesis is linear but for the accessory values, which are the same with and without: the field
        // moves by the synthesis of what was taken out, with K = 0.
        change = synthesiseDirection(change, *out, *step.shape, step.axis, progress);
        bound = boundDirection(bound, *out, *step.shape, step.axis, progress);
        rounding *= kRounding;
        result.moved[s] = largest(*change.controlPoints);
        result.bound[s] = rounding * largest(*bound.controlPoints);
    }
    progress("dropping details", 1);
    return result;
}

}  // namespace isowave::wavelets
