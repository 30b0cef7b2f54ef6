#include "subdivision/meshes/quad_connectivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <optional>

#include "isowave/error.h"
#include "subdivision/meshes/catmull_clark.h"

namespace isowave::subdivision {
namespace {

enum class Role : std::uint8_t { unknown, vertex, edge, face };

const char* nameOf(Role role) {
    switch (role) {
        case Role::vertex:
            return "a vertex";
        case Role::edge:
            return "an edge";
        case Role::face:
            return "a face";
        case Role::unknown:
            break;
    }
    return "nothing";
}

// One way to see a component: what each of its vertices is the point of.
struct Labelling {
    std::vector<Role> role;           // of each vertex
    std::vector<Index> vertexCorner;  // of each face: the corner of its V
    std::size_t contradictions = 0;   // faces and vertices at which it fails
    std::string reason;               // the first of them
    Coarsening coarsening;            // when there is none
};

// The mesh of one component; vertices and faces keep their relative order.
struct Part {
    PolygonMesh mesh;
    std::vector<Index> vertex, corner;  // of the whole mesh
};

std::vector<Part> partsOf(const PolygonMesh& mesh, const Adjacency& adjacency) {
    std::vector<Index> component;
    const std::size_t count = adjacency.components(component);
    std::vector<Part> parts(count);
    std::vector<Index> ofVertex(mesh.vertexCount()), local(mesh.vertexCount());
    for (std::size_t c = 0; c < mesh.corners.size(); ++c)
        ofVertex[mesh.corners[c]] = component[adjacency.face(static_cast<Index>(c))];
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
        Part& part = parts[ofVertex[v]];
        local[v] = static_cast<Index>(part.vertex.size());
        part.vertex.push_back(v);
        part.mesh.points.push_back(mesh.points[v]);
    }
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        Part& part = parts[component[f]];
        for (Index c = mesh.faceBegin[f]; c < mesh.faceBegin[f + 1]; ++c) {
            part.corner.push_back(c);
            part.mesh.corners.push_back(local[mesh.corners[c]]);
        }
        part.mesh.faceBegin.push_back(static_cast<Index>(part.mesh.corners.size()));
    }
    for (const Crease& c : mesh.creases)
        parts[ofVertex[c.a]].mesh.creases.push_back({local[c.a], local[c.b], c.sharpness});
    for (const Index v : mesh.pinned) parts[ofVertex[v]].mesh.pinned.push_back(local[v]);
    return parts;
}

// ---- a labelling: spread -> check -> build ----

class Labeller {
  public:
    Labeller(const PolygonMesh& mesh, std::span<const Index> names)
        : mesh_(mesh), adjacency_(mesh), names_(names) {
        sharpness_ = edgeSharpness(adjacency_, mesh.creases);
    }

    // The four labellings, good and bad; the corner of the first face with the lowest vertex is V in the first. Empty, with a
    // reason, when a face is no quad.
    std::vector<Labelling> all(std::string& reason) const {
        for (Index f = 0; f < adjacency_.faces(); ++f) {
            if (adjacency_.faceSize(f) == 4) continue;
            reason = fmt::format(
                "the face with the vertices {} {} {}.. has {} corners, but every face must be a quad",
                name(mesh_.face(f)[0]), name(mesh_.face(f)[1]), name(mesh_.face(f)[2]),
                adjacency_.faceSize(f));
            return {};
        }
        std::array<Index, 4> starts{0, 1, 2, 3};
        std::sort(starts.begin(), starts.end(),
                  [&](Index a, Index b) { return mesh_.corners[a] < mesh_.corners[b]; });
        std::vector<Labelling> labellings;
        for (const Index start : starts) labellings.push_back(labelling(start));
        return labellings;
    }
    const Adjacency& adjacency() const { return adjacency_; }

  private:
    Index name(Index v) const { return names_.empty() ? v : names_[v]; }

