// A triangle soup to a closed mesh. Passes, each with what holds after it:
//
//   merge       points are distinct
//   drop        triangles have three distinct corners and are listed once
//   orient      across every edge with two triangles, both agree on outside, as far as the surface is orientable
//   fill        every edge has an even number of triangles: the mesh is closed, solid and void are well-defined
//
// Closedness is taken modulo 2. The edges with an odd number of triangles form a graph in which every vertex
// has an even degree (each triangle at a vertex brings two of its edges), so they always fall apart into
// simple loops; closing every loop by a fan makes every edge even. Nothing here depends on the order of
// threads: there are none.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "isowave/error.h"
#include "isowave/progress.h"
#include "volume/mesh_repair.h"

namespace isowave {
namespace {

using Index = std::uint32_t;

// Asks whether to stop at one of this many steps of a loop; asking at each would cost more than the step.
constexpr std::size_t kStepsBetweenChecks = std::size_t(1) << 16;

void checkNowAndThen(const Progress& progress, std::size_t step) {
    if (step % kStepsBetweenChecks == 0) progress.check();
}

// std::sort, the slow part of most passes, left by Cancelled within a moment of the stop being asked for.
template <class T, class Less>
void sortUnlessStopped(std::vector<T>& values, const Progress& progress, const Less& less) {
    std::size_t compared = 0;
    std::sort(values.begin(), values.end(), [&](const T& a, const T& b) {
        checkNowAndThen(progress, ++compared);
        return less(a, b);
    });
}

// ---- merge, drop

// Equal points become one, unused ones go; the order of first use stays.
void mergePoints(TriangleMesh& mesh, MeshRepairReport& report, const Progress& progress) {
    std::vector<Point> points = std::move(mesh.points);
    for (Point& p : points) {
        for (double& x : p) x += 0.0;  // -0 is 0
    }
    std::vector<Index> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    sortUnlessStopped(order, progress, [&](Index a, Index b) {
        return points[a] != points[b] ? points[a] < points[b] : a < b;
    });
    std::vector<Index> first(points.size());  // of every point: the first one equal to it
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool equal = i > 0 && points[order[i]] == points[order[i - 1]];
        first[order[i]] = equal ? first[order[i - 1]] : order[i];
    }
    constexpr Index none = ~Index(0);
    std::vector<Index> number(points.size(), none);
    std::vector<bool> used(points.size());
    mesh.points.clear();
    mesh.normals.clear();
    for (Triangle& triangle : mesh.triangles) {
        for (Index& corner : triangle) {
            used[corner] = true;
            const Index point = first[corner];
            if (number[point] == none) {
                number[point] = static_cast<Index>(mesh.points.size());
                mesh.points.push_back(points[point]);
            }
            corner = number[point];
        }
    }
    const auto usedCount = std::count(used.begin(), used.end(), true);
    report.pointsMerged = usedCount - static_cast<std::int64_t>(mesh.points.size());
}

void dropDegenerate(TriangleMesh& mesh, MeshRepairReport& report) {
    report.degenerateRemoved = static_cast<std::int64_t>(std::erase_if(
        mesh.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }));
}

// The corners in ascending order, and whether an even permutation leads there.
std::pair<Triangle, bool> sortedCorners(Triangle t) {
    bool even = true;
    const auto order = [&](Index& a, Index& b) {
        if (a > b) {
            std::swap(a, b);
            even = !even;
        }
    };
    order(t[0], t[1]);
    order(t[1], t[2]);
    order(t[0], t[1]);
    return {t, even};
}

// Triangles on the same three points. The same way round: the first stays. Both ways, equally often: they
// bound nothing and all go (a fin folded onto itself), except in a file that lists its whole surface twice,
// once from either side, as renderers like it: there the first stays.
void dropDuplicates(TriangleMesh& mesh, MeshRepairReport& report, const Progress& progress) {
    struct Entry {
        Triangle corners;
        Index triangle;
        bool even;
    };
    std::vector<Entry> entries;
    entries.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
        const auto [corners, even] = sortedCorners(mesh.triangles[t]);
        entries.push_back({corners, t, even});
    }
    sortUnlessStopped(entries, progress, [](const Entry& a, const Entry& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.triangle < b.triangle;
    });
    std::vector<bool> dropped(mesh.triangles.size());
    std::vector<Index> opposed;  // first triangles of groups that cancel
    std::size_t inOpposed = 0;
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        std::size_t even = 0;
        for (end = begin; end < entries.size() && entries[end].corners == entries[begin].corners; ++end) {
            even += entries[end].even;
            dropped[entries[end].triangle] = end > begin;
        }
        if (2 * even == end - begin) {
            opposed.push_back(entries[begin].triangle);
            inOpposed += end - begin;
        }
    }
    const bool doubleSided = 2 * inOpposed > mesh.triangles.size();
    if (!doubleSided) {
        for (const Index triangle : opposed) dropped[triangle] = true;
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!dropped[t]) mesh.triangles[kept++] = mesh.triangles[t];
    }
    report.duplicatesRemoved = static_cast<std::int64_t>(mesh.triangles.size() - kept);
    mesh.triangles.resize(kept);
}

