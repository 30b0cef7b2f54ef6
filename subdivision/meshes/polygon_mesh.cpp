#include "subdivision/meshes/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <numbers>
#include <numeric>

#include "isowave/error.h"

namespace isowave::subdivision {
namespace {

// A halfedge with its vertices in ascending order, to bring those of one edge side by side.
struct Side {
    Index high;  // the larger vertex; the smaller one is the bucket
    Index corner;
    bool upwards;  // runs from the smaller to the larger vertex
};

// All halfedges, sorted by (smaller vertex, larger vertex, corner), in linear time as long as valences are bounded.
// sides of the smaller vertex v: [begin[v], begin[v+1]).
struct Sides {
    std::vector<Index> begin;
    std::vector<Side> sides;
};

Index nextCorner(const PolygonMesh& mesh, std::size_t f, Index c) {
    return c + 1 == mesh.faceBegin[f + 1] ? mesh.faceBegin[f] : c + 1;
}

Sides sortedSides(const PolygonMesh& mesh) {
    Sides result;
    result.begin.assign(mesh.vertexCount() + 1, 0);
    result.sides.resize(mesh.corners.size());
    const auto eachHalfedge = [&](auto f) {
        for (std::size_t face = 0; face < mesh.faceCount(); ++face)
            for (Index c = mesh.faceBegin[face]; c < mesh.faceBegin[face + 1]; ++c)
                f(c, mesh.corners[c], mesh.corners[nextCorner(mesh, face, c)]);
    };
    eachHalfedge([&](Index, Index from, Index to) { ++result.begin[std::min(from, to) + 1]; });
    std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
    std::vector<Index> at(result.begin.begin(), result.begin.end() - 1);
    eachHalfedge([&](Index c, Index from, Index to) {
        result.sides[at[std::min(from, to)]++] = {std::max(from, to), c, from < to};
    });
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v)
        std::stable_sort(result.sides.begin() + result.begin[v], result.sides.begin() + result.begin[v + 1],
                         [](const Side& a, const Side& b) { return a.high < b.high; });
    return result;
}

// Calls f(smaller vertex, the halfedges of one edge).
template <class F>
void forEachEdge(const Sides& sorted, F f) {
    for (std::size_t v = 0; v + 1 < sorted.begin.size(); ++v) {
        for (Index i = sorted.begin[v]; i < sorted.begin[v + 1];) {
            Index j = i;
            while (j < sorted.begin[v + 1] && sorted.sides[j].high == sorted.sides[i].high) ++j;
            f(static_cast<Index>(v), std::span<const Side>(sorted.sides.data() + i, j - i));
            i = j;
        }
    }
}

// ---- one function a kind of defect: a line, or nothing ----

// "3 faces ..., the first is 17: ..." is put together by the callers; this counts and keeps the first.
struct Finding {
    std::size_t count = 0, first = 0;
    void add(std::size_t place) {
        if (count++ == 0) first = place;
    }
};

std::string plural(std::size_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::vector<Index> faceOfCorners(const PolygonMesh& mesh) {
    std::vector<Index> faces(mesh.corners.size());
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
        std::fill(faces.begin() + mesh.faceBegin[f], faces.begin() + mesh.faceBegin[f + 1],
                  static_cast<Index>(f));
    return faces;
}

std::string indexDefect(const PolygonMesh& mesh) {
    Finding found;
    const auto faces = faceOfCorners(mesh);
    for (std::size_t c = 0; c < mesh.corners.size(); ++c)
        if (mesh.corners[c] >= mesh.vertexCount()) found.add(c);
    if (found.count == 0) return {};
    return fmt::format(
        "{} to vertices that are not there; the first is face {}, which names vertex {} of {}; export it "
        "again",
        plural(found.count, "corner refers", "corners refer"), faces[found.first], mesh.corners[found.first],
        mesh.vertexCount());
}

std::string finiteDefect(const PolygonMesh& mesh) {
    Finding found;
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3& p = mesh.points[v];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) found.add(v);
    }
    if (found.count == 0) return {};
    return fmt::format("{} not finite; the first is vertex {}; remove or repair it",
                       plural(found.count, "point is", "points are"), found.first);
}

