#include "rivals.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "simplify/collapse.h"
#ifdef ISOWAVE_WITH_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace isowave::bench {
namespace {

namespace Simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface surfaceOf(const TriangleMesh& mesh) {
    Surface surface;
    for (const Point& p : mesh.points) surface.add_vertex({p[0], p[1], p[2]});
    for (const auto& [a, b, c] : mesh.triangles)
        surface.add_face(Surface::Vertex_index(a), Surface::Vertex_index(b), Surface::Vertex_index(c));
    return surface;
}

TriangleMesh meshOf(Surface& surface) {
    surface.collect_garbage();
    TriangleMesh mesh;
    for (const auto v : surface.vertices()) {
        const auto& p = surface.point(v);
        mesh.points.push_back({p.x(), p.y(), p.z()});
    }
    for (const auto f : surface.faces()) {
        Triangle t;
        int k = 0;
        for (const auto v : surface.vertices_around_face(surface.halfedge(f))) t[k++] = v;
        mesh.triangles.push_back(t);
    }
    return mesh;
}

// What isowave's own budgets begin with.
TriangleMesh lindstromTurk(const TriangleMesh& mesh, std::int64_t triangles) {
    return decimate(mesh, triangles);
}

TriangleMesh garlandHeckbert(const TriangleMesh& mesh, std::int64_t triangles) {
    Surface surface = surfaceOf(mesh);
    const Simplification::GarlandHeckbert_plane_policies<Surface, Kernel> policies(surface);
    const auto edges =
        static_cast<std::size_t>(triangles / 2 * 3 + 1);  // a closed surface has 3/2 a triangle
    Simplification::edge_collapse(surface, Simplification::Count_stop_predicate<Surface>(edges),
                                  CGAL::parameters::get_cost(policies.get_cost())
                                      .get_placement(policies.get_placement())
                                      .filter(Simplification::Bounded_normal_change_filter<>()));
    return meshOf(surface);
}

#ifdef ISOWAVE_WITH_MESHOPTIMIZER
TriangleMesh meshoptimizerSimplify(const TriangleMesh& mesh, std::int64_t triangles) {
    std::vector<float> positions;
    for (const Point& p : mesh.points)
        for (const double x : p) positions.push_back(static_cast<float>(x));
    std::vector<unsigned> indices;
    for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    std::vector<unsigned> few(indices.size());
    constexpr float kAnyError = 1e9f;
    few.resize(meshopt_simplify(few.data(), indices.data(), indices.size(), positions.data(),
                                mesh.points.size(), 3 * sizeof(float),
                                static_cast<std::size_t>(3 * triangles), kAnyError));
    TriangleMesh result{mesh.points, {}, {}};
    for (std::size_t i = 0; i < few.size(); i += 3)
        result.triangles.push_back({few[i], few[i + 1], few[i + 2]});
    return result;
}
#endif

}  // namespace

std::vector<Rival> decimators() {
    std::vector<Rival> list{{"CGAL, Lindstrom-Turk", lindstromTurk},
                            {"CGAL, Garland-Heckbert", garlandHeckbert}};
#ifdef ISOWAVE_WITH_VTK
    list.push_back({"VTK, quadric decimation", vtkQuadric});
    list.push_back({"VTK, DecimatePro", vtkPro});
#endif
#ifdef ISOWAVE_WITH_MESHOPTIMIZER
    list.push_back({"meshoptimizer simplify", meshoptimizerSimplify});
#endif
    return list;
}

}  // namespace isowave::bench
