// topologyOf = gather corners -> count stars -> components -> measure
//
// The star of a vertex v, its triangles, knows everything about v's edges: an edge v-w lies in exactly the
// triangles of v's star that contain w. So after one counting sort of corners by vertex every vertex is
// counted on its own, in parallel, and each edge at its smaller end; there is no sort of the whole mesh's
// edges.
#include "polygonize/topology.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

namespace isowave {
namespace {

bool isDegenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// In a triangle (v, next, previous), counter-clockwise.
struct StarTriangle {
    std::uint32_t next, previous;
};

// stars[first[v] .. first[v + 1]) are the triangles at v.
struct Stars {
    std::vector<std::size_t> first;
    std::vector<StarTriangle> triangles;
};

Stars gatherStars(const TriangleMesh& mesh) {
    Stars stars;
    stars.first.assign(mesh.points.size() + 1, 0);
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (const std::uint32_t v : t) ++stars.first[v + 1];
    std::partial_sum(stars.first.begin(), stars.first.end(), stars.first.begin());
    stars.triangles.resize(stars.first.back());
    std::vector<std::size_t> next(stars.first.begin(), stars.first.end() - 1);
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (int k = 0; k < 3; ++k) stars.triangles[next[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
    return stars;
}

struct Counts {
    std::int64_t boundary = 0, nonManifold = 0, misoriented = 0, nonManifoldVertices = 0;

    void operator+=(const Counts& o) {
        boundary += o.boundary;
        nonManifold += o.nonManifold;
        misoriented += o.misoriented;
        nonManifoldVertices += o.nonManifoldVertices;
    }
};

class StarCounter {
  public:
    // Adds v to `counts`; returns the number of edges from v to vertices with a larger index.
    std::uint32_t count(std::uint32_t v, const StarTriangle* star, std::size_t size, Counts& counts) {
        sides_.clear();
        for (std::uint32_t i = 0; i < size; ++i) {
            sides_.push_back({star[i].next, i, true});
            sides_.push_back({star[i].previous, i, false});
        }
        std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
            return a.other != b.other ? a.other < b.other : a.triangle < b.triangle;
        });
        fan_.resize(size);
        std::iota(fan_.begin(), fan_.end(), 0u);
        std::uint32_t edges = 0;
        std::size_t fans = size;
        for (std::size_t begin = 0, end; begin < sides_.size(); begin = end) {
            std::size_t out = 0;
            for (end = begin; end < sides_.size() && sides_[end].other == sides_[begin].other; ++end) {
                out += sides_[end].out;
                fans -= unite(sides_[begin].triangle, sides_[end].triangle);
            }
            if (sides_[begin].other < v) continue;  // counted at the other end
            ++edges;
            const std::size_t n = end - begin;
            counts.boundary += n == 1;
            counts.misoriented += n == 2 && out != 1;
            counts.nonManifold += n > 2;
        }
        counts.nonManifoldVertices += fans > 1;
        return edges;
    }

  private:
    struct Side {
        std::uint32_t other, triangle;
        bool out;  // the triangle runs from v to other
    };
    std::uint32_t rootOf(std::uint32_t t) {
        while (fan_[t] != t) t = fan_[t] = fan_[fan_[t]];
        return t;
    }
    bool unite(std::uint32_t a, std::uint32_t b) {
        a = rootOf(a);
        b = rootOf(b);
        fan_[std::max(a, b)] = std::min(a, b);
        return a != b;
    }
    std::vector<Side> sides_;
    std::vector<std::uint32_t> fan_;
};

// Vertex -> the smallest vertex of its component.
std::vector<std::uint32_t> componentRoots(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> parent(mesh.points.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto rootOf = [&](std::uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const Triangle& t : mesh.triangles) {
        if (isDegenerate(t)) continue;
        for (const std::uint32_t other : {t[1], t[2]}) {
            const std::uint32_t a = rootOf(t[0]), b = rootOf(other);
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    // A parent is never larger than its child, so it is final when the child is reached.
    for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = parent[parent[v]];
    return parent;
}

struct Box {
    Point low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void add(const Point& p) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    Point centre() const {
        return {low[0] + (high[0] - low[0]) / 2, low[1] + (high[1] - low[1]) / 2,
                low[2] + (high[2] - low[2]) / 2};
    }
};

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// By the divergence theorem with the field x/3: the volume is the sum of (p0 - c) . n dA / 3, and for a
// closed component any c will do. c is the middle of the component's box, so that a part far from the origin
// does not cancel. In the order of the triangles: the sums do not depend on threads.
void measure(const TriangleMesh& mesh, MeshComponents& components) {
    std::vector<Box> boxes(components.count());
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (const std::uint32_t v : t) boxes[components.of[v]].add(mesh.points[v]);
    std::vector<Point> centres(components.count());
    std::transform(boxes.begin(), boxes.end(), centres.begin(), [](const Box& box) { return box.centre(); });
    for (const Triangle& t : mesh.triangles) {
        if (isDegenerate(t)) continue;
        const std::uint32_t component = components.of[t[0]];
        const Point& a = mesh.points[t[0]];
        const Point normal = cross(minus(mesh.points[t[1]], a), minus(mesh.points[t[2]], a));
        components.area[component] += std::sqrt(dot(normal, normal)) / 2;
        components.volume[component] += dot(minus(a, centres[component]), normal) / 6;
    }
}

}  // namespace

MeshComponents componentsOf(const TriangleMesh& mesh) {
    MeshComponents result;
    std::vector<bool> used(mesh.points.size());
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (const std::uint32_t v : t) used[v] = true;
    result.of = componentRoots(mesh);
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < result.of.size(); ++v)  // a root comes before the rest of its component
        result.of[v] = !used[v]            ? MeshComponents::kNone
                       : result.of[v] == v ? count++
                                           : result.of[result.of[v]];
    result.volume.resize(count);
    result.area.resize(count);
    measure(mesh, result);
    return result;
}

MeshTopology topologyOf(const TriangleMesh& mesh) {
    const std::size_t n = mesh.points.size();
    const Stars stars = gatherStars(mesh);

    std::vector<std::uint32_t> edgesUp(n);  // edges to larger vertices
    struct Local {
        StarCounter counter;
        Counts counts;
    };
    tbb::enumerable_thread_specific<Local> locals;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const auto& range) {
        Local& local = locals.local();
        for (std::size_t v = range.begin(); v != range.end(); ++v)
            edgesUp[v] =
                local.counter.count(static_cast<std::uint32_t>(v), stars.triangles.data() + stars.first[v],
                                    stars.first[v + 1] - stars.first[v], local.counts);
    });
    Counts counts;
    for (const Local& local : locals) counts += local.counts;

