// Makes a real surface semi-regular, so that its levels have real details: a coarse mesh of its own, refined and drawn
// onto it level by level. The inputs of docs/subdivision_triangles.md were made with it.
//
//     semiregular elephant.off elephant_tri.ply  --triangles 700 --levels 4                     for loop, butterfly
//     semiregular elephant.off elephant_quad.ply --triangles 240 --levels 4 --scheme catmull-clark
//
// Passes: collapse -> pair -> (refine -> project -> relax) for each level -> measure.
//   collapse  edge by edge to --triangles, keeping the topology (Lindstrom, Turk)
//   pair      for catmull-clark: two triangles make a quad, the most rectangular pairs first; a few stay triangles
//   refine    one step of the scheme; catmull-clark's first makes quads of all faces
//   project   every vertex to the nearest point of the surface
//   relax     every vertex halfway to the mean of its neighbours, but only along the surface, which spreads them
//             evenly and leaves tips where they are; then project again. Twice.
//   measure   from the new vertices to the surface (rounding), from the surface's vertices to the new mesh, and faces
//             whose normal points against the surface's
// Nearest points know nothing of sheets: with too few triangles a thin ear is reached from its wrong side, which the
// last number shows. The surface must be closed, since a boundary would relax away from itself.
//
// CGAL's Surface_mesh_simplification and AABB_tree are under the GPL: in this program only.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"

namespace {

using namespace isowave::subdivision;
using isowave::InputError;

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Surface>>>;

constexpr int kRelaxations = 2;

Surface surfaceOf(const PolygonMesh& mesh) {
    Surface surface;
    for (const Vec3& p : mesh.points) surface.add_vertex({p.x, p.y, p.z});
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto corners = mesh.face(f);
        for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
            surface.add_face(Surface::Vertex_index(corners[0]), Surface::Vertex_index(corners[k]),
                             Surface::Vertex_index(corners[k + 1]));
        }
    }
    return surface;
}

PolygonMesh collapsed(Surface surface, std::size_t triangles) {
    namespace Simplification = CGAL::Surface_mesh_simplification;
    // Closed: 3 edges for every 2 triangles.
    Simplification::edge_collapse(surface, Simplification::Count_stop_predicate<Surface>(3 * triangles / 2));
    surface.collect_garbage();
    PolygonMesh mesh;
    for (const auto v : surface.vertices()) {
        const Point& p = surface.point(v);
        mesh.points.push_back({p.x(), p.y(), p.z()});
    }
    for (const auto f : surface.faces()) {
        std::vector<Index> corners;
        for (const auto v : surface.vertices_around_face(surface.halfedge(f))) corners.push_back(v);
        mesh.addFace(corners);
    }
    return mesh;
}

// How far the quad a, b, c, d is from a rectangle: the largest |cosine| of its corners.
double skewness(const std::array<Vec3, 4>& p) {
    double most = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 before = p[(k + 3) % 4] - p[k], after = p[(k + 1) % 4] - p[k];
        most = std::max(most, std::abs(dot(before, after)) / (length(before) * length(after)));
    }
    return most;
}

PolygonMesh paired(const PolygonMesh& mesh) {
    const Adjacency adjacency(mesh);
    struct Pair {
        double skewness;
        Index h;
        std::array<Index, 4> quad;
    };
    std::vector<Pair> pairs;
    for (Index e = 0; e < adjacency.edges(); ++e) {
        const Index h = adjacency.edgeCorner(e), g = adjacency.twin(h);
        const std::array<Index, 4> quad{adjacency.vertex(h), adjacency.vertex(adjacency.prev(g)),
                                        adjacency.target(h), adjacency.vertex(adjacency.prev(h))};
        pairs.push_back({skewness({mesh.points[quad[0]], mesh.points[quad[1]], mesh.points[quad[2]],
                                   mesh.points[quad[3]]}),
                         h, quad});
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.skewness < b.skewness; });
    std::vector<std::size_t> valence(mesh.vertexCount());
    for (Index v = 0; v < mesh.vertexCount(); ++v) valence[v] = adjacency.valence(v);
    std::vector<bool> taken(mesh.faceCount(), false);
    PolygonMesh result;
    result.points = mesh.points;
    for (const auto& [unused, h, quad] : pairs) {
        const Index f = adjacency.face(h), g = adjacency.face(adjacency.twin(h));
        if (taken[f] || taken[g] || valence[quad[0]] <= 3 || valence[quad[2]] <= 3) continue;
        taken[f] = taken[g] = true;
        --valence[quad[0]], --valence[quad[2]];
        result.addFace(quad);
    }
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        if (!taken[f]) result.addFace(mesh.face(f));
    }
    return result;
}

Vec3 normal(const Surface& surface, Surface::Face_index f) {
    std::vector<Vec3> p;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
        p.push_back({surface.point(v).x(), surface.point(v).y(), surface.point(v).z()});
    return cross(p[1] - p[0], p[2] - p[0]);
}

Vec3 nearest(const Tree& tree, const Vec3& p) {
    const Point q = tree.closest_point({p.x, p.y, p.z});
    return {q.x(), q.y(), q.z()};
}