// ---- edges

// One triangle's use of an edge, from `low` to `high` or back.
struct EdgeUse {
    Index low, high, triangle;
    bool forward;

    bool sameEdge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

std::vector<EdgeUse> edgeUses(const TriangleMesh& mesh, const Progress& progress) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const Index a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            uses.push_back({std::min(a, b), std::max(a, b), t, a < b});
        }
    }
    sortUnlessStopped(uses, progress, [](const EdgeUse& a, const EdgeUse& b) {
        if (a.low != b.low) return a.low < b.low;
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    return uses;
}

// Calls visit(first, count) for the uses of each edge.
template <class Visit>
void forEachEdge(const std::vector<EdgeUse>& uses, const Visit& visit) {
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        for (end = begin + 1; end < uses.size() && uses[end].sameEdge(uses[begin]); ++end) continue;
        visit(&uses[begin], end - begin);
    }
}

// Uses one way less uses the other way.
int balance(const EdgeUse* use, std::size_t count) {
    int sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += use[i].forward ? 1 : -1;
    return sum;
}

// Every edge is used equally often both ways; an edge of odd use, once more one way.
bool isBalanced(const std::vector<EdgeUse>& uses) {
    bool balanced = true;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        balanced = balanced && std::abs(balance(use, count)) == static_cast<int>(count % 2);
    });
    return balanced;
}

// ---- orient

// Neighbours across edges with two triangles, as a graph in compressed rows.
struct Neighbours {
    std::vector<std::size_t> start;               // triangle t: start[t] .. start[t + 1]
    std::vector<std::pair<Index, bool>> entries;  // neighbour, and whether the two agree as they are
};

Neighbours neighboursOf(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
    Neighbours graph;
    graph.start.assign(mesh.triangles.size() + 1, 0);
    const auto forEachPair = [&](const auto& visit) {
        forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
            if (count != 2) return;
            const bool agree = use[0].forward != use[1].forward;
            visit(use[0].triangle, use[1].triangle, agree);
            visit(use[1].triangle, use[0].triangle, agree);
        });
    };
    forEachPair([&](Index t, Index, bool) { ++graph.start[t + 1]; });
    std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
    graph.entries.resize(graph.start.back());
    std::vector<std::size_t> cursor(graph.start.begin(), graph.start.end() - 1);
    forEachPair([&](Index t, Index other, bool agree) { graph.entries[cursor[t]++] = {other, agree}; });
    return graph;
}

// Turns the minority of each component round. Returns whether the outcome can be trusted: where more than a
// quarter of a component had to turn, nobody knows which side its author meant. One component alone has only
// one inside.
bool orient(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, MeshRepairReport& report,
            const Progress& progress) {
    const Neighbours graph = neighboursOf(mesh, uses);
    enum : char { unseen, kept, turned };
    std::vector<char> state(mesh.triangles.size(), unseen);
    std::vector<Index> component;
    std::size_t components = 0, walked = 0;
    bool clear = true;
    for (Index seed = 0; seed < mesh.triangles.size(); ++seed) {
        if (state[seed] != unseen) continue;
        ++components;
        component.assign(1, seed);
        state[seed] = kept;
        std::size_t turns = 0;
        for (std::size_t i = 0; i < component.size(); ++i) {
            const Index t = component[i];
            checkNowAndThen(progress, ++walked);
            for (std::size_t e = graph.start[t]; e < graph.start[t + 1]; ++e) {
                const auto [other, agree] = graph.entries[e];
                if (state[other] != unseen) continue;
                state[other] = agree == (state[t] == kept) ? kept : turned;
                turns += state[other] == turned;
                component.push_back(other);
            }
        }
        const bool majorityTurned = 2 * turns > component.size();
        const std::size_t flips = majorityTurned ? component.size() - turns : turns;
        for (const Index t : component) {
            if ((state[t] == turned) != majorityTurned) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        }
        report.facesFlipped += static_cast<std::int64_t>(flips);
        clear = clear && 4 * flips <= component.size();
    }
    return clear || components == 1;
}

// ---- fill

struct BoundaryEdge {
    Index from, to;  // the direction that its triangles lack
    bool used = false;
};

std::vector<BoundaryEdge> boundaryOf(const std::vector<EdgeUse>& uses, MeshRepairReport& report) {
    std::vector<BoundaryEdge> boundary;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count % 2 == 0) {
            report.nonManifoldEdges += count > 2;
            return;
        }
        const bool backward = balance(use, count) > 0;
        boundary.push_back({backward ? use->high : use->low, backward ? use->low : use->high});
    });
    return boundary;
}