    const MeshComponents components = componentsOf(mesh);
    MeshTopology result;
    result.each.resize(components.count());
    for (std::size_t v = 0; v < n; ++v) {
        if (components.of[v] == MeshComponents::kNone) continue;
        ComponentTopology& c = result.each[components.of[v]];
        ++c.vertices;
        c.edges += edgesUp[v];
    }
    for (const Triangle& t : mesh.triangles)
        if (isDegenerate(t))
            ++result.degenerateTriangles;
        else
            ++result.each[components.of[t[0]]].triangles;
    for (std::size_t i = 0; i < components.count(); ++i) {
        result.each[i].volume = components.volume[i];
        result.each[i].area = components.area[i];
    }

    result.triangles = static_cast<std::int64_t>(mesh.triangles.size());
    result.boundaryEdges = counts.boundary;
    result.nonManifoldEdges = counts.nonManifold;
    result.misorientedEdges = counts.misoriented;
    result.nonManifoldVertices = counts.nonManifoldVertices;
    result.components = static_cast<std::int64_t>(result.each.size());
    for (ComponentTopology& c : result.each) {
        c.euler = c.vertices - c.edges + c.triangles;
        c.genus = (2 - c.euler) / 2;
        result.vertices += c.vertices;
        result.genus += c.genus;
        ++(c.volume < 0 ? result.cavities : result.parts);
        result.volume += c.volume;
        result.area += c.area;
    }
    std::stable_sort(result.each.begin(), result.each.end(), [](const auto& a, const auto& b) {
        return std::abs(a.volume) > std::abs(b.volume);  // ties stay in the order of their smallest vertex
    });
    return result;
}

namespace {

// A point to be merged: its coordinates' bits, mixed, decide nearly all comparisons.
struct MergeKey {
    std::uint64_t hash;
    std::uint32_t point;
};

std::uint64_t mix(std::uint64_t h) {  // the finaliser of splitmix64 (Steele, Lea and Flood 2014)
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 27) * 0x94d049bb133111ebu;
    return h ^ h >> 31;
}

// + 0.0 turns -0 into 0 and leaves everything else, NaN's bits too.
std::array<std::uint64_t, 3> bitsOf(const Point& p) {
    return {std::bit_cast<std::uint64_t>(p[0] + 0.0), std::bit_cast<std::uint64_t>(p[1] + 0.0),
            std::bit_cast<std::uint64_t>(p[2] + 0.0)};
}

}  // namespace

std::vector<std::uint32_t> firstEqualPoints(const std::vector<Point>& points) {
    const std::size_t n = points.size();
    std::vector<MergeKey> keys(n);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto bits = bitsOf(points[i]);
            keys[i] = {mix(mix(mix(bits[0]) + bits[1]) + bits[2]), static_cast<std::uint32_t>(i)};
        }
    });
    tbb::parallel_sort(keys.begin(), keys.end(), [&](const MergeKey& a, const MergeKey& b) {
        if (a.hash != b.hash) return a.hash < b.hash;
        const auto p = bitsOf(points[a.point]), q = bitsOf(points[b.point]);
        return p != q ? p < q : a.point < b.point;
    });
    std::vector<std::uint32_t> first(n);
    for (std::size_t k = 0; k < n; ++k) {
        const bool same = k > 0 && keys[k].hash == keys[k - 1].hash &&
                          bitsOf(points[keys[k].point]) == bitsOf(points[keys[k - 1].point]);
        first[keys[k].point] = same ? first[keys[k - 1].point] : keys[k].point;
    }
    return first;
}

TriangleMesh mergeEqualPoints(const TriangleMesh& mesh) {
    const std::size_t n = mesh.points.size();
    const std::vector<std::uint32_t> first = firstEqualPoints(mesh.points);
    TriangleMesh merged;
    std::vector<std::uint32_t> index(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (first[i] != i) {
            index[i] = index[first[i]];
            continue;
        }
        index[i] = static_cast<std::uint32_t>(merged.points.size());
        merged.points.push_back(mesh.points[i]);
        if (!mesh.normals.empty()) merged.normals.push_back(mesh.normals[i]);
    }
    merged.triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) merged.triangles.push_back({index[a], index[b], index[c]});
    return merged;
}

}  // namespace isowave
