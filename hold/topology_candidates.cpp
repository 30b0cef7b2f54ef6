#include "hold/topology_candidates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hold/plug.h"
#include "polygonize/specks.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

// Points of the decided lattice up to which classes are found on it (8 us a point near the surface); beyond, on the mesh's own.
constexpr double kMostDecided = 8e6;
constexpr int kRadii[] = {3, 6, 12, kWidestPlug};

int parityOf(const Coord& c) { return (c[0] & 1) + (c[1] & 1) + (c[2] & 1); }

bool isEstimatedLess(const EditOption& a, const EditOption& b) { return a.estimate < b.estimate; }

}  // namespace

TopologyCandidates::TopologyCandidates(const BSplineField& field, int refine, double smallestPart,
                                       const Progress& progress)
    : field_(field), progress_(progress), refine_(refine), mesh_(meshLattice(field, refine, progress)) {
    smallest_ = smallestPart / nodeVolume(field.transform()) * refine * refine * refine / 2;
    found_ = latticePoints(field, 2 * refine) <= kMostDecided ? decidedLattice(field, refine, progress) : mesh_;
    const std::vector<float>& values = found_.function.values;
    constexpr float kBelowZero = -std::numeric_limits<float>::denorm_min();
    classes_ = classesAt(found_.function, kBelowZero, *std::max_element(values.begin(), values.end()), progress);
}

TopologyEdit TopologyCandidates::editAt(const Vec3d& place, bool fill) const {
    TopologyEdit edit;
    edit.kind = fill ? TopologyEdit::Kind::fill : TopologyEdit::Kind::cut;
    edit.at = field_.transform().indexToWorld(place);
    return edit;
}

// A point of the lattice that the mesh samples for one that classes are found on: itself, or, of the corners of its
// edge, face or cell that are on the side that will change, the one where |F| is least.
std::optional<std::int64_t> TopologyCandidates::anchor(std::int64_t at, bool fill) const {
    if (found_.finer == mesh_.finer) return at;
    const Coord c = found_.coordOf(at);
    std::optional<std::int64_t> best;
    for (int k = 0; k < 8; ++k) {
        const Coord corner((c[0] + (k >> 2 & c[0] & 1)) >> 1, (c[1] + (k >> 1 & c[1] & 1)) >> 1,
                           (c[2] + (k & c[2] & 1)) >> 1);
        if (!mesh_.contains(corner)) continue;
        const std::int64_t i = mesh_.indexOf(corner);
        const std::vector<float>& f = mesh_.function.values;
        if ((f[i] < 0) == fill) continue;
        if (!best || std::abs(f[i]) < std::abs(f[*best])) best = i;
    }
    return best;
}

void TopologyCandidates::addPlug(std::int64_t at, bool fill, int euler, EditOptions& options) const {
    const auto start = anchor(at, fill);
    if (!start) return;
    for (const int radius : kRadii) {
        const auto plug = leastPlug(mesh_, *start, fill, radius);
        if (!plug) continue;
        EditOption option{editAt(mesh_.placeOf(*start), fill), {}, double(plug->points.size()), euler};
        option.plan.fill = fill;
        for (const std::int64_t p : plug->points) option.plan.points.push_back(mesh_.coordOf(p));
        options.push_back(std::move(option));
        return;
    }
}

// Where the field is asked about a face or a cell its answer there is all that need change.
void TopologyCandidates::addDecider(std::int64_t at, bool fill, int euler, EditOptions& options) const {
    if (found_.finer == mesh_.finer || parityOf(found_.coordOf(at)) < 2) return;
    EditOption option{editAt(found_.placeOf(at), fill), {}, 0.5, euler};
    option.plan.fill = fill;
    option.plan.places = {found_.placeOf(at)};
    options.push_back(std::move(option));
}

// A saddle's two ways: the ring is cut where it is thinnest, or the hole is filled in its middle.
EditOptions TopologyCandidates::handle(const PersistentClass& c) const {
    EditOptions options;
    addDecider(c.birthPoint, false, 2, options);
    addPlug(c.birthPoint, false, 2, options);
    if (c.deathPoint == PersistentClass::kNever) return options;
    addDecider(c.deathPoint, true, 2, options);
    addPlug(c.deathPoint, true, 2, options);
    return options;
}

