#include "volume/repair/cracks.h"

#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include "base/point_box.h"
#include "base/triangle.h"

namespace isowave::repair {
namespace {

constexpr std::size_t kMostInCell = 64;

double distance(const Point& a, const Point& b) { return length(toVec3(a) - toVec3(b)); }

// ---- weld

struct CellHash {
    std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
        std::uint64_t h = 0;
        for (const std::int64_t x : cell)
            h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
        return h;
    }
};

// Sets of points that lie within `tolerance` of each other, along chains.
class Clusters {
  public:
    Clusters(const std::vector<Point>& points, const std::vector<Index>& members, double tolerance)
        : points_(points), members_(members), tolerance_(tolerance), root_(members.size()) {
        std::iota(root_.begin(), root_.end(), 0u);
    }

    // False where a cell holds too many points.
    bool find(const Progress& progress) {
        for (Index i = 0; i < members_.size(); ++i) {
            auto& cell = cells_[cellOf(at(i))];
            if (cell.size() == kMostInCell) return false;
            cell.push_back(i);
        }
        for (Index i = 0; i < members_.size(); ++i) {
            checkNowAndThen(progress, i);
            joinNeighbours(i);
        }
        return true;
    }

    // Of each member the point that it becomes: the least of its cluster, or itself where the cluster is too wide.
    std::vector<Index> targets() {
        std::vector<PointBox> boxes(members_.size());
        std::vector<Index> least(members_.size());
        std::iota(least.begin(), least.end(), 0u);
        for (Index i = 0; i < members_.size(); ++i) {
            const Index root = rootOf(i);
            boxes[root].add(at(i));
            if (at(i) < at(least[root])) least[root] = i;
        }
        std::vector<Index> targets(members_.size());
        for (Index i = 0; i < members_.size(); ++i) {
            const PointBox& box = boxes[rootOf(i)];
            const bool narrow = distance(box.low, box.high) <= 2 * tolerance_;
            targets[i] = members_[narrow ? least[rootOf(i)] : i];
        }
        return targets;
    }

  private:
    using Cell = std::array<std::int64_t, 3>;

    const Point& at(Index i) const { return points_[members_[i]]; }
    // Cells of twice the tolerance: what is near enough lies in the own cell or beyond the nearer face of each axis.
    double place(const Point& p, std::size_t axis) const { return p[axis] / (2 * tolerance_); }
    Cell cellOf(const Point& p) const {
        Cell cell;
        for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(place(p, a)));
        return cell;
    }
    Index rootOf(Index i) {
        while (root_[i] != i) i = root_[i] = root_[root_[i]];
        return i;
    }
    void joinNeighbours(Index i) {
        const Cell own = cellOf(at(i));
        Cell step;
        for (std::size_t a = 0; a < 3; ++a)
            step[a] = place(at(i), a) - static_cast<double>(own[a]) < 0.5 ? -1 : 1;
        for (unsigned n = 0; n < 8; ++n) {
            Cell cell = own;
            for (std::size_t a = 0; a < 3; ++a)
                if (n >> a & 1) cell[a] += step[a];
            const auto found = cells_.find(cell);
            if (found == cells_.end()) continue;
            for (const Index j : found->second)
                if (j < i && distance(at(i), at(j)) <= tolerance_) root_[rootOf(i)] = rootOf(j);
        }
    }

    const std::vector<Point>& points_;
    const std::vector<Index>& members_;
    double tolerance_;
    std::vector<Index> root_;
    std::unordered_map<Cell, std::vector<Index>, CellHash> cells_;
};

// ---- split

// Points as a tree: the median along the axis of their box that is longest.
class PointTree {
  public:
    PointTree(const std::vector<Point>& points, std::vector<Index> members)
        : points_(points), members_(std::move(members)), boxes_(members_.size()) {
        build(0, members_.size());
    }

    // The points near the segment from + s along, 0 <= s <= 1: at least those whose nearest point on it is nearer than
    // `tolerance` on each axis.
    template <class Visit>
    void forEachNear(const Vec3& from, const Vec3& along, double tolerance, const Visit& visit) const {
        search(0, members_.size(), from, along, tolerance, visit);
    }

