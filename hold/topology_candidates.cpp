#include "hold/topology_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>

#include "hold/plug.h"
#include "hold/until_stopped.h"
#include "polygonize/cell_table.h"
#include "polygonize/specks.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using What = TopologyEdit::What;

constexpr int kRadii[] = {3, 6, kWidestPlug};

int parityOf(const Coord& c) { return (c[0] & 1) + (c[1] & 1) + (c[2] & 1); }

// One handle less, or one part or cavity joined to another.
int eulerOf(What what) { return what == What::handle ? 2 : -2; }

Coord scaled(const Coord& c, int by) { return {c[0] * by, c[1] * by, c[2] * by}; }

// Lattice points `refine` times as dense that lie between points of a plug on all sides.
std::vector<Coord> refined(const std::vector<Coord>& plug, int refine) {
    const auto has = [&](const Coord& c) { return std::binary_search(plug.begin(), plug.end(), c); };
    const auto isBetween = [&](const Coord& fine) {
        const Vec3d at = fine.asVec3d() / refine;
        const openvdb::CoordBBox corners(Coord::floor(at), Coord::ceil(at));
        for (auto c = corners.begin(); c; ++c)
            if (!has(*c)) return false;
        return true;
    };
    std::vector<Coord> points;
    for (const Coord& p : plug) {
        const Coord first(p[0] * refine, p[1] * refine, p[2] * refine);
        const openvdb::CoordBBox ahead(first, first.offsetBy(refine - 1));
        for (auto fine = ahead.begin(); fine; ++fine)
            if (isBetween(*fine)) points.push_back(*fine);
    }
    std::sort(points.begin(), points.end());
    return points;
}

bool isEstimatedLess(const EditOption& a, const EditOption& b) { return a.estimate < b.estimate; }

}  // namespace

TopologyCandidates::TopologyCandidates(const BSplineField& field, int refine, double smallestPart,
                                       const Depth& depth, PlugMemo& memo, const std::set<OptionKey>& useless,
                                       const Progress& progress)
    : field_(field),
      memo_(memo),
      useless_(useless),
      progress_(progress),
      refine_(refine),
      fine_(refinedField(field, refine, progress)) {
    smallest_ = smallestPart / nodeVolume(field.transform()) * refine * refine * refine / 2;
    int finer = 2 * refine;
    while (finer > 1 && latticePoints(field, finer) > depth.points) finer /= 2;
    found_ = finer > refine ? decidedLattice(field, refine, progress) : meshLattice(field, finer, progress);
    constexpr float kBelowZero = -std::numeric_limits<float>::denorm_min();
    classes_ = classesAt(found_.function, kBelowZero, static_cast<float>(depth.last), progress);
}

TopologyEdit TopologyCandidates::editAt(const Vec3d& place, TopologyEdit::What what, bool fill) const {
    TopologyEdit edit;
    edit.what = what;
    edit.kind = fill ? TopologyEdit::Kind::fill : TopologyEdit::Kind::cut;
    edit.at = field_.transform().indexToWorld(place);
    return edit;
}

