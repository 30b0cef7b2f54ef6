#include "volume/repair/bodies.h"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/halving_tree.h"
#include "base/point_box.h"
#include "base/triangle.h"

namespace isowave::repair {
namespace {

// ---- shells

class Sets {
  public:
    explicit Sets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }
    Index rootOf(Index i) {
        while (root_[i] != i) i = root_[i] = root_[root_[i]];
        return i;
    }
    void join(Index a, Index b) {
        a = rootOf(a);
        b = rootOf(b);
        root_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<Index> root_;
};

// Joins the sets whose own uses of an edge do not cancel.
void joinUnbalanced(Sets& sets, const EdgeUse* use, std::size_t count) {
    std::vector<std::pair<Index, int>> sums;  // set, uses one way less uses the other way
    for (std::size_t i = 0; i < count; ++i)
        sums.emplace_back(sets.rootOf(use[i].triangle), use[i].forward ? 1 : -1);
    std::sort(sums.begin(), sums.end());
    Index first = ~Index(0);
    for (std::size_t begin = 0, end = 0; begin < sums.size(); begin = end) {
        int sum = 0;
        for (end = begin; end < sums.size() && sums[end].first == sums[begin].first; ++end)
            sum += sums[end].second;
        if (sum == 0) continue;
        if (first == ~Index(0)) first = sums[begin].first;
        sets.join(first, sums[begin].first);
    }
}

// Of every triangle its shell, numbered in the order of first triangles.
struct Shells {
    std::vector<Index> of;
    std::vector<double> volume;                 // signed
    std::vector<std::vector<Index>> triangles;  // of each
};

Shells shellsOf(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
    Sets sets(mesh.triangles.size());
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count == 2) sets.join(use[0].triangle, use[1].triangle);
    });
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count > 2) joinUnbalanced(sets, use, count);
    });
    Shells shells;
    shells.of.resize(mesh.triangles.size());
    const Vec3 from = toVec3(boxAround(mesh).centre());
    std::vector<Index> number(mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
        const Index root = sets.rootOf(t);
        if (root == t) {
            number[t] = static_cast<Index>(shells.triangles.size());
            shells.triangles.emplace_back();
            shells.volume.push_back(0);
        }
        const Index shell = shells.of[t] = number[root];
        shells.triangles[shell].push_back(t);
        shells.volume[shell] +=
            dot(toVec3(mesh.points[mesh.triangles[t][0]]) - from, areaNormal(mesh, mesh.triangles[t])) / 6;
    }
    return shells;
}

// ---- winding numbers

// Of one shell, at one point. onIt: the point lies on it, and the number says nothing.
struct Winding {
    Index shell;
    int number;
    bool onIt;
};

// The winding numbers of all shells at a point, by the triangles that the line from it along x meets: those whose
// projection along x holds the point's. A line through an edge is taken as shifted by (e, e^2), e infinitesimal; two
// triangles at one edge compute the same number for it, so that exactly one of them is met.
class Windings {
  public:
    Windings(const TriangleMesh& mesh, const std::vector<Index>& shellOf)
        : mesh_(mesh),
          shellOf_(shellOf),
          order_(mesh.triangles.size()),
          tree_(order_.size(), 4),
          boxes_(tree_.boxCount()) {
        const PointBox box = boxAround(mesh);
        onSurface_ = 1e-9 * length(toVec3(box.high) - toVec3(box.low));
        std::iota(order_.begin(), order_.end(), 0u);
        tree_.build(
            tree_.root(), [&](const HalvingTree::Range& range) { divide(range); },
            [&](const HalvingTree::Range& range) { bound(range); });
    }

    // Those that are not 0, or unknown, by shell.
    std::vector<Winding> at(const Vec3& p) const {
        std::vector<Winding> found;
        std::vector<HalvingTree::Range> open{tree_.root()};
        while (!open.empty()) {
            const HalvingTree::Range range = open.back();
            open.pop_back();
            if (!mayMeet(boxes_[range.box], p)) continue;
            if (!tree_.isLeaf(range)) {
                open.push_back(range.left());
                open.push_back(range.right());
                continue;
            }
            for (std::size_t i = range.begin; i < range.end; ++i) meet(order_[i], p, found);
        }
        return summedUp(std::move(found));
    }