    Labelling labelling(Index start) const {
        Labelling labelling;
        spread(start, labelling);
        if (labelling.contradictions == 0) check(labelling);
        if (labelling.contradictions == 0) build(labelling);
        return labelling;
    }

    void contradict(Labelling& labelling, std::string reason) const {
        if (labelling.contradictions++ == 0) labelling.reason = std::move(reason);
    }

    // The corner of V in the face across halfedge c, from the roles that c's ends have in its own face.
    Index vertexCornerAcross(const Labelling& labelling, Index c) const {
        const Index t = adjacency_.twin(c), v = labelling.vertexCorner[adjacency_.face(c)];
        if (c == v) return adjacency_.next(t);                                    // V -> E: across, E -> V
        if (c == adjacency_.prev(v)) return t;                                    // E -> V: across, V -> E
        if (c == adjacency_.next(v)) return adjacency_.next(adjacency_.next(t));  // E -> F: across, F -> E
        return adjacency_.prev(t);                                                // F -> E: across, E -> F
    }

    void setRoles(Labelling& labelling, Index v) const {
        Index c = v;
        for (const Role role : {Role::vertex, Role::edge, Role::face, Role::edge}) {
            Role& known = labelling.role[adjacency_.vertex(c)];
            if (known == Role::unknown) known = role;
            if (known != role) {
                contradict(labelling, fmt::format("vertex {} would be the point of {} and of {}",
                                                  name(adjacency_.vertex(c)), nameOf(known), nameOf(role)));
            }
            c = adjacency_.next(c);
        }
    }

    void spread(Index start, Labelling& labelling) const {
        labelling.role.assign(adjacency_.vertices(), Role::unknown);
        labelling.vertexCorner.assign(adjacency_.faces(), kNone);
        std::vector<Index> queue{adjacency_.face(start)};
        labelling.vertexCorner[queue[0]] = start;
        for (std::size_t i = 0; i < queue.size(); ++i) {
            setRoles(labelling, labelling.vertexCorner[queue[i]]);
            const Index begin = adjacency_.faceBegin(queue[i]);
            for (Index c = begin; c < begin + 4; ++c) {
                if (adjacency_.twin(c) == kNone) continue;
                const Index next = adjacency_.face(adjacency_.twin(c));
                if (labelling.vertexCorner[next] != kNone) continue;
                labelling.vertexCorner[next] = vertexCornerAcross(labelling, c);
                queue.push_back(next);
            }
        }
    }

    void check(Labelling& labelling) const {
        for (Index v = 0; v < adjacency_.vertices(); ++v) {
            const bool boundary = adjacency_.isBoundaryVertex(v);
            const auto faces = adjacency_.faceValence(v);
            if (labelling.role[v] == Role::edge && faces != (boundary ? 2u : 4u)) {
                contradict(
                    labelling,
                    fmt::format("vertex {} has {} faces, but as the point of an edge{} it must have {}",
                                name(v), faces, boundary ? " of the boundary" : "", boundary ? 2 : 4));
            }
            if (labelling.role[v] == Role::face && boundary)
                contradict(
                    labelling,
                    fmt::format("vertex {} lies on the boundary, but would be the point of a face", name(v)));
        }
        for (Index c = 0; c < adjacency_.corners(); ++c) {
            const bool isFaceSide = labelling.role[adjacency_.vertex(c)] == Role::face ||
                                    labelling.role[adjacency_.target(c)] == Role::face;
            if (sharpness_[adjacency_.edge(c)] > 0 && isFaceSide) {
                contradict(labelling,
                           fmt::format("the crease between vertices {} and {} would run across a face",
                                       name(adjacency_.vertex(c)), name(adjacency_.target(c))));
            }
            // V -> E: the other half of the coarse edge is next around E, two halfedges on.
            if (c == labelling.vertexCorner[adjacency_.face(c)]) checkCreaseHalves(labelling, c);
        }
        for (const Index v : mesh_.pinned)
            if (labelling.role[v] != Role::vertex)
                contradict(labelling, fmt::format("the marked corner {} would be the point of {}", name(v),
                                                  nameOf(labelling.role[v])));
    }