std::string faceDefect(const PolygonMesh& mesh) {
    Finding found;
    std::vector<Index> sorted;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        sorted.assign(face.begin(), face.end());
        std::sort(sorted.begin(), sorted.end());
        if (face.size() < 3 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) found.add(f);
    }
    if (found.count == 0) return {};
    constexpr std::size_t kShown = 8;
    const auto face = mesh.face(found.first);
    return fmt::format(
        "{} degenerate (fewer than three different corners, or one vertex twice); the first is face {}, "
        "with vertices {}{}; remove it",
        plural(found.count, "face is", "faces are"), found.first,
        fmt::join(face.first(std::min(face.size(), kShown)), " "),
        face.size() > kShown ? fmt::format(" .. ({} in all)", face.size()) : "");
}

// The first edge with a defect, and how many there are.
struct EdgeFinding {
    std::size_t count = 0, sides = 0;
    Index low = 0, high = 0, corner = 0;
    void add(Index smaller, std::span<const Side> edge) {
        if (count++ > 0) return;
        low = smaller;
        high = edge[0].high;
        sides = edge.size();
        corner = edge[0].corner;
    }
};

// Edges with more than two faces, and edges along which two faces run the same way.
std::vector<std::string> edgeDefects(const PolygonMesh& mesh, const Sides& sorted) {
    EdgeFinding crowded, turned;
    forEachEdge(sorted, [&](Index low, std::span<const Side> sides) {
        if (sides.size() > 2)
            crowded.add(low, sides);
        else if (sides.size() == 2 && sides[0].upwards == sides[1].upwards)
            turned.add(low, sides);
    });
    std::vector<std::string> lines;
    if (crowded.count > 0) {
        lines.push_back(fmt::format(
            "{} more than two faces (not a 2-manifold); the first is between vertices {} and {}, "
            "with {} faces; split the surface there",
            plural(crowded.count, "edge has", "edges have"), crowded.low, crowded.high, crowded.sides));
    }
    if (turned.count > 0) {
        lines.push_back(
            fmt::format("mixed orientation: the two faces of {} run along it the same way; the first is "
                        "between vertices {} and {}, of face {}; turn the faces of one side round",
                        plural(turned.count, "edge", "edges"), turned.low, turned.high,
                        faceOfCorners(mesh)[turned.corner]));
    }
    return lines;
}

// REQUIRES: no defect of indices, faces or edges. A vertex is good when the fan around it holds all its corners.
std::vector<std::string> vertexDefects(const PolygonMesh& mesh, const Adjacency& adjacency) {
    std::vector<std::size_t> corners(mesh.vertexCount(), 0);
    for (const Index v : mesh.corners) ++corners[v];
    Finding unused, torn;
    for (std::size_t v = 0; v < mesh.vertexCount(); ++v) {
        if (corners[v] == 0)
            unused.add(v);
        else if (adjacency.faceValence(static_cast<Index>(v)) != corners[v])
            torn.add(v);
    }
    std::vector<std::string> lines;
    if (torn.count > 0) {
        lines.push_back(fmt::format(
            "{} the only link between parts of the surface (not a 2-manifold); the first is vertex "
            "{}, whose {} faces form more than one fan; give each fan a vertex of its own",
            plural(torn.count, "vertex is", "vertices are"), torn.first, corners[torn.first]));
    }
    if (unused.count > 0) {
        lines.push_back(fmt::format("{} in no face; the first is vertex {}; remove {}",
                                    plural(unused.count, "vertex is", "vertices are"), unused.first,
                                    unused.count == 1 ? "it" : "them"));
    }
    return lines;
}

