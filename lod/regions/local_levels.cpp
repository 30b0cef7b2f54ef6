#include "lod/regions/local_levels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "polygonize/quadric_collapse.h"

namespace isowave::lod {
namespace {

// each(begin, end), in parallel.
template <class Each>
void forRanges(std::size_t count, const Progress& progress, const Each& each) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
        progress.check();
        each(range.begin(), range.end());
    });
}

// i times 2^halvings, cut where an int ends: a damaged file may halve an axis any number of times.
int timesTwo(int i, int halvings) {
    constexpr double kMost = std::numeric_limits<int>::max();
    return static_cast<int>(std::clamp(std::ldexp(double(i), halvings), -kMost, kMost));
}

int stepsBetween(const Halvings& finer, const Halvings& coarser) {
    return coarser[0] - finer[0] + coarser[1] - finer[1] + coarser[2] - finer[2];
}

}  // namespace

LocalLevels::LocalLevels(std::vector<Stage> regions, Stage own) : stages_(std::move(regions)) {
    stages_.push_back(std::move(own));
}

std::vector<LocalLevels::PointPlace> LocalLevels::pointPlaces(const TriangleMesh& mesh,
                                                              const Progress& progress) const {
    const auto own = static_cast<char>(stages_.size() - 1);
    std::vector<PointPlace> places(mesh.points.size(), {own, false});
    forRanges(places.size(), progress, [&](std::size_t begin, std::size_t end) {
        for (char stage = 0; stage < own; ++stage) {
            FadeWeights::Reader weights(*stages_[static_cast<std::size_t>(stage)].weights);
            for (std::size_t v = begin; v != end; ++v) {
                if (places[v].stage != own) continue;
                const FadeWeights::Range range = weights.around(mesh.points[v]);
                if (range.most > 0) places[v] = {stage, range.least >= 1};
            }
        }
    });
    return places;
}

std::vector<LocalLevels::Place> LocalLevels::placesOf(const TriangleMesh& mesh,
                                                      const Progress& progress) const {
    const std::vector<PointPlace> points = pointPlaces(mesh, progress);
    const auto own = static_cast<char>(stages_.size() - 1);
    std::vector<Place> places;
    places.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        int inside = 0, outside = 0;
        for (const std::uint32_t v : t) inside += points[v].inside, outside += points[v].stage == own;
        places.push_back(inside == 3 ? Place::inside : outside == 3 ? Place::outside : Place::fading);
    }
    return places;
}

std::vector<double> LocalLevels::smallestAt(const TriangleMesh& mesh, const Progress& progress) const {
    std::vector<double> smallest;
    smallest.reserve(mesh.points.size());
    for (const PointPlace& place : pointPlaces(mesh, progress))
        smallest.push_back(stages_[static_cast<std::size_t>(place.stage)].smallest);
    return smallest;
}

void LocalLevels::collapse(TriangleMesh& mesh, int sampled, int wanted, double deviation,
                           const Progress& progress) const {
    const auto edges = [](int steps) {
        return std::exp2(steps / 3.0);
    };  // how many times as long, in the mean
    for (std::size_t stage = 0; stage < stages_.size(); ++stage) {
        const double ratio =
            sampled / wanted * edges(stepsBetween(stages_.front().halvings, stages_[stage].halvings));
        const bool isOwn = stage + 1 == stages_.size();
        collapseTo(mesh, stage, !isOwn, ratio * ratio, deviation, progress);
        if (isOwn) break;
        const int coarser = stepsBetween(stages_[stage].halvings, stages_[stage + 1].halvings);
        const double toCoarser = deviation > 0 ? edges(2 * coarser) : edges(coarser);
        collapseTo(mesh, stage, false, ratio * ratio * toCoarser, deviation, progress);
    }
}

// Of the triangles that depend on the stage and on none that is finer, have a corner inside or have none, one in `share` is left.
void LocalLevels::collapseTo(TriangleMesh& mesh, std::size_t stage, bool inside, double share,
                             double deviation, const Progress& progress) const {
    if (share == 1) return;
    const std::vector<PointPlace> places = pointPlaces(mesh, progress);
    CollapseOptions options;
    options.kept.reserve(places.size());
    for (const PointPlace& place : places)
        options.kept.push_back(static_cast<std::size_t>(place.stage) != stage || place.inside != inside);
    std::int64_t follow = 0;
    for (const Triangle& t : mesh.triangles) {
        const char finest = std::min({places[t[0]].stage, places[t[1]].stage, places[t[2]].stage});
        const bool hasInside = places[t[0]].inside || places[t[1]].inside || places[t[2]].inside;
        follow += static_cast<std::size_t>(finest) == stage && hasInside == inside;
    }
    // Triangles at points that stay cannot go, and without a limit others would go instead of them. A level alone is what it is.
    const bool isAll = follow == static_cast<std::int64_t>(mesh.triangles.size());
    if (!isAll) options.deviation = deviation;
    options.triangles = static_cast<std::int64_t>(mesh.triangles.size()) - follow +
                        static_cast<std::int64_t>(static_cast<double>(follow) / share);
    const std::size_t before = mesh.triangles.size();
    auto normals = mesh.normals;
    collapseByQuadrics(mesh, options, nullptr, progress);
    if (mesh.triangles.size() == before) mesh.normals = std::move(normals);  // nothing has moved
}

std::int64_t LocalLevels::pointsOf(std::size_t stage, const BSplineField& field,
                                   const Progress& progress) const {
    std::vector<openvdb::Coord> points;
    points.reserve(static_cast<std::size_t>(field.controlPointCount()));
    for (auto it = field.controlPoints->cbeginValueOn(); it; ++it) points.push_back(it.getCoord());
    std::vector<char> counts(points.size(), 1);
    forRanges(points.size(), progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = 0; s <= stage && s + 1 < stages_.size(); ++s) {
            FadeWeights::Reader weights(*stages_[s].weights);
            const Halvings &fine = stages_[s].halvings, &coarse = stages_[stage].halvings;
            const auto there = [&](const openvdb::Coord& c) {
                return openvdb::Coord(timesTwo(c.x(), coarse[0] - fine[0]),
                                      timesTwo(c.y(), coarse[1] - fine[1]),
                                      timesTwo(c.z(), coarse[2] - fine[2]));
            };
            for (std::size_t i = begin; i != end; ++i) {
                if (!counts[i]) continue;
                const double weight = weights.at(there(points[i]));
                counts[i] = s == stage ? weight > 0 : weight < 1;
            }
        }
    });
    return std::count(counts.begin(), counts.end(), 1);
}

TriangleMesh partOf(const TriangleMesh& mesh, const std::vector<LocalLevels::Place>& places, bool inside) {
    constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> number(mesh.points.size(), kNone);
    TriangleMesh part;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if ((places[t] == LocalLevels::Place::inside) != inside) continue;
        Triangle corners = mesh.triangles[t];
        for (std::uint32_t& v : corners) {
            if (number[v] == kNone) {
                number[v] = static_cast<std::uint32_t>(part.points.size());
                part.points.push_back(mesh.points[v]);
            }
            v = number[v];
        }
        part.triangles.push_back(corners);
    }
    return part;
}

}  // namespace isowave::lod