// Points of the lattice that the mesh samples for one that classes are found on: itself, or, of the corners of its edge,
// face or cell, those on the side that will change, the one with the least |F| first.
std::vector<Coord> TopologyCandidates::anchors(std::int64_t at, bool fill) const {
    const Coord c = found_.coordOf(at);
    if (!isDecided()) return {scaled(c, refine_ / found_.finer)};
    std::vector<std::pair<float, Coord>> found;
    for (int k = 0; k < 8; ++k) {
        const Coord corner = c.offsetBy(k >> 2 & c[0] & 1 ? 1 : -(c[0] & 1),
                                        k >> 1 & c[1] & 1 ? 1 : -(c[1] & 1), k & c[2] & 1 ? 1 : -(c[2] & 1));
        const float f = found_.at(corner);
        if ((f < 0) != fill) found.emplace_back(std::abs(f), corner >> 1);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<Coord> result;
    for (const auto& [height, corner] : found) result.push_back(corner);
    return result;
}

// The first plug that is not known to be useless, with growing radius.
void TopologyCandidates::addPlugFrom(const PlugStart& start, TopologyEdit::What what, bool fill,
                                     EditOptions& options) const {
    const int coarser = start.onControlPoints ? refine_ : 1;
    for (const int radius : kRadii) {
        if (radius / coarser < kRadii[0]) continue;
        EditOption option{editAt(start.at.asVec3d() * coarser / refine_, what, fill), {}, 0, eulerOf(what)};
        option.plan.fill = fill;
        option.plan.points = memo_.at(
            {scaled(start.at, coarser), fill, start.height, start.onControlPoints ? -radius : radius}, [&] {
                if (!start.onControlPoints) return leastPlug(fine_, start.at, fill, start.height, radius);
                return refined(leastPlug(field_, start.at, fill, start.height, radius / coarser), refine_);
            });
        option.estimate = double(option.plan.points.size());
        if (option.plan.points.empty() || useless_.count(keyOf(option))) continue;
        options.push_back(std::move(option));
        return;
    }
}

// About the saddle on the mesh's lattice; and where that is finer than the control points, on theirs: thin sheets
// between them may be more than the spline can bend to.
void TopologyCandidates::addPlug(std::int64_t at, TopologyEdit::What what, bool fill,
                                 EditOptions& options) const {
    constexpr std::size_t kMostAnchors = 4;
    const float height = std::abs(found_.function.values[at]);
    const std::vector<Coord> starts = anchors(at, fill);
    for (std::size_t i = 0; i < std::min(starts.size(), kMostAnchors); ++i)
        addPlugFrom({starts[i], height, false}, what, fill, options);
    if (refine_ == 1) return;
    const Vec3d place = found_.placeOf(at);
    const openvdb::CoordBBox corners(Coord::floor(place), Coord::ceil(place));
    for (auto c = corners.begin(); c; ++c)
        if ((evaluate(field_, (*c).asVec3d()) < 0) != fill)
            addPlugFrom({*c, height, true}, what, fill, options);
}

// Where the field is asked about a face or a cell its answer there is all that need change.
void TopologyCandidates::addDecider(std::int64_t at, TopologyEdit::What what, bool fill,
                                    EditOptions& options) const {
    const Coord c = found_.coordOf(at);
    if (!isDecided() || parityOf(c) < 2) return;
    unsigned pattern = 0;
    for (int k = 0; k < kCellCorners; ++k) {
        const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
        // Of a face: the cell above it.
        const Coord corner(c[0] + (c[0] & 1 ? 2 * x - 1 : 2 * x), c[1] + (c[1] & 1 ? 2 * y - 1 : 2 * y),
                           c[2] + (c[2] & 1 ? 2 * z - 1 : 2 * z));
        pattern |= static_cast<unsigned>(found_.at(corner) < 0) << k;
    }
    const int normal = !(c[0] & 1) ? 0 : !(c[1] & 1) ? 1 : 2;
    const bool asked = parityOf(c) == 3 ? !cellTable().isPlain(pattern)
                                        : (cellTable().ambiguousFaces(pattern) >> (2 * normal) & 1) != 0;
    if (!asked) return;
    EditOption option{editAt(found_.placeOf(at), what, fill), {}, 0.5, eulerOf(what)};
    option.plan.fill = fill;
    option.plan.places = {found_.placeOf(at)};
    options.push_back(std::move(option));
}

// A saddle's two ways: the ring is cut where it is thinnest, or the hole is filled in its middle.
EditOptions TopologyCandidates::handle(const PersistentClass& c) const {
    EditOptions options;
    addDecider(c.birthPoint, What::handle, false, options);
    addPlug(c.birthPoint, What::handle, false, options);
    if (c.deathPoint == PersistentClass::kNever) return options;
    addDecider(c.deathPoint, What::handle, true, options);
    addPlug(c.deathPoint, What::handle, true, options);
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

// The same on the lattice that the mesh samples, where classes are found on a coarser one. Nothing where it is large.
std::vector<Coord> TopologyCandidates::floodedOnMesh(const Coord& from) const {
    constexpr std::size_t kMost = 100000;
    const auto isInside = [&](const Coord& c) { return evaluate(fine_, c.asVec3d()) < 0; };
    const bool inside = isInside(from);
    std::unordered_set<Coord> seen{from};
    std::vector<Coord> points{from};
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.size() > kMost) return {};
        const Coord c = points[i];
        for (int n = 0; n < 27; ++n) {
            const Coord d(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
            if (inside && std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) != 1) continue;
            if (isInside(c + d) == inside && seen.insert(c + d).second) points.push_back(c + d);
        }
    }
    std::sort(points.begin(), points.end());
    return points;
}