std::vector<std::string> markDefects(const PolygonMesh& mesh, const Adjacency& adjacency) {
    Finding creases, pins;
    for (std::size_t k = 0; k < mesh.creases.size(); ++k) {
        const Crease& crease = mesh.creases[k];
        const bool known = crease.a < mesh.vertexCount() && crease.b < mesh.vertexCount() &&
                           adjacency.edgeBetween(crease.a, crease.b) != kNone;
        if (!known || !(crease.sharpness > 0)) creases.add(k);
    }
    for (const Index v : mesh.pinned)
        if (v >= mesh.vertexCount()) pins.add(v);
    std::vector<std::string> lines;
    if (creases.count > 0) {
        const Crease& crease = mesh.creases[creases.first];
        lines.push_back(fmt::format(
            "{} no edge of the mesh with a sharpness above 0; the first is between vertices {} and "
            "{}, sharpness {}; creases name two vertices of an edge, counted from 0",
            plural(creases.count, "crease is", "creases are"), crease.a, crease.b, crease.sharpness));
    }
    if (pins.count > 0) {
        lines.push_back(fmt::format(
            "{} no vertex of the mesh; the first is {} of {}; they are counted from 0",
            plural(pins.count, "marked corner is", "marked corners are"), pins.first, mesh.vertexCount()));
    }
    return lines;
}

}  // namespace

std::vector<std::string> defects(const PolygonMesh& mesh) {
    if (mesh.faceCount() == 0) return {"holds no face; a mesh with faces is needed"};
    if (mesh.corners.size() >= kNone || mesh.vertexCount() >= kNone)
        return {fmt::format("has {} corners; below 2^32 - 1 are supported", mesh.corners.size())};
    if (auto line = indexDefect(mesh); !line.empty()) return {line};
    std::vector<std::string> lines;
    if (auto line = finiteDefect(mesh); !line.empty()) lines.push_back(line);
    const auto append = [&](std::vector<std::string> more) {
        lines.insert(lines.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
        return more.empty();
    };
    if (auto line = faceDefect(mesh); !line.empty()) {
        lines.push_back(line);
        return lines;
    }
    if (!append(edgeDefects(mesh, sortedSides(mesh)))) return lines;
    const Adjacency adjacency(mesh);
    append(vertexDefects(mesh, adjacency));
    append(markDefects(mesh, adjacency));
    return lines;
}

void requireManifold(const PolygonMesh& mesh, const std::string& name) {
    const auto lines = defects(mesh);
    if (!lines.empty()) throw InputError(name, lines.front());
}

double diagonal(std::span<const Vec3> points) {
    if (points.empty()) return 0;
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return length(high - low);
}

// ---- adjacency: twins -> edges -> fans ----

Adjacency::Adjacency(const PolygonMesh& mesh)
    : vertex_(mesh.corners),
      face_(faceOfCorners(mesh)),
      twin_(mesh.corners.size(), kNone),
      edge_(mesh.corners.size(), kNone),
      faceBegin_(mesh.faceBegin),
      outgoing_(mesh.vertexCount(), kNone) {
    forEachEdge(sortedSides(mesh), [&](Index, std::span<const Side> sides) {
        if (sides.size() != 2) return;
        twin_[sides[0].corner] = sides[1].corner;
        twin_[sides[1].corner] = sides[0].corner;
    });
    for (Index c = 0; c < corners(); ++c) {
        if (edge_[c] != kNone) continue;
        edge_[c] = static_cast<Index>(edgeCorner_.size());
        if (twin_[c] != kNone) edge_[twin_[c]] = edge_[c];
        edgeCorner_.push_back(c);
    }
    // The first corner of a vertex, or the one whose halfedge lies on the boundary, where there is one.
    for (Index c = 0; c < corners(); ++c)
        if (Index& first = outgoing_[vertex_[c]]; first == kNone || twin_[c] == kNone) first = c;
}

std::size_t Adjacency::faceValence(Index v) const {
    std::size_t count = 0;
    if (outgoing_[v] != kNone) around(v, [&](Index) { ++count; });
    return count;
}

Index Adjacency::edgeBetween(Index a, Index b) const {
    Index found = kNone;
    if (outgoing_[a] == kNone) return found;
    around(a, [&](Index c) {
        if (target(c) == b) found = edge_[c];
        if (vertex_[prev(c)] == b) found = edge_[prev(c)];
    });
    return found;
}

std::size_t Adjacency::components(std::vector<Index>& ofFace) const {
    ofFace.assign(faces(), kNone);
    std::vector<Index> stack;
    Index count = 0;
    for (Index f = 0; f < faces(); ++f) {
        if (ofFace[f] != kNone) continue;
        ofFace[f] = count;
        stack.push_back(f);
        while (!stack.empty()) {
            const Index at = stack.back();
            stack.pop_back();
            for (Index c = faceBegin_[at]; c < faceBegin_[at + 1]; ++c) {
                if (twin_[c] == kNone || ofFace[face_[twin_[c]]] != kNone) continue;
                ofFace[face_[twin_[c]]] = count;
                stack.push_back(face_[twin_[c]]);
            }
        }
        ++count;
    }
    return count;
}

std::vector<double> edgeSharpness(const Adjacency& adjacency, const std::vector<Crease>& creases) {
    std::vector<double> sharpness(adjacency.edges(), 0);
    for (const Crease& crease : creases) {
        const Index e = adjacency.edgeBetween(crease.a, crease.b);
        assert(e != kNone);
        sharpness[e] = std::max(sharpness[e], crease.sharpness);
    }
    return sharpness;
}

std::vector<Crease> creasesByAngle(const PolygonMesh& mesh, const Adjacency& adjacency, double degrees) {
    // Newell: the sum of p_i x p_(i+1) is twice the face's area vector, wherever the origin is; relative to the
    // face's first point it keeps its digits far from the origin.
    std::vector<Vec3> normals(mesh.faceCount());
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        const Vec3 origin = mesh.points[face[0]];
        for (std::size_t k = 1; k + 1 < face.size(); ++k)
            normals[f] += cross(mesh.points[face[k]] - origin, mesh.points[face[k + 1]] - origin);
    }
    std::vector<Crease> creases;
    const double limit = std::cos(degrees * std::numbers::pi / 180);
    for (Index e = 0; e < adjacency.edges(); ++e) {
        if (adjacency.isBoundaryEdge(e)) continue;
        const Index c = adjacency.edgeCorner(e);
        const Vec3 &a = normals[adjacency.face(c)], &b = normals[adjacency.face(adjacency.twin(c))];
        const double size = length(a) * length(b);
        if (size > 0 && dot(a, b) < limit * size)
            creases.push_back({adjacency.vertex(c), adjacency.target(c), 1});
    }
    return creases;
}