// The points of the lattice that can be reached from one on its side, ascending: inside along axes, outside across
// corners, too.
TopologyCandidates::Points TopologyCandidates::flooded(std::int64_t from) const {
    const LatticeFunction& f = found_.function;
    const bool inside = f.values[from] < 0;
    std::vector<bool> seen(f.values.size());
    Points points{from};
    seen[from] = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Coord c = found_.coordOf(points[i]);
        for (int n = 0; n < 27; ++n) {
            const Coord d(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
            if (inside && std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) != 1) continue;
            if (!found_.contains(c + d)) continue;
            const std::int64_t next = found_.indexOf(c + d);
            if (seen[next] || (f.values[next] < 0) != inside) continue;
            seen[next] = true;
            points.push_back(next);
        }
    }
    std::sort(points.begin(), points.end());
    return points;
}

void TopologyCandidates::addWhole(std::int64_t from, const Points& points, bool fill, EditOptions& options) const {
    EditOption option{editAt(found_.placeOf(from), fill), {}, 0, {}};
    option.plan.fill = fill;
    option.plan.whole = true;
    const int ratio = found_.finer / mesh_.finer;
    for (const std::int64_t p : points) {
        const Coord c = found_.coordOf(p);
        if (ratio == 1 || parityOf(c) == 0) option.plan.points.push_back(ratio == 1 ? c : c >> 1);
    }
    option.estimate = double(option.plan.points.size());
    if (!option.plan.points.empty()) options.push_back(std::move(option));
}

std::size_t TopologyCandidates::largestPart() const {
    std::size_t largest = 0;
    for (const PersistentClass& c : classes_)
        if (c.dimension == 0) largest = std::max(largest, flooded(c.birthPoint).size());
    return largest;
}

EditOptions TopologyCandidates::part(const PersistentClass& c, std::size_t largest) const {
    EditOptions options;
    const Points points = flooded(c.birthPoint);
    const int ratio = found_.finer / mesh_.finer;
    if (double(points.size()) / (ratio * ratio * ratio) < smallest_) return options;
    if (points.size() < largest) addWhole(c.birthPoint, points, false, options);
    if (c.deathPoint == PersistentClass::kNever) return options;
    addDecider(c.deathPoint, true, -2, options);
    addPlug(c.deathPoint, true, -2, options);
    return options;
}

EditOptions TopologyCandidates::cavity(const PersistentClass& c) const {
    EditOptions options;
    if (c.deathPoint != PersistentClass::kNever) {
        const Points points = flooded(c.deathPoint);
        const int ratio = found_.finer / mesh_.finer;
        if (double(points.size()) / (ratio * ratio * ratio) < smallest_) return options;
        addWhole(c.deathPoint, points, true, options);
    }
    addDecider(c.birthPoint, false, -2, options);
    addPlug(c.birthPoint, false, -2, options);
    return options;
}

std::vector<EditOptions> TopologyCandidates::of(TopologyEdit::What what, std::size_t most) const {
    std::vector<PersistentClass> wanted;
    for (const PersistentClass& c : classes_)
        if (c.dimension == static_cast<int>(what)) wanted.push_back(c);
    const std::size_t largest = what == TopologyEdit::What::part ? largestPart() : 0;
    std::vector<EditOptions> all(wanted.size());
    tbb::parallel_for(std::size_t(0), wanted.size(), [&](std::size_t i) {
        progress_.check();
        all[i] = what == TopologyEdit::What::part     ? part(wanted[i], largest)
                 : what == TopologyEdit::What::handle ? handle(wanted[i])
                                                      : cavity(wanted[i]);
        for (EditOption& option : all[i]) option.edit.what = what;
        std::stable_sort(all[i].begin(), all[i].end(), isEstimatedLess);
    });
    std::erase_if(all, [](const EditOptions& options) { return options.empty(); });
    std::stable_sort(all.begin(), all.end(), [](const EditOptions& a, const EditOptions& b) {
        return isEstimatedLess(a.front(), b.front());
    });
    if (all.size() > most) all.resize(most);
    return all;
}

}  // namespace isowave