  private:
    void build(std::size_t begin, std::size_t end) {
        if (begin == end) return;
        const std::size_t middle = begin + (end - begin) / 2;
        PointBox& box = boxes_[middle];
        for (std::size_t i = begin; i < end; ++i) box.add(points_[members_[i]]);
        std::size_t axis = 0;
        for (const int other : {1, 2})
            if (box.extent(other) > box.extent(static_cast<int>(axis)))
                axis = static_cast<std::size_t>(other);
        const auto place = [&](std::size_t i) { return members_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(place(begin), place(middle), place(end), [&](Index a, Index b) {
            const double x = points_[a][axis], y = points_[b][axis];
            return x != y ? x < y : a < b;
        });
        build(begin, middle);
        build(middle + 1, end);
    }
    // Whether a part of the segment lies in the box, widened by the tolerance.
    static bool meets(const PointBox& box, const Vec3& from, const Vec3& along, double tolerance) {
        double low = 0, high = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double begin = box.low[axis] - tolerance - from[axis],
                         end = box.high[axis] + tolerance - from[axis];
            if (along[axis] == 0) {
                if (begin > 0 || end < 0) return false;
                continue;
            }
            const double a = begin / along[axis], b = end / along[axis];
            low = std::max(low, std::min(a, b));
            high = std::min(high, std::max(a, b));
        }
        return low <= high;
    }
    template <class Visit>
    void search(std::size_t begin, std::size_t end, const Vec3& from, const Vec3& along, double tolerance,
                const Visit& visit) const {
        if (begin == end) return;
        const std::size_t middle = begin + (end - begin) / 2;
        if (!meets(boxes_[middle], from, along, tolerance)) return;
        visit(members_[middle]);
        search(begin, middle, from, along, tolerance, visit);
        search(middle + 1, end, from, along, tolerance, visit);
    }

    const std::vector<Point>& points_;
    std::vector<Index> members_;
    std::vector<PointBox> boxes_;  // at the median of each part of the tree: around that part
};

struct OpenEdge {
    Index low, high;
};

using Marks = std::vector<bool>;  // one a point

// Those of the edges between marked points.
std::vector<OpenEdge> openEdges(const std::vector<EdgeUse>& uses, const Marks& marked) {
    std::vector<OpenEdge> open;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count % 2 == 1 && marked[use->low] && marked[use->high]) open.push_back({use->low, use->high});
    });
    return open;
}

std::vector<Index> endsOf(const std::vector<OpenEdge>& edges) {
    std::vector<Index> ends;
    for (const OpenEdge& edge : edges) ends.insert(ends.end(), {edge.low, edge.high});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
}

// The points on the inside of an edge, from low to high.
std::vector<Index> pointsOn(const OpenEdge& edge, const std::vector<Point>& points, const PointTree& tree,
                            double tolerance) {
    const Vec3 from = toVec3(points[edge.low]), along = toVec3(points[edge.high]) - from;
    const double size = length(along);
    std::vector<std::pair<double, Index>> found;
    tree.forEachNear(from, along, tolerance, [&](Index p) {
        if (p == edge.low || p == edge.high || !(size > 0)) return;
        const Vec3 to = toVec3(points[p]) - from;
        const double at = dot(to, along) / size;
        if (at > tolerance && at < size - tolerance && length(to - along * (at / size)) <= tolerance)
            found.emplace_back(at, p);
    });
    std::sort(found.begin(), found.end());
    std::vector<Index> on;
    for (const auto& [at, p] : found) on.push_back(p);
    return on;
}

// ---- one tolerance

// The triangles at boundary points. It has all triangles of an edge that ends at one, so an edge between two of them is open
// in the part where it is in the mesh; no other edge is, or becomes, open in the mesh.
struct Part {
    std::vector<Triangle> triangles;
    std::size_t open = 0;  // edges
    Cracks cracks;
};

bool isDegenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

void weld(Part& part, const std::vector<Point>& points, const std::vector<Index>& members,
          const std::vector<Index>& targets) {
    std::unordered_map<Index, Index> to;
    for (std::size_t i = 0; i < members.size(); ++i) {
        if (members[i] == targets[i]) continue;
        to[members[i]] = targets[i];
        ++part.cracks.welded;
        part.cracks.farthest =
            std::max(part.cracks.farthest, distance(points[members[i]], points[targets[i]]));
    }
    for (Triangle& t : part.triangles)
        for (Index& corner : t)
            if (const auto found = to.find(corner); found != to.end()) corner = found->second;
    std::erase_if(part.triangles, isDegenerate);
}