    // The edge behind E of the coarse edge that starts with the halfedge V -> E: it leaves E, in the face across the edge
    // E - F.
    Index otherHalf(Index c) const {
        const Index across = adjacency_.twin(adjacency_.next(c));  // F -> E
        return adjacency_.edge(adjacency_.next(across));           // E -> V
    }

    void checkCreaseHalves(Labelling& labelling, Index c) const {
        const bool here = sharpness_[adjacency_.edge(c)] > 0;
        if (adjacency_.twin(adjacency_.next(c)) == kNone || here == (sharpness_[otherHalf(c)] > 0)) return;
        contradict(labelling, fmt::format("a crease ends at vertex {}, in the middle of an edge",
                                          name(adjacency_.target(c))));
    }

    void build(Labelling& labelling) const {
        PolygonMesh& coarse = labelling.coarsening.coarse;
        std::vector<Index> coarseVertex(adjacency_.vertices(), kNone);
        for (Index v = 0; v < adjacency_.vertices(); ++v) {
            if (labelling.role[v] != Role::vertex) continue;
            coarseVertex[v] = static_cast<Index>(coarse.points.size());
            coarse.points.push_back(mesh_.points[v]);
        }
        for (Index v = 0; v < adjacency_.vertices(); ++v) {
            if (labelling.role[v] != Role::face) continue;
            const Index first = firstFaceAround(v);
            Index c = first;
            do {
                const Index corner = labelling.vertexCorner[adjacency_.face(c)];
                coarse.corners.push_back(coarseVertex[adjacency_.vertex(corner)]);
                labelling.coarsening.fineCorner.push_back(corner);
                c = adjacency_.nextAround(c);
            } while (c != first);
            coarse.faceBegin.push_back(static_cast<Index>(coarse.corners.size()));
        }
        if (const auto lines = defects(coarse); !lines.empty()) {
            contradict(labelling, "the coarse mesh would not be one: " + lines.front());
            return;
        }
        markCreases(labelling, coarseVertex);
    }

    // The outgoing halfedge of F in the face with the lowest number.
    Index firstFaceAround(Index v) const {
        Index first = adjacency_.outgoing(v);
        adjacency_.around(v, [&](Index c) {
            if (adjacency_.face(c) < adjacency_.face(first)) first = c;
        });
        return first;
    }

    // In the order of the fine creases, from the end that the fine crease names first.
    void markCreases(Labelling& labelling, const std::vector<Index>& coarseVertex) const {
        PolygonMesh& coarse = labelling.coarsening.coarse;
        if (!mesh_.creases.empty()) {
            std::vector<Index> farEnd(adjacency_.vertices(),
                                      kNone);  // of E: the V where the crease came from
            for (const Crease& crease : mesh_.creases) {
                const bool fromVertex = labelling.role[crease.a] == Role::vertex;
                const Index middle = fromVertex ? crease.b : crease.a, end = fromVertex ? crease.a : crease.b;
                if (farEnd[middle] == kNone)
                    farEnd[middle] = end;
                else if (farEnd[middle] != end)
                    coarse.creases.push_back(
                        {coarseVertex[farEnd[middle]], coarseVertex[end], crease.sharpness});
            }
        }
        for (const Index v : mesh_.pinned) coarse.pinned.push_back(coarseVertex[v]);
    }

    const PolygonMesh& mesh_;
    Adjacency adjacency_;
    std::span<const Index> names_;  // of the vertices in the file, for messages; may be empty
    std::vector<double> sharpness_;
};

// ---- choosing among the labellings ----

// How often a connected mesh can be made coarser, `limit` at most.
int depthOf(const PolygonMesh& mesh, int limit) {
    if (limit <= 0) return 0;
    const Labeller labeller(mesh, {});
    std::string reason;
    int depth = 0;
    for (const Labelling& labelling : labeller.all(reason)) {
        if (labelling.contradictions > 0) continue;
        depth = std::max(depth, 1 + depthOf(labelling.coarsening.coarse, limit - 1));
        if (depth == limit) break;
    }
    return depth;
}