// Simple loops, each as its points in order. At every point an edge that leads away is preferred, so that
// loops run with the surface's orientation wherever it has one. Time and memory are linear in the edges and
// points but for the sort: every edge is walked once, taken off the path once and passed by a cursor twice.
class LoopFinder {
  public:
    LoopFinder(std::vector<BoundaryEdge> edges, std::size_t points, const Progress& progress)
        : edges_(std::move(edges)), cursor_(points), place_(points, kNowhere), progress_(progress) {
        ends_.reserve(2 * edges_.size());
        for (Index e = 0; e < edges_.size(); ++e) {
            ends_.push_back({edges_[e].from, 0, e});
            ends_.push_back({edges_[e].to, 1, e});
        }
        std::sort(ends_.begin(), ends_.end());
        for (std::size_t i = ends_.size(); i-- > 0;) cursor_[ends_[i][0]] = i;
    }

    std::vector<std::vector<Index>> loops() {
        std::vector<std::vector<Index>> found;
        for (const BoundaryEdge& edge : edges_) {
            if (!edge.used) walk(edge.from, found);
        }
        return found;
    }

  private:
    // (point, 0 away or 1 towards, edge)
    using End = std::array<Index, 3>;
    static constexpr Index kNowhere = ~Index(0);

    // Walks on until the start has no unused edge left; a point met twice on the way cuts a loop off.
    // invariant: path is a simple path and place_ its inverse; every vertex has an even number of unused
    // edges but for the path's two ends.
    void walk(Index start, std::vector<std::vector<Index>>& found) {
        std::vector<Index> path{start};
        place_[start] = 0;
        while (true) {
            const auto edge = unusedAt(path.back());
            if (edge == edges_.size()) {
                assert(path.size() == 1);
                place_[start] = kNowhere;
                return;
            }
            edges_[edge].used = true;
            checkNowAndThen(progress_, ++walked_);
            const Index next = edges_[edge].from == path.back() ? edges_[edge].to : edges_[edge].from;
            if (place_[next] == kNowhere) {
                place_[next] = static_cast<Index>(path.size());
                path.push_back(next);
                continue;
            }
            const auto first = path.begin() + place_[next];
            found.emplace_back(first, path.end());
            for (auto point = first + 1; point != path.end(); ++point) place_[*point] = kNowhere;
            path.erase(first + 1, path.end());
        }
    }

    // An edge once used stays used, so a point's cursor never has to go back.
    std::size_t unusedAt(Index point) {
        for (std::size_t& end = cursor_[point]; end < ends_.size() && ends_[end][0] == point; ++end) {
            if (!edges_[ends_[end][2]].used) return ends_[end][2];
        }
        return edges_.size();
    }

    std::vector<BoundaryEdge> edges_;
    std::vector<End> ends_;
    std::vector<std::size_t> cursor_;  // of every point: its first end that may be unused
    std::vector<Index> place_;         // of every point: its index in the path, or kNowhere
    std::size_t walked_ = 0;
    const Progress& progress_;
};

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

double perimeter(const TriangleMesh& mesh, const std::vector<Index>& loop) {
    double sum = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        sum += distance(mesh.points[loop[i]], mesh.points[loop[(i + 1) % loop.size()]]);
    }
    return sum;
}

double diagonal(const TriangleMesh& mesh) {
    Point low = mesh.points.front(), high = low;
    for (const Point& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    return distance(low, high);
}

void refuseLargeHoles(const TriangleMesh& mesh, const std::string& name,
                      const std::vector<std::vector<Index>>& loops, const MeshRepairReport& report,
                      const RepairOptions& options) {
    const double size = diagonal(mesh);
    double longest = 0;
    std::size_t tooLong = 0;
    Point place{};
    for (const auto& loop : loops) {
        const double length = perimeter(mesh, loop);
        tooLong += length > options.maxHole * size;
        if (length > longest) {
            longest = length;
            place = mesh.points[loop.front()];
        }
    }
    if (tooLong == 0) return;
    throw InputError(
        name,
        fmt::format("not closed: {} boundary edges in {} loop(s), {} too long to fill; the longest, at "
                    "({:g}, {:g}, {:g}), measures {:.3g}, {:.0f} % of the box's diagonal, and up to {:.0f} % "
                    "are filled; close it in a mesh editor",
                    report.boundaryEdges, loops.size(), tooLong, place[0], place[1], place[2], longest,
                    100 * longest / size, 100 * options.maxHole));
}

// A fan around the mean of the loop's points; of three points, a triangle.
void fillByFan(TriangleMesh& mesh, const std::vector<Index>& loop) {
    if (loop.size() == 3) {
        mesh.triangles.push_back({loop[0], loop[1], loop[2]});
        return;
    }
    Point centre{};
    for (const Index point : loop) {
        for (int axis = 0; axis < 3; ++axis) {
            centre[axis] += mesh.points[point][axis] / static_cast<double>(loop.size());
        }
    }
    const Index apex = static_cast<Index>(mesh.points.size());
    mesh.points.push_back(centre);
    for (std::size_t i = 0; i < loop.size(); ++i) {
        mesh.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], apex});
    }
}

