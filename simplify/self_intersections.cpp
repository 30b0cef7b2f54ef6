// Pairs of triangles that intersect where they should not: boxes first, exact predicates for what is left.
//
// CGAL's Polygon_mesh_processing::self_intersections() answers this for a halfedge mesh only. Meshes that we
// want to know this about need not fit into one (non-manifold edges), so the same rule is applied here to
// an index mesh: CGAL's box_self_intersection_d finds the candidates, exact predicates decide.
#define CGAL_LINKED_WITH_TBB

#include "simplify/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <atomic>

namespace isowave {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point3 = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t,
                                                      CGAL::Box_intersection_d::ID_FROM_BOX_ADDRESS>;

Point3 cornerOf(const TriangleMesh& mesh, std::uint32_t vertex) {
    const Point& p = mesh.points[vertex];
    return {p[0], p[1], p[2]};
}

Kernel::Triangle_3 triangleOf(const TriangleMesh& mesh, const Triangle& t) {
    return {cornerOf(mesh, t[0]), cornerOf(mesh, t[1]), cornerOf(mesh, t[2])};
}

// Turns t and u so that the corners that they share come first, in the same order. Returns how many they
// share.
int alignShared(Triangle& t, Triangle& u) {
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = shared; j < 3; ++j) {
            if (t[i] != u[j]) continue;
            std::swap(t[i], t[shared]);
            std::swap(u[j], u[shared]);
            ++shared;
            break;
        }
    }
    return shared;
}

// Two triangles over one edge meet elsewhere only if they lie in one plane, on the same side of the edge.
bool foldedOver(const TriangleMesh& mesh, const Triangle& t, const Triangle& u) {
    const Point3 a = cornerOf(mesh, t[0]), b = cornerOf(mesh, t[1]);
    const Point3 p = cornerOf(mesh, t[2]), q = cornerOf(mesh, u[2]);
    return CGAL::coplanar(a, b, p, q) && CGAL::coplanar_orientation(a, b, p, q) == CGAL::POSITIVE;
}

// Two triangles that share the corner t[0] = u[0] meet elsewhere only if the side opposite that corner of one
// meets the other: a longer common part starts at the corner and has to leave one of the triangles somewhere.
bool meetBesidesCorner(const TriangleMesh& mesh, const Triangle& t, const Triangle& u) {
    const Kernel::Segment_3 oppositeT(cornerOf(mesh, t[1]), cornerOf(mesh, t[2]));
    const Kernel::Segment_3 oppositeU(cornerOf(mesh, u[1]), cornerOf(mesh, u[2]));
    return CGAL::do_intersect(triangleOf(mesh, t), oppositeU) ||
           CGAL::do_intersect(triangleOf(mesh, u), oppositeT);
}

bool intersectBadly(const TriangleMesh& mesh, Triangle t, Triangle u) {
    switch (alignShared(t, u)) {
        case 0:
            return CGAL::do_intersect(triangleOf(mesh, t), triangleOf(mesh, u));
        case 1:
            return meetBesidesCorner(mesh, t, u);
        case 2:
            return foldedOver(mesh, t, u);
        default:
            return true;
    }
}

std::vector<Box> boxesOf(const TriangleMesh& mesh) {
    std::vector<Box> boxes;
    boxes.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Kernel::Triangle_3 triangle = triangleOf(mesh, mesh.triangles[i]);
        if (!triangle.is_degenerate()) boxes.emplace_back(triangle.bbox(), static_cast<std::uint32_t>(i));
    }
    return boxes;
}

}  // namespace

std::int64_t countSelfIntersections(const TriangleMesh& mesh, const Progress& progress) {
    progress("self-intersections", 0.0);
    const std::vector<Box> boxes = boxesOf(mesh);
    std::vector<const Box*> pointers;
    pointers.reserve(boxes.size());
    for (const Box& box : boxes) pointers.push_back(&box);

    std::atomic<std::int64_t> found = 0, tested = 0;
    const auto test = [&](const Box* a, const Box* b) {
        if ((tested.fetch_add(1, std::memory_order_relaxed) & 0xffff) == 0) progress.check();
        if (intersectBadly(mesh, mesh.triangles[a->info()], mesh.triangles[b->info()])) ++found;
    };
    // Below this many boxes the recursion gives way to testing all pairs; CGAL's own choice for triangles.
    const std::ptrdiff_t cutoff = 2000;
    CGAL::box_self_intersection_d<CGAL::Parallel_tag>(pointers.begin(), pointers.end(), test, cutoff);
    progress("self-intersections", 1.0);
    return found;
}

}  // namespace isowave