// Cells of the mesh's lattice.
double TopologyCandidates::cellsOf(const Points& points) const {
    return double(points.size()) * std::pow(double(refine_) / found_.finer, 3);
}

void TopologyCandidates::addWhole(std::int64_t from, const Points& points, TopologyEdit::What what, bool fill,
                                  EditOptions& options) const {
    EditOption option{editAt(found_.placeOf(from), what, fill), {}, 0, {}};
    option.plan.fill = fill;
    option.plan.whole = true;
    if (found_.finer < refine_) {
        option.plan.points = floodedOnMesh(scaled(found_.coordOf(from), refine_ / found_.finer));
    } else {
        for (const std::int64_t p : points) {
            const Coord c = found_.coordOf(p);
            if (!isDecided() || parityOf(c) == 0) option.plan.points.push_back(isDecided() ? c >> 1 : c);
        }
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
    if (cellsOf(points) < smallest_) return options;
    if (points.size() < largest) addWhole(c.birthPoint, points, What::part, false, options);
    if (c.deathPoint == PersistentClass::kNever) return options;
    addDecider(c.deathPoint, What::part, true, options);
    addPlug(c.deathPoint, What::part, true, options);
    return options;
}

EditOptions TopologyCandidates::cavity(const PersistentClass& c) const {
    EditOptions options;
    if (c.deathPoint != PersistentClass::kNever) {
        const Points points = flooded(c.deathPoint);
        if (cellsOf(points) < smallest_) return options;
        addWhole(c.deathPoint, points, What::cavity, true, options);
    }
    addDecider(c.birthPoint, What::cavity, false, options);
    addPlug(c.birthPoint, What::cavity, false, options);
    return options;
}

// Growing plugs takes milliseconds a thing, and a large level has thousands: those that begin or end nearest to the surface go
// first. The rest is left once twice `most` more of them bring nothing cheaper than what is there, and after 16 times as many.
std::vector<EditOptions> TopologyCandidates::of(TopologyEdit::What what, std::size_t wanted,
                                                std::size_t most) const {
    std::vector<PersistentClass> things;
    for (const PersistentClass& c : classes_)
        if (c.dimension == static_cast<int>(what)) things.push_back(c);
    const auto depth = [](const PersistentClass& c) { return std::min(-c.birth, c.death); };
    std::stable_sort(things.begin(), things.end(),
                     [&](const PersistentClass& a, const PersistentClass& b) { return depth(a) < depth(b); });
    const std::size_t largest = what == What::part ? largestPart() : 0, piece = 2 * most, enough = 16 * most;
    std::vector<EditOptions> all;
    double dearest = std::numeric_limits<double>::infinity();  // of the cheapest `wanted`
    for (std::size_t done = 0; done < things.size() && all.size() < enough; done += piece) {
        std::vector<EditOptions> next(std::min(piece, things.size() - done));
        forEachUntilStopped(next.size(), progress_,
                            [&](std::size_t i) { next[i] = optionsOf(things[done + i], largest); });
        for (EditOptions& options : next)
            if (!options.empty()) all.push_back(std::move(options));
        std::stable_sort(all.begin(), all.end(), [](const EditOptions& a, const EditOptions& b) {
            return isEstimatedLess(a.front(), b.front());
        });
        if (all.size() < most) continue;
        const double before = std::exchange(dearest, all[wanted - 1].front().estimate);
        if (dearest >= before) break;
    }
    if (all.size() > most) all.resize(most);
    return all;
}

EditOptions TopologyCandidates::optionsOf(const PersistentClass& c, std::size_t largest) const {
    EditOptions options = c.dimension == 0 ? part(c, largest) : c.dimension == 1 ? handle(c) : cavity(c);
    std::erase_if(options, [&](const EditOption& option) { return useless_.count(keyOf(option)) != 0; });
    std::stable_sort(options.begin(), options.end(), isEstimatedLess);
    return options;
}

}  // namespace isowave