std::vector<Index> correspondingCorners(const Adjacency& a, const Adjacency& b,
                                        std::span<const CornerPair> known) {
    if (a.corners() != b.corners() || a.faces() != b.faces() || a.vertices() != b.vertices()) return {};
    std::vector<Index> of(a.corners(), kNone);
    std::vector<Index> stack;
    bool same = true;
    const auto pairFaces = [&](Index ca, Index cb) {
        if (of[ca] != kNone) {
            same = same && of[ca] == cb;
            return;
        }
        same = same && a.faceSize(a.face(ca)) == b.faceSize(b.face(cb));
        if (!same) return;
        stack.push_back(ca);
        for (Index i = ca, j = cb; of[i] == kNone; i = a.next(i), j = b.next(j)) of[i] = j;
    };
    for (const CornerPair& pair : known) {
        pairFaces(pair.a, pair.b);
        while (same && !stack.empty()) {
            const Index first = stack.back();
            stack.pop_back();
            Index c = first;
            do {
                const Index ta = a.twin(c), tb = b.twin(of[c]);
                same = same && (ta == kNone) == (tb == kNone);
                if (same && ta != kNone) pairFaces(ta, tb);
                c = a.next(c);
            } while (same && c != first);
        }
    }
    same = same && std::find(of.begin(), of.end(), kNone) == of.end();
    return same ? of : std::vector<Index>{};
}

}  // namespace isowave::subdivision