// Takes the coarse points to where the refined inverse has them, and returns the sum of the squares of the details.
// (The points of the fine mesh's own vertices would not do: a level later they have details of their own.)
double fit(Labelling& labelling, const PolygonMesh& mesh, const Adjacency& adjacency) {
    const CatmullClarkStep step(labelling.coarsening.coarse, CatmullClarkVariant::refined);
    const PolygonMesh canonical = step.fineMesh();
    std::vector<Vec3> points(step.fineSize());
    for (Index c = 0; c < labelling.coarsening.fineCorner.size(); ++c) {
        Index at = labelling.coarsening.fineCorner[c];
        for (int k = 0; k < 4; ++k, at = adjacency.next(at))
            points[canonical.corners[4 * c + k]] = mesh.points[adjacency.vertex(at)];
    }
    auto parts = step.decompose(points);
    labelling.coarsening.coarse.points = std::move(parts.coarse);
    double sum = 0;
    for (const Vec3& d : parts.stored) sum += dot(d, d);
    return sum;
}

// The best good labelling; nothing, and the reason of the one with the fewest contradictions, when there is none.
std::optional<Labelling> bestLabelling(const PolygonMesh& mesh, std::span<const Index> names, int limit,
                                       std::string& reason) {
    const Labeller labeller(mesh, names);
    auto all = labeller.all(reason);
    if (all.empty()) return std::nullopt;
    std::vector<Labelling> good;
    for (Labelling& labelling : all)
        if (labelling.contradictions == 0) good.push_back(std::move(labelling));
    if (good.empty()) {
        const auto nearest = std::min_element(
            all.begin(), all.end(),
            [](const Labelling& a, const Labelling& b) { return a.contradictions < b.contradictions; });
        reason = nearest->reason;
        return std::nullopt;
    }
    if (good.size() > 1) {
        std::vector<int> depth;
        for (const Labelling& labelling : good)
            depth.push_back(depthOf(labelling.coarsening.coarse, limit - 1));
        const int deepest = *std::max_element(depth.begin(), depth.end());
        std::vector<Labelling> kept;
        for (std::size_t k = 0; k < good.size(); ++k)
            if (depth[k] == deepest) kept.push_back(std::move(good[k]));
        good = std::move(kept);
    }
    std::vector<double> details;
    for (Labelling& labelling : good) details.push_back(fit(labelling, mesh, labeller.adjacency()));
    const double scale = diagonal(mesh.points);
    const double rounding = 1e-24 * scale * scale * static_cast<double>(mesh.vertexCount());
    const double limitOfSame =
        *std::min_element(details.begin(), details.end()) * (1 + kSameDetails) + rounding;
    for (std::size_t k = 0; k < good.size(); ++k)
        if (details[k] <= limitOfSame) return std::move(good[k]);
    return std::nullopt;  // not finite points: excluded by defects()
}

// ---- the whole mesh: the best labelling of every component, put together ----

