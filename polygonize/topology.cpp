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

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "base/point_box.h"
#include "base/triangle.h"
#include "polygonize/stars.h"

namespace isowave {
namespace {

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
    std::uint32_t count(std::uint32_t v, const Stars::Corner* star, std::size_t size, Counts& counts) {
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

// By the divergence theorem with the field x/3: the volume is the sum of (p0 - c) . n dA / 3, and for a
// closed component any c will do. c is the middle of the component's box, so that a part far from the origin
// does not cancel. In the order of the triangles: the sums do not depend on threads.
void measure(const TriangleMesh& mesh, MeshComponents& components) {
    std::vector<PointBox> boxes(components.count());
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (const std::uint32_t v : t) boxes[components.of[v]].add(mesh.points[v]);
    std::vector<Vec3> centres(components.count());
    std::transform(boxes.begin(), boxes.end(), centres.begin(),
                   [](const PointBox& box) { return toVec3(box.centre()); });
    for (const Triangle& t : mesh.triangles) {
        if (isDegenerate(t)) continue;
        const std::uint32_t component = components.of[t[0]];
        const Vec3 normal = areaNormal(mesh, t);
        components.area[component] += length(normal) / 2;
        components.volume[component] += dot(toVec3(mesh.points[t[0]]) - centres[component], normal) / 6;
    }
}

// What is known of each vertex by its star.
struct StarCounts {
    Counts counts;
    std::vector<std::uint32_t> edgesUp;  // by vertex: edges to larger vertices
};

StarCounts countStars(const TriangleMesh& mesh) {
    const Stars stars = starsOf(mesh);
    StarCounts result;
    result.edgesUp.resize(mesh.points.size());
    struct Local {
        StarCounter counter;
        Counts counts;
    };
    tbb::enumerable_thread_specific<Local> locals;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.points.size(), 1024), [&](const auto& range) {
        Local& local = locals.local();
        for (std::size_t v = range.begin(); v != range.end(); ++v)
            result.edgesUp[v] =
                local.counter.count(static_cast<std::uint32_t>(v), stars.corners.data() + stars.first[v],
                                    stars.first[v + 1] - stars.first[v], local.counts);
    });
    for (const Local& local : locals) result.counts += local.counts;
    return result;
}

// edgesUp: null where all edges have two triangles.
std::vector<ComponentTopology> measured(const TriangleMesh& mesh, const MeshComponents& components,
                                        const std::vector<std::uint32_t>* edgesUp) {
    std::vector<ComponentTopology> each(components.count());
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (components.of[v] == MeshComponents::kNone) continue;
        ComponentTopology& c = each[components.of[v]];
        ++c.vertices;
        if (edgesUp != nullptr) c.edges += (*edgesUp)[v];
    }
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t)) ++each[components.of[t[0]]].triangles;
    for (std::size_t i = 0; i < each.size(); ++i) {
        ComponentTopology& c = each[i];
        if (edgesUp == nullptr) c.edges = 3 * c.triangles / 2;
        c.volume = components.volume[i];
        c.area = components.area[i];
        c.euler = c.vertices - c.edges + c.triangles;
        c.genus = (2 - c.euler) / 2;
    }
    return each;
}

MeshTopology summed(const TriangleMesh& mesh, std::vector<ComponentTopology> each) {
    MeshTopology result;
    result.each = std::move(each);
    result.triangles = static_cast<std::int64_t>(mesh.triangles.size());
    result.degenerateTriangles = std::count_if(mesh.triangles.begin(), mesh.triangles.end(), isDegenerate);
    result.components = static_cast<std::int64_t>(result.each.size());
    for (const ComponentTopology& c : result.each) {
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
    const StarCounts stars = countStars(mesh);
    MeshTopology result = summed(mesh, measured(mesh, componentsOf(mesh), &stars.edgesUp));
    result.boundaryEdges = stars.counts.boundary;
    result.nonManifoldEdges = stars.counts.nonManifold;
    result.misorientedEdges = stars.counts.misoriented;
    result.nonManifoldVertices = stars.counts.nonManifoldVertices;
    return result;
}

MeshTopology closedTopologyOf(const TriangleMesh& mesh, const MeshComponents& components) {
    return summed(mesh, measured(mesh, components, nullptr));
}

MeshTopology closedTopologyOf(const TriangleMesh& mesh) { return closedTopologyOf(mesh, componentsOf(mesh)); }

}  // namespace isowave