// Moves the points onto the surface and returns its unit normals there.
std::vector<Vec3> project(std::vector<Vec3>& points, const Surface& surface, const Tree& tree) {
    std::vector<Vec3> normals;
    for (Vec3& p : points) {
        const auto [at, face] = tree.closest_point_and_primitive({p.x, p.y, p.z});
        p = {at.x(), at.y(), at.z()};
        const Vec3 n = normal(surface, face);
        normals.push_back(length(n) > 0 ? (1 / length(n)) * n : n);
    }
    return normals;
}

void relax(PolygonMesh& mesh, const Adjacency& adjacency, const std::vector<Vec3>& normals) {
    std::vector<Vec3> sums(mesh.vertexCount());
    std::vector<int> counts(mesh.vertexCount(), 0);
    for (Index h = 0; h < adjacency.corners(); ++h) {
        sums[adjacency.vertex(h)] += mesh.points[adjacency.target(h)];
        ++counts[adjacency.vertex(h)];
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const Vec3 move = 0.5 * ((1.0 / counts[v]) * sums[v] - mesh.points[v]);
        mesh.points[v] += move - dot(move, normals[v]) * normals[v];
    }
}

PolygonMesh refined(const PolygonMesh& coarse, const MeshScheme& scheme, const Surface& surface,
                    const Tree& tree) {
    const auto step = scheme.step(coarse, "");
    PolygonMesh fine = step->fineMesh();
    fine.points = step->subdivide(coarse.points);
    const Adjacency adjacency(fine);
    auto normals = project(fine.points, surface, tree);
    for (int k = 0; k < kRelaxations; ++k) {
        relax(fine, adjacency, normals);
        normals = project(fine.points, surface, tree);
    }
    return fine;
}

void measure(const PolygonMesh& mesh, const PolygonMesh& input, const Surface& original, const Tree& tree) {
    const double size = diagonal(input.points);
    const Surface made = surfaceOf(mesh);
    const Tree back(faces(made).first, faces(made).second, made);
    double squares = 0, most = 0;
    for (const Vec3& p : input.points) {
        const double distance = length(nearest(back, p) - p);
        squares += distance * distance;
        most = std::max(most, distance);
    }
    std::size_t against = 0;
    for (const auto f : made.faces()) {
        Vec3 middle;
        for (const auto v : made.vertices_around_face(made.halfedge(f)))
            middle += (1.0 / 3) * Vec3{made.point(v).x(), made.point(v).y(), made.point(v).z()};
        const auto found = tree.closest_point_and_primitive({middle.x, middle.y, middle.z}).second;
        if (dot(normal(made, f), normal(original, found)) < 0) ++against;
    }
    fmt::print(
        "{} vertices, {} faces; surface to mesh: rms {:.2e}, max {:.2e} of the diagonal; {} of {} triangles "
        "point against the surface\n",
        mesh.vertexCount(), mesh.faceCount(), std::sqrt(squares / double(input.points.size())) / size,
        most / size, against, made.number_of_faces());
}

struct Options {
    std::string in, out, scheme = "loop";
    std::size_t triangles = 700;
    int levels = 4;
};

Options parse(int count, char** words) {
    Options options;
    std::vector<std::string> files;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        const bool takesValue = word == "--triangles" || word == "--levels" || word == "--scheme";
        if (takesValue && k + 1 == count) throw InputError(word, "needs a value");
        if (word == "--triangles") {
            options.triangles = std::strtoul(words[++k], nullptr, 10);
        } else if (word == "--levels") {
            options.levels = std::atoi(words[++k]);
        } else if (word == "--scheme") {
            options.scheme = words[++k];
        } else {
            files.push_back(word);
        }
    }
    if (files.size() != 2)
        throw InputError("semiregular IN OUT [--triangles N] [--levels L] [--scheme loop|catmull-clark]");
    options.in = files[0];
    options.out = files[1];
    return options;
}

void run(const Options& options) {
    const PolygonMesh input = readPolygonMesh(options.in);
    requireManifold(input, options.in);
    const Adjacency adjacency(input);
    for (Index e = 0; e < adjacency.edges(); ++e) {
        if (adjacency.isBoundaryEdge(e)) throw InputError(options.in, "is open; a closed surface is needed");
    }
    const Surface original = surfaceOf(input);
    const Tree tree(faces(original).first, faces(original).second, original);
    PolygonMesh mesh = collapsed(original, options.triangles);
    const MeshScheme& scheme = meshScheme(options.scheme);
    if (options.scheme == "catmull-clark") mesh = paired(mesh);
    for (int level = 0; level < options.levels; ++level) mesh = refined(mesh, scheme, original, tree);
    measure(mesh, input, original, tree);
    writePolygonMesh(options.out, mesh);
}

}  // namespace

int main(int count, char** words) {
    try {
        run(parse(count, words));
    } catch (const std::exception& error) {
        fmt::print(stderr, "semiregular: {}\n", error.what());
        return 1;
    }
}