Coarsening assemble(const PolygonMesh& mesh, const std::vector<Part>& parts,
                    const std::vector<Labelling>& labellings) {
    // Vertices by their fine vertex, faces by that of their F: (fine number, part, number in the part).
    struct Item {
        Index fine, part, local;
    };
    std::vector<Item> faces;
    std::vector<Index> coarseOf(mesh.vertexCount(), kNone);
    for (Index p = 0; p < parts.size(); ++p) {
        Index localFace = 0;
        for (Index v = 0; v < parts[p].vertex.size(); ++v) {
            if (labellings[p].role[v] == Role::vertex) coarseOf[parts[p].vertex[v]] = 0;
            if (labellings[p].role[v] == Role::face) faces.push_back({parts[p].vertex[v], p, localFace++});
        }
    }
    std::sort(faces.begin(), faces.end(), [](const Item& a, const Item& b) { return a.fine < b.fine; });
    Coarsening result;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
        if (coarseOf[v] == kNone) continue;
        coarseOf[v] = static_cast<Index>(result.coarse.points.size());
        result.coarse.points.emplace_back();
    }
    for (const Item& item : faces) {
        const Coarsening& own = labellings[item.part].coarsening;
        for (Index c = own.coarse.faceBegin[item.local]; c < own.coarse.faceBegin[item.local + 1]; ++c) {
            const Index corner = parts[item.part].corner[own.fineCorner[c]];
            result.fineCorner.push_back(corner);
            result.coarse.corners.push_back(coarseOf[mesh.corners[corner]]);
        }
        result.coarse.faceBegin.push_back(static_cast<Index>(result.coarse.corners.size()));
    }
    for (Index p = 0; p < parts.size(); ++p) {
        const PolygonMesh& own = labellings[p].coarsening.coarse;
        std::vector<Index> global;  // of the part's coarse vertices
        for (Index v = 0; v < parts[p].vertex.size(); ++v)
            if (labellings[p].role[v] == Role::vertex) global.push_back(coarseOf[parts[p].vertex[v]]);
        for (std::size_t v = 0; v < global.size(); ++v) result.coarse.points[global[v]] = own.points[v];
        for (const Crease& c : own.creases)
            result.coarse.creases.push_back({global[c.a], global[c.b], c.sharpness});
        for (const Index v : own.pinned) result.coarse.pinned.push_back(global[v]);
    }
    return result;
}

// One level, or the reason why there is none. names: of the mesh's vertices, in the file.
std::optional<Coarsening> coarsen(const PolygonMesh& mesh, std::span<const Index> names, int limit,
                                  const Progress& progress, std::string& reason) {
    const auto parts = partsOf(mesh, Adjacency(mesh));
    std::vector<Labelling> labellings;
    for (const Part& part : parts) {
        progress.check();
        std::vector<Index> partNames;
        for (const Index v : part.vertex) partNames.push_back(names[v]);
        auto labelling = bestLabelling(part.mesh, partNames, limit, reason);
        if (!labelling) return std::nullopt;
        labellings.push_back(std::move(*labelling));
    }
    return assemble(mesh, parts, labellings);
}

// The coarse vertices are fine ones: they keep their names.
std::vector<Index> namesOf(const Coarsening& coarsening, const PolygonMesh& fine,
                           std::span<const Index> names) {
    std::vector<Index> result(coarsening.coarse.vertexCount());
    for (std::size_t c = 0; c < coarsening.fineCorner.size(); ++c)
        result[coarsening.coarse.corners[c]] = names[fine.corners[coarsening.fineCorner[c]]];
    return result;
}

}  // namespace

std::vector<Coarsening> recoverQuads(const PolygonMesh& fine, int levels, const Progress& progress) {
    std::vector<Coarsening> result;
    const int limit = levels == kAllLevels ? std::numeric_limits<int>::max() : levels;
    std::vector<Index> names(fine.vertexCount());
    std::iota(names.begin(), names.end(), Index{0});
    while (static_cast<int>(result.size()) < limit) {
        const int found = static_cast<int>(result.size());
        progress("recovering", levels == kAllLevels ? 0 : double(found) / levels);
        std::string reason;
        const PolygonMesh& mesh = result.empty() ? fine : result.back().coarse;
        auto next = coarsen(mesh, names, limit - found, progress, reason);
        if (!next) {
            if (levels == kAllLevels && found > 0) break;
            if (found == 0) throw InputError("has no Catmull-Clark connectivity: " + reason);
            throw InputError(fmt::format(
                "has Catmull-Clark connectivity for {} level{} but not for {}: after {}, {}; take "
                "--levels {}",
                found, found == 1 ? "" : "s", levels, found, reason, found));
        }
        names = namesOf(*next, mesh, names);
        result.push_back(std::move(*next));
    }
    return result;
}

}  // namespace isowave::subdivision