// One edge of each triangle at most. False: there was nothing to split.
bool splitOnce(Part& part, const std::vector<Point>& points, const Marks& ends, double tolerance,
               const Progress& progress) {
    const std::vector<EdgeUse> uses = edgeUses(part.triangles, progress);
    const std::vector<OpenEdge> open = openEdges(uses, ends);
    const PointTree tree(points, endsOf(open));
    std::vector<bool> gone(part.triangles.size());
    std::vector<Triangle> made;
    std::size_t step = 0;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        if (count % 2 == 0 || !ends[use->low] || !ends[use->high]) return;
        checkNowAndThen(progress, ++step);
        const std::vector<Index> on = pointsOn({use->low, use->high}, points, tree, tolerance);
        bool used = false;
        for (std::size_t i = 0; i < count && !on.empty(); ++i) {
            const Triangle t = part.triangles[use[i].triangle];
            if (gone[use[i].triangle]) continue;
            const Index apex = t[0] ^ t[1] ^ t[2] ^ use->low ^ use->high;
            if (std::find(on.begin(), on.end(), apex) != on.end()) continue;
            gone[use[i].triangle] = used = true;
            Index last = use->low;
            for (std::size_t k = 0; k <= on.size(); ++k) {
                const Index next = k < on.size() ? on[k] : use->high;
                made.push_back(use[i].forward ? Triangle{last, next, apex} : Triangle{next, last, apex});
                last = next;
            }
        }
        part.cracks.split += used;
    });
    if (made.empty()) return false;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < gone.size(); ++t)
        if (!gone[t]) part.triangles[kept++] = part.triangles[t];
    part.triangles.resize(kept);
    part.triangles.insert(part.triangles.end(), made.begin(), made.end());
    return true;
}

std::optional<Part> triedAt(double tolerance, Part part, const std::vector<Point>& points,
                            const std::vector<Index>& members, const Marks& ends, const Progress& progress) {
    Clusters clusters(points, members, tolerance);
    if (!clusters.find(progress)) return std::nullopt;
    weld(part, points, members, clusters.targets());
    const bool welded = part.cracks.welded > 0;
    // Each round splits one edge of a triangle, and what it makes has at most two edges that the next one can split.
    for (int round = 0; round < 4 && splitOnce(part, points, ends, tolerance, progress); ++round) continue;
    if (welded || part.cracks.split > 0)
        part.open = openEdges(edgeUses(part.triangles, progress), ends).size();
    return part;
}

// No more than a quarter of the median boundary edge: a coarser one would weld the ends of edges.
std::vector<double> tolerancesFor(const TriangleMesh& mesh, const std::vector<OpenEdge>& open, double step) {
    const PointBox box = boxAround(mesh);
    const double size = distance(box.low, box.high);
    std::vector<double> lengths;
    lengths.reserve(open.size());
    for (const OpenEdge& e : open) lengths.push_back(distance(mesh.points[e.low], mesh.points[e.high]));
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    const double largest = *middle / 4;
    std::vector<double> tolerances{std::min(4 * step, 1e-3 * size)};
    for (const double share : {1e-8, 1e-7, 1e-6, 1e-5})
        if (share * size > tolerances.back()) tolerances.push_back(share * size);
    std::erase_if(tolerances, [&](double t) { return !(t > 0 && t <= largest); });
    return tolerances;
}

}  // namespace

Cracks closeCracks(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, double step,
                   const Progress& progress) {
    const std::vector<OpenEdge> open = openEdges(uses, Marks(mesh.points.size(), true));
    if (open.empty()) return {};
    const std::vector<Index> members = endsOf(open);
    Marks ends(mesh.points.size());
    for (const Index p : members) ends[p] = true;
    const auto isPart = [&](const Triangle& t) { return ends[t[0]] || ends[t[1]] || ends[t[2]]; };
    Part part;
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(part.triangles), isPart);
    part.open = open.size();
    std::optional<Part> best;
    for (const double tolerance : tolerancesFor(mesh, open, step)) {
        const auto tried = triedAt(tolerance, part, mesh.points, members, ends, progress);
        if (!tried) break;
        if (tried->open < (best ? best->open : part.open)) best = tried;
        if (best && best->open == 0) break;
    }
    if (!best) return {};
    std::erase_if(mesh.triangles, isPart);
    mesh.triangles.insert(mesh.triangles.end(), best->triangles.begin(), best->triangles.end());
    return best->cracks;
}

}  // namespace isowave::repair