// A loop around one triangle is closed by dropping that triangle: it bounds nothing. All others are filled.
void closeLoops(TriangleMesh& mesh, const std::vector<std::vector<Index>>& loops, MeshRepairReport& report) {
    std::vector<Triangle> threes;
    for (const auto& loop : loops) {
        if (loop.size() == 3) threes.push_back(sortedCorners({loop[0], loop[1], loop[2]}).first);
    }
    std::sort(threes.begin(), threes.end());
    std::vector<Triangle> loose;  // sorted corners
    if (!threes.empty()) {
        std::erase_if(mesh.triangles, [&](const Triangle& triangle) {
            const Triangle corners = sortedCorners(triangle).first;
            if (!std::binary_search(threes.begin(), threes.end(), corners)) return false;
            loose.push_back(corners);
            return true;
        });
        std::sort(loose.begin(), loose.end());
    }
    for (const auto& loop : loops) {
        if (loop.size() == 3) {
            const Triangle corners = sortedCorners({loop[0], loop[1], loop[2]}).first;
            if (std::binary_search(loose.begin(), loose.end(), corners)) continue;
        }
        fillByFan(mesh, loop);
        ++report.holesFilled;
    }
    report.looseRemoved = static_cast<std::int64_t>(loose.size());
}

void refuseNothing(const TriangleMesh& mesh, const std::string& name, const MeshRepairReport& report) {
    if (!mesh.triangles.empty()) return;
    throw InputError(name, fmt::format("no triangles are left of {}: {} degenerate, {} duplicates, {} loose",
                                       report.facesRead, report.degenerateRemoved, report.duplicatesRemoved,
                                       report.looseRemoved));
}

void describe(MeshRepairReport& report) {
    const auto note = [&](std::int64_t count, const char* one, const char* many) {
        if (count > 0) report.notes.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
    };
    note(report.pointsMerged, "equal point merged", "equal points merged");
    note(report.degenerateRemoved, "degenerate triangle removed", "degenerate triangles removed");
    note(report.duplicatesRemoved, "duplicate triangle removed", "duplicate triangles removed");
    note(report.looseRemoved, "loose triangle removed", "loose triangles removed");
    note(report.facesFlipped, "triangle turned to agree with its neighbours",
         "triangles turned to agree with their neighbours");
    note(report.holesFilled, "hole filled", "holes filled");
    note(report.nonManifoldEdges, "edge with four or more triangles kept",
         "edges with four or more triangles kept");
    if (report.evenOdd)
        report.notes.push_back("its orientation cannot be trusted: inside by counting crossings");
}

}  // namespace

TriangleMesh repairMesh(TriangleMesh mesh, const std::string& name, MeshRepairReport* reportOut,
                        const RepairOptions& options, const Progress& progress) {
    MeshRepairReport report;
    report.facesRead = static_cast<std::int64_t>(mesh.triangles.size());
    progress("repairing", 0);
    mergePoints(mesh, report, progress);
    dropDegenerate(mesh, report);
    progress("repairing", 0.3);
    dropDuplicates(mesh, report, progress);
    refuseNothing(mesh, name, report);

    progress("repairing", 0.5);
    std::vector<EdgeUse> uses = edgeUses(mesh, progress);
    report.oriented = isBalanced(uses);
    bool trusted = true;
    if (!report.oriented) {
        progress("repairing", 0.7);
        trusted = orient(mesh, uses, report, progress);
        uses = edgeUses(mesh, progress);
    }

    progress("repairing", 0.8);
    std::vector<BoundaryEdge> boundary = boundaryOf(uses, report);
    report.boundaryEdges = static_cast<std::int64_t>(boundary.size());
    const auto loops = LoopFinder(std::move(boundary), mesh.points.size(), progress).loops();
    report.boundaryLoops = static_cast<std::int64_t>(loops.size());
    refuseLargeHoles(mesh, name, loops, report, options);
    progress("repairing", 0.9);
    closeLoops(mesh, loops, report);
    refuseNothing(mesh, name, report);
    if (!loops.empty()) uses = edgeUses(mesh, progress);
    report.evenOdd = !trusted || !isBalanced(uses);

    progress("repairing", 1);
    describe(report);
    if (reportOut) *reportOut = std::move(report);
    return mesh;
}

}  // namespace isowave