  private:
    double middle(Index t, int axis) const {
        const Triangle& c = mesh_.triangles[t];
        return mesh_.points[c[0]][axis] + mesh_.points[c[1]][axis] + mesh_.points[c[2]][axis];
    }
    void divide(const HalvingTree::Range& range) {
        PointBox middles;
        for (std::size_t i = range.begin; i < range.end; ++i)
            middles.add({0, middle(order_[i], 1), middle(order_[i], 2)});
        const int axis = middles.extent(1) >= middles.extent(2) ? 1 : 2;
        const auto place = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(place(range.begin), place(range.middle()), place(range.end), [&](Index a, Index b) {
            const double x = middle(a, axis), y = middle(b, axis);
            return x != y ? x < y : a < b;
        });
    }
    void bound(const HalvingTree::Range& range) {
        PointBox& box = boxes_[range.box];
        for (std::size_t i = range.begin; i < range.end; ++i)
            for (const Index corner : mesh_.triangles[order_[i]]) box.add(mesh_.points[corner]);
    }
    bool mayMeet(const PointBox& box, const Vec3& p) const {
        return box.low[1] <= p.y && p.y <= box.high[1] && box.low[2] <= p.z && p.z <= box.high[2] &&
               box.high[0] >= p.x - onSurface_;
    }

    // Twice the signed area of (a, b, p) seen along x, and whether p lies left of a -> b. Computed from the lesser point to
    // the greater one, whichever way the edge is asked for.
    std::pair<double, bool> side(Index a, Index b, const Vec3& p) const {
        const bool swapped = b < a;
        if (swapped) std::swap(a, b);
        const Point &from = mesh_.points[a], &to = mesh_.points[b];
        const double y = to[1] - from[1], z = to[2] - from[2];
        const double area = y * (p.z - from[2]) - z * (p.y - from[1]);
        const bool left = area != 0 ? area > 0 : z != 0 ? z < 0 : y > 0;
        return {swapped ? -area : area, left != swapped};
    }
    void meet(Index t, const Vec3& p, std::vector<Winding>& found) const {
        const auto& [a, b, c] = mesh_.triangles[t];
        const auto [toC, leftOfAb] = side(a, b, p);
        const auto [toA, leftOfBc] = side(b, c, p);
        const auto [toB, leftOfCa] = side(c, a, p);
        if (leftOfAb != leftOfBc || leftOfBc != leftOfCa) return;
        const double area = toA + toB + toC;
        if (area == 0) return;
        const double x =
            (toA * mesh_.points[a][0] + toB * mesh_.points[b][0] + toC * mesh_.points[c][0]) / area;
        if (x < p.x - onSurface_) return;
        found.push_back({shellOf_[t], leftOfAb ? 1 : -1, x <= p.x + onSurface_});
    }
    static std::vector<Winding> summedUp(std::vector<Winding> found) {
        std::sort(found.begin(), found.end(),
                  [](const Winding& a, const Winding& b) { return a.shell < b.shell; });
        std::vector<Winding> sums;
        for (const Winding& w : found) {
            if (sums.empty() || sums.back().shell != w.shell) sums.push_back({w.shell, 0, false});
            sums.back().number += w.number;
            sums.back().onIt = sums.back().onIt || w.onIt;
        }
        std::erase_if(sums, [](const Winding& w) { return w.number == 0 && !w.onIt; });
        return sums;
    }

    const TriangleMesh& mesh_;
    const std::vector<Index>& shellOf_;
    std::vector<Index> order_;
    HalvingTree tree_;
    std::vector<PointBox> boxes_;
    double onSurface_ = 0;
};

// ---- who lies in whom

struct Place {
    std::vector<Index> inside;  // these shells hold the whole shell
    bool buried = false;        // every place of it lies in some shell
};

class Finder {
  public:
    Finder(const TriangleMesh& mesh, const Shells& shells, const Windings& windings, const Progress& progress)
        : mesh_(mesh), shells_(shells), windings_(windings), progress_(progress) {}

    Place placeOf(Index shell) {
        Place place{{}, true};
        bool first = true;
        const auto take = [&](const Vec3& p) {
            checkNowAndThen(progress_, 64 * ++asked_);
            return narrowed(place, first, shell, windings_.at(p));
        };
        for (const Index t : shells_.triangles[shell]) {
            const auto& [a, b, c] = mesh_.triangles[t];
            const Vec3 pa = toVec3(mesh_.points[a]), pb = toVec3(mesh_.points[b]),
                       pc = toVec3(mesh_.points[c]);
            if (!take((pa + pb + pc) / 3) || !take(pa)) return {};
        }
        if (first) return {};
        return place;
    }

  private:
    // False where the shell lies in nothing. A place on a shell says nothing about that shell, and if in no other one,
    // nothing at all.
    static bool narrowed(Place& place, bool& first, Index shell, std::vector<Winding> at) {
        std::erase_if(at, [&](const Winding& w) { return w.shell == shell; });
        const auto of = [&](Index s) {
            return std::find_if(at.begin(), at.end(), [&](const Winding& w) { return w.shell == s; });
        };
        const bool unknown = std::any_of(at.begin(), at.end(), [](const Winding& w) { return w.onIt; });
        const bool isIn = std::any_of(at.begin(), at.end(), [](const Winding& w) { return !w.onIt; });
        if (!isIn && unknown) return true;
        place.buried = place.buried && isIn;
        if (first) {
            for (const Winding& w : at) place.inside.push_back(w.shell);
            first = false;
        } else {
            std::erase_if(place.inside, [&](Index s) { return of(s) == at.end(); });
        }
        return place.buried || !place.inside.empty();
    }

    const TriangleMesh& mesh_;
    const Shells& shells_;
    const Windings& windings_;
    const Progress& progress_;
    std::size_t asked_ = 0;
};

// The tightest of the shells around one.
Index parentOf(const Place& place, const Shells& shells) {
    return *std::min_element(place.inside.begin(), place.inside.end(), [&](Index a, Index b) {
        const double x = std::abs(shells.volume[a]), y = std::abs(shells.volume[b]);
        return x != y ? x < y : a < b;
    });
}

// Outermost shells that are inside out, and all within them.
std::vector<bool> turnedOf(const Shells& shells, const std::vector<Place>& places) {
    const std::size_t count = shells.volume.size();
    std::vector<Index> order(count);
    std::iota(order.begin(), order.end(), 0u);
    // A shell around another one is larger, or they would coincide.
    std::sort(order.begin(), order.end(), [&](Index a, Index b) {
        const double x = std::abs(shells.volume[a]), y = std::abs(shells.volume[b]);
        return x != y ? x > y : a < b;
    });
    std::vector<bool> turned(count);
    for (const Index s : order)
        turned[s] = places[s].inside.empty() ? shells.volume[s] < 0 && !places[s].buried
                                             : static_cast<bool>(turned[parentOf(places[s], shells)]);
    return turned;
}

}  // namespace

Bodies orientBodies(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, const Progress& progress) {
    const Shells shells = shellsOf(mesh, uses);
    const std::size_t count = shells.volume.size();
    std::vector<Place> places(count);
    if (count > 1) {
        const Windings windings(mesh, shells.of);
        Finder finder(mesh, shells, windings, progress);
        for (Index s = 0; s < count; ++s) places[s] = finder.placeOf(s);
    }
    const std::vector<bool> turned = turnedOf(shells, places);
    Bodies bodies;
    for (Index s = 0; s < count; ++s) {
        if (!places[s].inside.empty())
            bodies.nested += (shells.volume[s] > 0) == (shells.volume[parentOf(places[s], shells)] > 0);
        if (!turned[s]) continue;
        ++bodies.turned;
        for (const Index t : shells.triangles[s]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
    return bodies;
}

}  // namespace isowave::repair
